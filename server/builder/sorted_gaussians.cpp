#include "builder/sorted_gaussians.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#include "base/contract.h"

namespace surfcast::builder {
namespace {

/// A Gaussian in the spool; its coefficients follow.
struct Record {
  uint64_t code = 0;    ///< Morton code
  uint64_t number = 0;  ///< in the order of the inputs
  glm::dvec3 position{0};
  glm::vec3 scale{0};
  glm::quat rotation{1, 0, 0, 0};
  float opacity = 0;
};

Record read_record(const std::byte* bytes) {
  Record record;
  std::memcpy(&record, bytes, sizeof record);
  return record;
}

std::pair<uint64_t, uint64_t> key_at(const std::byte* bytes) {
  std::pair<uint64_t, uint64_t> key;
  std::memcpy(&key.first, bytes + offsetof(Record, code), sizeof key.first);
  std::memcpy(&key.second, bytes + offsetof(Record, number), sizeof key.second);
  return key;
}

}  // namespace

GaussianSorter::GaussianSorter(std::filesystem::path target, const geometry::RootCube& root, int degree, uint64_t bytes)
    : target_(std::move(target)),
      root_(root),
      width_(3 * gaussian::harmonics_of(degree)),
      record_bytes_((sizeof(Record) + width_ * sizeof(float) + 7) / 8 * 8),
      bytes_(bytes) {}

Status GaussianSorter::add(const gaussian::Gaussians& gaussians) {
  SURFCAST_EXPECTS(gaussians.harmonics.size() == gaussians.size() * width_);
  for (size_t i = 0; i < gaussians.size(); ++i) {
    if (records_.size() + record_bytes_ > bytes_ && !records_.empty()) {
      if (Status status = write_run(); !status) return status;
    }
    const Record record{geometry::morton_code(root_, gaussians.positions[i]),
                        added_++,
                        gaussians.positions[i],
                        gaussians.scales[i],
                        gaussians.rotations[i],
                        gaussians.opacities[i]};
    const size_t at = records_.size();
    records_.resize(at + record_bytes_);
    std::memcpy(records_.data() + at, &record, sizeof record);
    std::memcpy(records_.data() + at + sizeof record, gaussians.harmonics.data() + i * width_, width_ * sizeof(float));
  }
  return {};
}

void GaussianSorter::sort_records() {
  std::vector<uint32_t> order(records_.size() / record_bytes_);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [this](uint32_t a, uint32_t b) { return key_at(record(a)) < key_at(record(b)); });
  std::vector<std::byte> sorted(records_.size());
  for (size_t i = 0; i < order.size(); ++i) {
    std::memcpy(sorted.data() + i * record_bytes_, record(order[i]), record_bytes_);
  }
  records_ = std::move(sorted);
}

Status GaussianSorter::write_run() {
  if (!spool_) {
    Result<SpoolFile> created = SpoolFile::create(target_);
    if (!created) return fail(std::move(created.error()));
    spool_ = std::move(*created);
  }
  sort_records();
  const Result<uint64_t> first = spool_->append(records_);
  if (!first) return fail(first.error());
  runs_.push_back({*first, *first + records_.size(), {}, 0});
  records_.clear();
  return {};
}

Status GaussianSorter::finish() {
  if (runs_.empty()) {
    sort_records();
    return {};
  }
  return records_.empty() ? Status() : write_run();
}

/// Reads more of a run when everything in its buffer was taken.
Status GaussianSorter::refill(Run& run) {
  if (run.at < run.buffer.size() || run.next == run.end) return {};
  const uint64_t share = std::max<uint64_t>(bytes_ / 2 / runs_.size() / record_bytes_, 1) * record_bytes_;
  run.buffer.resize(std::min(share, run.end - run.next));
  run.at = 0;
  if (Status status = spool_->read(run.next, run.buffer); !status) return status;
  spool_->release(run.next, run.buffer.size());
  run.next += run.buffer.size();
  return {};
}

/// Moves the least record of all runs to those in memory. There may be none left.
Status GaussianSorter::fetch_one() {
  Run* least = nullptr;
  for (Run& run : runs_) {
    if (Status status = refill(run); !status) return status;
    if (run.at == run.buffer.size()) continue;
    if (least == nullptr || key_at(run.buffer.data() + run.at) < key_at(least->buffer.data() + least->at)) least = &run;
  }
  if (least == nullptr) return {};
  const auto first = least->buffer.begin() + static_cast<ptrdiff_t>(least->at);
  records_.insert(records_.end(), first, first + static_cast<ptrdiff_t>(record_bytes_));
  least->at += record_bytes_;
  return {};
}

/// Brings so many records after those that were taken into memory, if there are as many.
Status GaussianSorter::fetch(size_t count) {
  const auto present = [this] { return records_.size() / record_bytes_ - taken_; };
  if (!runs_.empty() && taken_ > kLookAhead) {
    records_.erase(records_.begin(), records_.begin() + static_cast<ptrdiff_t>(taken_ * record_bytes_));
    taken_ = 0;
  }
  while (present() < count) {
    const size_t before = present();
    if (Status status = fetch_one(); !status) return status;
    if (present() == before) return {};
  }
  return {};
}

Result<std::optional<uint64_t>> GaussianSorter::code(size_t ahead) {
  SURFCAST_EXPECTS(ahead <= kLookAhead);
  if (Status status = fetch(ahead + 1); !status) return fail(std::move(status.error()));
  if (records_.size() / record_bytes_ - taken_ <= ahead) return std::optional<uint64_t>();
  return std::optional(key_at(record(taken_ + ahead)).first);
}

Result<gaussian::Gaussians> GaussianSorter::take(size_t count) {
  if (Status status = fetch(count); !status) return fail(std::move(status.error()));
  SURFCAST_EXPECTS(records_.size() / record_bytes_ - taken_ >= count);
  gaussian::Gaussians gaussians;
  gaussians.harmonics.resize(count * width_);
  for (size_t i = 0; i < count; ++i) {
    const std::byte* bytes = record(taken_ + i);
    const Record record = read_record(bytes);
    gaussians.positions.push_back(record.position);
    gaussians.scales.push_back(record.scale);
    gaussians.rotations.push_back(record.rotation);
    gaussians.opacities.push_back(record.opacity);
    std::memcpy(gaussians.harmonics.data() + i * width_, bytes + sizeof(Record), width_ * sizeof(float));
  }
  taken_ += count;
  return gaussians;
}

}  // namespace surfcast::builder
