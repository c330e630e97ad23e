#include "builder/sorted_records.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#include "base/contract.h"

namespace surfcast::builder {
namespace {

/// The order of records: their codes, then their numbers in the order of the inputs. The record follows.
struct Key {
  uint64_t code = 0;
  uint64_t number = 0;

  friend bool operator<(const Key& a, const Key& b) { return a.code != b.code ? a.code < b.code : a.number < b.number; }
};

Key key_at(const std::byte* bytes) {
  Key key;
  std::memcpy(&key, bytes, sizeof key);
  return key;
}

}  // namespace

SortedRecords::SortedRecords(std::filesystem::path target, size_t record_bytes, uint64_t memory)
    : target_(std::move(target)),
      record_bytes_(record_bytes),
      stored_bytes_(sizeof(Key) + (record_bytes + 7) / 8 * 8),
      memory_(memory) {}

Status SortedRecords::add(uint64_t code, std::span<const std::byte> record) {
  SURFCAST_EXPECTS(record.size() == record_bytes_);
  if (records_.size() + stored_bytes_ > memory_ && !records_.empty()) {
    if (Status status = write_run(); !status) return status;
  }
  const Key key{code, added_++};
  const size_t at = records_.size();
  records_.resize(at + stored_bytes_);
  std::memcpy(records_.data() + at, &key, sizeof key);
  std::memcpy(records_.data() + at + sizeof key, record.data(), record.size());
  return {};
}

void SortedRecords::sort_records() {
  std::vector<uint32_t> order(records_.size() / stored_bytes_);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [this](uint32_t a, uint32_t b) { return key_at(stored(a)) < key_at(stored(b)); });
  std::vector<std::byte> sorted(records_.size());
  for (size_t i = 0; i < order.size(); ++i) {
    std::memcpy(sorted.data() + i * stored_bytes_, stored(order[i]), stored_bytes_);
  }
  records_ = std::move(sorted);
}

Status SortedRecords::write_run() {
  if (!spool_) {
    Result<SpoolFile> created = SpoolFile::create(target_);
    if (!created) return fail(created);
    spool_ = std::move(*created);
  }
  sort_records();
  const Result<uint64_t> first = spool_->append(records_);
  if (!first) return fail(first);
  runs_.push_back({*first, *first + records_.size(), {}, 0});
  records_.clear();
  return {};
}

Status SortedRecords::finish() {
  if (runs_.empty()) {
    sort_records();
    return {};
  }
  return records_.empty() ? Status() : write_run();
}

/// Reads more of a run when everything in its buffer was taken.
Status SortedRecords::refill(Run& run) {
  if (run.at < run.buffer.size() || run.next == run.end) return {};
  const uint64_t share = std::max<uint64_t>(memory_ / 2 / runs_.size() / stored_bytes_, 1) * stored_bytes_;
  run.buffer.resize(std::min(share, run.end - run.next));
  run.at = 0;
  if (Status status = spool_->read(run.next, run.buffer); !status) return status;
  spool_->release(run.next, run.buffer.size());
  run.next += run.buffer.size();
  return {};
}

/// Moves the least record of all runs to those in memory. There may be none left.
Status SortedRecords::fetch_one() {
  Run* least = nullptr;
  for (Run& run : runs_) {
    if (Status status = refill(run); !status) return status;
    if (run.at == run.buffer.size()) continue;
    if (least == nullptr || key_at(run.buffer.data() + run.at) < key_at(least->buffer.data() + least->at)) least = &run;
  }
  if (least == nullptr) return {};
  const auto first = least->buffer.begin() + static_cast<ptrdiff_t>(least->at);
  records_.insert(records_.end(), first, first + static_cast<ptrdiff_t>(stored_bytes_));
  least->at += stored_bytes_;
  return {};
}

/// Brings so many records after those that were taken into memory, if there are as many.
Status SortedRecords::fetch(size_t count) {
  const auto present = [this] { return records_.size() / stored_bytes_ - taken_; };
  if (!runs_.empty() && taken_ > kLookAhead) {
    records_.erase(records_.begin(), records_.begin() + static_cast<ptrdiff_t>(taken_ * stored_bytes_));
    taken_ = 0;
  }
  while (present() < count) {
    const size_t before = present();
    if (Status status = fetch_one(); !status) return status;
    if (present() == before) return {};
  }
  return {};
}

Result<std::optional<uint64_t>> SortedRecords::code(size_t ahead) {
  SURFCAST_EXPECTS(ahead <= kLookAhead);
  if (Status status = fetch(ahead + 1); !status) return fail(status);
  if (records_.size() / stored_bytes_ - taken_ <= ahead) return std::optional<uint64_t>();
  return std::optional(key_at(stored(taken_ + ahead)).code);
}

Status SortedRecords::take(size_t count, const std::function<void(std::span<const std::byte>)>& use) {
  if (Status status = fetch(count); !status) return status;
  SURFCAST_EXPECTS(records_.size() / stored_bytes_ - taken_ >= count);
  for (size_t i = 0; i < count; ++i) use({stored(taken_ + i) + sizeof(Key), record_bytes_});
  taken_ += count;
  return {};
}

}  // namespace surfcast::builder
