#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "ellipsoid/input_formats.h"
#include "ellipsoid/shape_columns.h"

namespace surfcast::ellipsoid {
namespace {

constexpr uint64_t kSamplesAtOnce = 16384;

using grid::SampleKind;

bool is_masked(SampleKind kind) {
  return kind == SampleKind::kMaskedSymmetricTensor || kind == SampleKind::kMaskedTensor;
}

/// The smallest stride that leaves about as many samples.
uint64_t stride_for(const grid::GridHeader& header, std::optional<uint64_t> sample) {
  const auto left = [&](uint64_t stride) {
    uint64_t product = 1;
    for (const uint64_t size : header.size) product *= (size + stride - 1) / stride;
    return product;
  };
  const uint64_t longest = std::ranges::max(header.size);
  uint64_t stride = 1;
  while (sample && stride < longest && left(stride) > std::max<uint64_t>(*sample, 1)) ++stride;
  return stride;
}

model::EllipsoidSource facts_of(const grid::GridHeader& header, const std::filesystem::path& path, uint64_t stride) {
  model::EllipsoidSource facts;
  facts.name = header.name.empty() ? path.stem().string() : header.name;
  facts.index_to_world = header.index_to_world;
  for (int axis = 0; axis < 3; ++axis) {
    facts.size[axis] = static_cast<uint32_t>((header.size[static_cast<size_t>(axis)] + stride - 1) / stride);
    facts.index_to_world[axis] *= static_cast<double>(stride);
  }
  facts.frame = static_cast<model::WorldFrame>(header.frame);  // the same enumerators
  facts.length_unit = header.length_unit;
  facts.sample_unit = header.sample_unit;
  const auto real = static_cast<uint8_t>(surfel::ScalarValues(std::vector<double>()).index());
  const auto single = static_cast<uint8_t>(surfel::ScalarValues(std::vector<float>()).index());
  for (const char* derived : {"fa", "mode", "md"}) facts.attributes.push_back({derived, real, 0, 0});
  if (is_masked(header.kind)) facts.attributes.push_back({"confidence", single, 0, 0});
  return facts;
}

class GridTensors final : public EllipsoidInput {
 public:
  GridTensors(grid::GridReader reader, const std::filesystem::path& path, uint64_t stride)
      : reader_(std::move(reader)), stride_(stride), facts_(facts_of(reader_.header(), path, stride)) {}

  [[nodiscard]] const model::EllipsoidSource& facts() const override { return facts_; }
  [[nodiscard]] uint64_t samples() const override { return uint64_t{facts_.size.x} * facts_.size.y * facts_.size.z; }
  [[nodiscard]] uint64_t samples_of_file() const override { return header().samples(); }
  [[nodiscard]] std::vector<std::filesystem::path> data_files() const override { return reader_.data_files(); }
  Status rewind() override { return reader_.seek(0); }
  [[nodiscard]] bool at_end() const override { return reader_.position() == header().samples(); }

  Result<Ellipsoids> read(model::EllipsoidCounts& counts) override {
    const uint64_t first = reader_.position();
    const uint64_t count = std::min(kSamplesAtOnce, header().samples() - first);
    values_.resize(count * header().components());
    if (Status status = reader_.read(values_); !status) return fail(status);
    samples_.clear();
    for (uint64_t i = 0; i < count; ++i) add_sample(first + i, std::span(values_).subspan(i * header().components()));
    ShapeColumns shapes = shapes_of(samples_, counts);
    if (is_masked(header().kind)) {
      std::vector<float> confidences;
      for (const uint32_t row : shapes.rows) confidences.push_back(static_cast<float>(samples_[row].confidence));
      shapes.ellipsoids.scalars.push_back({"confidence", std::move(confidences)});
    }
    return std::move(shapes.ellipsoids);
  }

 private:
  [[nodiscard]] const grid::GridHeader& header() const { return reader_.header(); }

  /// Adds sample `number` of the file, unless the preview passes over it.
  void add_sample(uint64_t number, std::span<double> components) {
    const auto& [width, height, depth] = header().size;
    const glm::u64vec3 index(number % width, number / width % height, number / width / height);
    if (index.x % stride_ != 0 || index.y % stride_ != 0 || index.z % stride_ != 0) return;
    const size_t first = is_masked(header().kind) ? 1 : 0;  // a confidence has no unit
    for (size_t c = first; c < header().components(); ++c) {
      components[c] = header().slope * components[c] + header().intercept;
    }
    const MeasuredTensor measured = measured_tensor(components, header().kind);
    TensorSample sample;
    sample.position = header().index_to_world * glm::dvec4(glm::dvec3(index), 1);
    sample.index = glm::u32vec3(index / stride_);
    sample.confidence = measured.confidence;
    sample.tensor = header().measurement_frame ? turned(measured.tensor, *header().measurement_frame) : measured.tensor;
    samples_.push_back(sample);
  }

  grid::GridReader reader_;
  uint64_t stride_;
  model::EllipsoidSource facts_;
  std::vector<double> values_;
  std::vector<TensorSample> samples_;
};

SymmetricTensor full_tensor(std::span<const double> c) {
  return symmetric_part({{c[0], c[3], c[6]}, {c[1], c[4], c[7]}, {c[2], c[5], c[8]}});
}

}  // namespace

static_assert(static_cast<int>(grid::WorldFrame::kLps) == static_cast<int>(model::WorldFrame::kLps));

MeasuredTensor measured_tensor(std::span<const double> c, SampleKind kind) {
  switch (kind) {
    case SampleKind::kSymmetricTensor:
      return {1, {c[0], c[1], c[2], c[3], c[4], c[5]}};
    case SampleKind::kSymmetricTensorLower:
      return {1, {c[0], c[1], c[3], c[2], c[4], c[5]}};
    case SampleKind::kSymmetricTensorVtk:
      return {1, {c[0], c[3], c[5], c[1], c[4], c[2]}};
    case SampleKind::kSymmetricTensorMrtrix:
      return {1, {c[0], c[3], c[4], c[1], c[5], c[2]}};
    case SampleKind::kMaskedSymmetricTensor:
      return {c[0], {c[1], c[2], c[3], c[4], c[5], c[6]}};
    case SampleKind::kTensor:
      return {1, full_tensor(c)};
    case SampleKind::kMaskedTensor:
      return {c[0], full_tensor(c.subspan(1))};
    case SampleKind::kScalar:
      break;
  }
  return {0, {}};
}

Result<InputPtr> open_grid_tensors(grid::GridReader reader, const std::filesystem::path& path,
                                   const InputOptions& options) {
  constexpr uint64_t kMaxIndices = uint64_t{1} << 31;
  const uint64_t longest = std::ranges::max(reader.header().size);
  if (longest >= kMaxIndices) {
    return fail(ErrorKind::kLimit, path.string() + ": has " + std::to_string(longest) + " samples along an axis");
  }
  const uint64_t stride = stride_for(reader.header(), options.sample);
  return std::make_unique<GridTensors>(std::move(reader), path, stride);
}

}  // namespace surfcast::ellipsoid
