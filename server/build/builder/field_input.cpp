#include "builder/field_input.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "base/spool_file.h"
#include "grid/open_scan.h"
#include "scan/scan_stream.h"
#include "scattered/field_lattice.h"
#include "scattered/field_planes.h"
#include "scattered/read_samples.h"

namespace surfcast::builder {
namespace {

/// The samples of a lattice in a temporary file.
class SpooledSamples final : public stream::ByteStream {
 public:
  explicit SpooledSamples(std::shared_ptr<const SpoolFile> spool) : spool_(std::move(spool)) {}

  Result<size_t> read(std::span<std::byte> out) override {
    const std::span part = out.first(std::min<uint64_t>(out.size(), at_most()));
    if (Status status = spool_->read(offset_, part); !status) return fail(status);
    offset_ += part.size();
    return part.size();
  }
  Status skip(uint64_t count) override {
    if (count > at_most()) return fail(ErrorKind::kInternal, "the field ends before a sample that is skipped");
    offset_ += count;
    return {};
  }
  [[nodiscard]] uint64_t at_most() const override { return spool_->size() - offset_; }

 private:
  std::shared_ptr<const SpoolFile> spool_;
  uint64_t offset_ = 0;
};

Result<std::shared_ptr<const SpoolFile>> spool_field(const scattered::FieldPlanes& field,
                                                     const scattered::FieldLattice& lattice,
                                                     const std::filesystem::path& target) {
  Result<SpoolFile> spool = SpoolFile::create(target);
  if (!spool) return fail(spool);
  std::vector<float> values;
  for (uint32_t slab = 0; slab < field.slabs(); ++slab) {
    values.resize(size_t{lattice.size.x} * lattice.size.y * field.planes_of(slab));
    field.evaluate(slab, values);
    if (const auto written = spool->append(std::as_bytes(std::span(values))); !written) return fail(written);
  }
  return std::make_shared<const SpoolFile>(std::move(*spool));
}

grid::StoredGrid stored(const scattered::FieldLattice& lattice, std::shared_ptr<const SpoolFile> spool) {
  grid::StoredGrid grid;
  grid.header.format = "scattered samples";
  grid.header.size = {lattice.size.x, lattice.size.y, lattice.size.z};
  grid.header.type = scan::ScalarType::kFloat32;
  grid.header.index_to_world = grid::affine(glm::dmat3(1), glm::dvec3(lattice.step), lattice.origin);
  grid.open = [spool = std::move(spool)]() -> Result<stream::StreamPtr> {
    return std::make_unique<SpooledSamples>(spool);
  };
  return grid;
}

Result<GridInput> sample_field(const scan::ScanStream& scan, const std::filesystem::path& path,
                               const scattered::FieldOptions& options, const std::filesystem::path& target,
                               uint64_t memory, std::optional<uint64_t> sample, InputField& found) {
  Result<scattered::Samples> samples = scattered::read_samples(scan, path, options, memory);
  if (!samples) return fail(samples);
  const Result<scattered::FieldLattice> lattice =
      sample
          ? scattered::plan_lattice(*samples, options.combination, {}, *sample)
          : scattered::plan_lattice(*samples, options.combination, options.resolution, scattered::kMaxLatticeSamples);
  if (!lattice) return fail_about(path.string(), lattice);
  if (const uint64_t bytes = scattered::FieldPlanes::bytes_for(*lattice); bytes > memory) {
    return fail(ErrorKind::kLimit, path.string() + ": a volume of " + std::to_string(lattice->samples()) +
                                       " samples takes " + std::to_string(bytes >> 20U) +
                                       " MiB while it is made, more than the memory of the build");
  }
  found.samples = samples->kernels.size();
  found.skipped = samples->skipped;
  found.step = lattice->step;
  const bool keeps_integral = options.combination != scattered::Combination::kAverage;
  found.widened = scattered::widen_to_lattice(*lattice, keeps_integral, *samples);
  const scattered::FieldPlanes field(*samples, *lattice, combining_of(options, *samples));
  auto spool = spool_field(field, *lattice, target);
  if (!spool) return fail(spool);
  auto reader = grid::GridReader::of(path, stored(*lattice, std::move(*spool)));
  if (!reader) return fail(reader);
  return GridInput::of(path, std::move(*reader), {});
}

}  // namespace

bool holds_field(const std::filesystem::path& path, const scattered::FieldOptions& options, uint64_t memory) {
  const Result<scan::ScanStream> scan = grid::open_scan(path, {memory});
  return scan && scattered::has_field(scan->schema(), options);
}

Result<GridInput> open_field(const std::filesystem::path& path, const scattered::FieldOptions& options,
                             const std::filesystem::path& target, uint64_t memory, std::optional<uint64_t> sample,
                             std::vector<InputField>& report) {
  const Result<scan::ScanStream> scan = grid::open_scan(path, {memory});
  if (!scan) return fail(scan);
  InputField found{scan->schema().name};
  const uint64_t left = memory - std::min(memory, scan->held_bytes());
  Result<GridInput> input = sample_field(*scan, path, options, target, left, sample, found);
  if (input) report.push_back(std::move(found));
  return input;
}

}  // namespace surfcast::builder
