#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <utility>
#include <vector>

#include "ellipsoid/input_formats.h"
#include "ellipsoid/shape_columns.h"
#include "grid/vtk_legacy_file.h"
#include "scan/text_tokens.h"

namespace surfcast::ellipsoid {
namespace {

using scan::ScalarType;

constexpr uint64_t kPointsAtOnce = 16384;

/// Points and tensors of a file.
struct PointSet {
  bool binary = false;
  grid::VtkNumbers points;
  grid::VtkNumbers tensors;
  grid::SampleKind kind = grid::SampleKind::kTensor;
};

/// The first tensors of the points.
Result<PointSet> find_tensors(std::string_view text) {
  const Result<grid::LegacyFile> file = grid::scan_vtk_legacy(text, grid::kVtkPointSets);
  if (!file) return fail(file);
  if (file->points.count == 0) return fail(ErrorKind::kInvalidInput, "VTK: the data set has no points");
  const auto of_points = [&](const grid::LegacyArray& array) {
    return array.facts.role == grid::VtkRole::kTensors && !array.facts.of_cells &&
           array.tuples == file->points.count / 3;
  };
  const auto found = std::ranges::find_if(file->arrays, of_points);
  if (found == file->arrays.end()) {
    return fail(ErrorKind::kUnsupported, "VTK: not a regular grid, and its points have no tensors");
  }
  const Result<grid::SampleKind> kind = grid::kind_of(found->facts);
  if (!kind) return fail(kind);
  return PointSet{file->binary, file->points, found->numbers, *kind};
}

/// Numbers one after another, from where they begin.
class NumberReader {
 public:
  NumberReader(std::string_view text, const grid::VtkNumbers& numbers, bool binary)
      : tokens_(text.substr(numbers.offset)), at_(text.data() + numbers.offset), type_(numbers.type), binary_(binary) {}

  /// None where a word is not a number. There are as many as the parser has passed over.
  std::optional<double> next() {
    if (!binary_) return scan::parse_number<double>(tokens_.next());
    const auto* bytes = reinterpret_cast<const std::byte*>(at_);
    at_ += scan::size_of(type_);
    return scan::with_type(type_, [&](auto zero) {
      return static_cast<double>(scan::load<decltype(zero)>(bytes, std::endian::native == std::endian::little));
    });
  }

 private:
  scan::Tokens tokens_;
  const char* at_;
  ScalarType type_;
  bool binary_;
};

class VtkTensors final : public EllipsoidInput {
 public:
  VtkTensors(stream::FilePtr file, std::filesystem::path path, const PointSet& set, uint64_t stride)
      : file_(std::move(file)), path_(std::move(path)), set_(set), stride_(stride) {
    facts_.name = path_.stem().string();
    constexpr auto kDouble = static_cast<uint8_t>(ScalarType::kFloat64);
    for (const char* derived : {"fa", "mode", "md"}) facts_.attributes.push_back({derived, kDouble, 0, 0});
    begin();
  }

  [[nodiscard]] const model::EllipsoidSource& facts() const override { return facts_; }
  [[nodiscard]] uint64_t samples() const override { return (samples_of_file() + stride_ - 1) / stride_; }
  [[nodiscard]] uint64_t samples_of_file() const override { return set_.points.count / 3; }
  [[nodiscard]] bool at_end() const override { return position_ == samples_of_file(); }
  Status rewind() override {
    begin();
    return {};
  }

  Result<Ellipsoids> read(model::EllipsoidCounts& counts) override {
    std::vector<TensorSample> samples;
    const uint64_t end = std::min(position_ + kPointsAtOnce, samples_of_file());
    for (; position_ < end; ++position_) {
      TensorSample sample;
      std::array<double, 9> components{};
      const size_t count = grid::components_of(set_.kind);
      bool numbers = true;
      for (int axis = 0; axis < 3; ++axis) numbers = take(*points_, sample.position[axis]) && numbers;
      for (size_t i = 0; i < count; ++i) numbers = take(*tensors_, components.at(i)) && numbers;
      if (!numbers) return fail(ErrorKind::kInvalidInput, path_.string() + ": VTK: a word that is no number");
      sample.tensor = measured_tensor(components, set_.kind).tensor;
      if (position_ % stride_ == 0) samples.push_back(sample);
    }
    file_->release_pages();
    return std::move(shapes_of(samples, counts).ellipsoids);
  }

 private:
  void begin() {
    const std::string_view text = scan::as_text(file_->bytes());
    points_.emplace(text, set_.points, set_.binary);
    tensors_.emplace(text, set_.tensors, set_.binary);
    position_ = 0;
  }
  static bool take(NumberReader& reader, double& value) {
    const std::optional<double> next = reader.next();
    value = next.value_or(0);
    return next.has_value();
  }

  stream::FilePtr file_;
  std::filesystem::path path_;
  PointSet set_;
  uint64_t stride_;
  model::EllipsoidSource facts_;
  std::optional<NumberReader> points_;
  std::optional<NumberReader> tensors_;
  uint64_t position_ = 0;
};

}  // namespace

bool is_vtk_point_set(const stream::FilePtr& file) {
  return grid::is_vtk_legacy_point_set(scan::as_text(file->bytes()));
}

bool holds_vtk_tensors(const stream::FilePtr& file) {
  return is_vtk_point_set(file) && find_tensors(scan::as_text(file->bytes())).has_value();
}

Result<InputPtr> open_vtk_tensors(const stream::FilePtr& file, const std::filesystem::path& path,
                                  const InputOptions& options) {
  const Result<PointSet> set = find_tensors(scan::as_text(file->bytes()));
  if (!set) return fail_about(path.string(), set);
  const uint64_t points = set->points.count / 3;
  const uint64_t wanted = std::clamp<uint64_t>(options.sample.value_or(points), 1, points);
  return std::make_unique<VtkTensors>(file, path, *set, (points + wanted - 1) / wanted);
}

}  // namespace surfcast::ellipsoid
