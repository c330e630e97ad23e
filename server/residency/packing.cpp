#include "residency/packing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "base/contract.h"
#include "geometry/morton.h"
#include "model/quantize.h"
#include "shared/surfel_layout.h"
#include "surfel/drawn_radius.h"
#include "surfel/srgb.h"

namespace surfcast {
namespace {

/// How far lattice indices up to `extent` are shifted right, with rounding, to fit the position codes.
int shift_for(int extent) {
  const auto largest = static_cast<int64_t>(SURFCAST_POSITION_MASK);
  int shift = std::max(0, static_cast<int>(std::bit_width(static_cast<unsigned>(extent))) - SURFCAST_POSITION_BITS);
  while (((int64_t{extent} + ((int64_t{1} << shift) >> 1)) >> shift) > largest) ++shift;
  return shift;
}

glm::ivec3 extent_of(const DecodedBlock& block) {
  glm::ivec3 extent(0);
  for (const glm::ivec3& index : block.indices) extent = glm::max(extent, index);
  return extent;
}

glm::uvec3 position_code(const glm::ivec3& index, const glm::ivec3& shift) {
  return glm::uvec3(index + ((glm::ivec3(1) << shift) >> 1)) >> glm::uvec3(shift);
}

glm::u16vec2 normal_code(const glm::vec3& normal) {
  return encode_normal(normal, kSourcePrecision.octahedral_half);
}

uint32_t color_code(const glm::u16vec3& color, int bits) {
  const auto level = [bits](uint32_t value) { return bits == 16 ? (value * 255 + 32767) / 65535 : value; };
  return level(color.r) | (level(color.g) << 8) | (level(color.b) << 16);
}

/// Linear light of each 8 bit sRGB value.
const std::array<float, 256>& linear_levels() {
  static const std::array<float, 256> kLevels = [] {
    std::array<float, 256> levels{};
    for (uint16_t i = 0; i < 256; ++i) levels[i] = to_linear(glm::u16vec3(i), 8).r;
    return levels;
  }();
  return kLevels;
}

glm::vec3 linear_of_code(uint32_t color) {
  const std::array<float, 256>& levels = linear_levels();
  return {levels[color & 255], levels[(color >> 8) & 255], levels[color >> 16]};
}

/// For light in steps of 1/4095 the darkest level it may be nearest to.
const std::array<uint8_t, 4096>& first_levels() {
  static const std::array<uint8_t, 4096> kFirst = [] {
    const std::array<float, 256>& levels = linear_levels();
    std::array<uint8_t, 4096> first{};
    for (size_t i = 0; i < first.size(); ++i) {
      const auto above = std::upper_bound(levels.begin() + 1, levels.end(), static_cast<float>(i) / 4095.0F);
      first[i] = static_cast<uint8_t>(above - levels.begin() - 1);
    }
    return first;
  }();
  return kFirst;
}

uint32_t nearest_level(float light) {
  const std::array<float, 256>& levels = linear_levels();
  uint32_t level = first_levels()[static_cast<size_t>(std::clamp(light, 0.0F, 1.0F) * 4095.0F)];
  while (level < 255 && levels[level + 1] - light < light - levels[level]) ++level;
  return level;
}

uint32_t code_of_linear(const glm::vec3& light) {
  return nearest_level(light.r) | (nearest_level(light.g) << 8) | (nearest_level(light.b) << 16);
}

/// shaders/include/surfel.glsl takes it apart.
glm::uvec4 pack_surfel(const glm::uvec3& position, const glm::u16vec2& normal, uint32_t radius, uint32_t weight,
                       uint32_t color) {
  return {position.x | (uint32_t{normal.x} << SURFCAST_POSITION_BITS),
          position.y | (uint32_t{normal.y} << SURFCAST_POSITION_BITS),
          position.z | (radius << SURFCAST_POSITION_BITS) | ((weight >> 8) << 30), color | (weight << 24)};
}

}  // namespace

LogScale LogScale::of(std::span<const float> values) {
  constexpr double kMostOctaves = 32;
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  const double top = std::log2(static_cast<double>(*largest));
  return {top, std::min(kMostOctaves, top - std::log2(static_cast<double>(*least)))};
}

uint32_t LogScale::code(double value) const {
  if (octaves <= 0) return 0;
  const double u = (log2_largest - std::log2(value)) / octaves;
  return static_cast<uint32_t>(std::clamp(u, 0.0, 1.0) * SURFCAST_SIZE_STEPS + 0.5);
}

namespace {

PackedLattice packed_lattice(const DecodedBlock& block) {
  const glm::ivec3 extent = extent_of(block);
  const glm::ivec3 shift(shift_for(extent.x), shift_for(extent.y), shift_for(extent.z));
  return {block.grid, block.origin, shift, position_code(extent, shift)};
}

/// Finds the position code of an offset from the corner. Single precision is fine enough: codes have 20 bits.
class CodeFinder {
 public:
  explicit CodeFinder(const PackedLattice& lattice) : inverse_(1.0 / lattice.step()), largest_(lattice.largest) {}
  [[nodiscard]] glm::uvec3 operator()(const glm::vec3& offset) const {
    return glm::uvec3(glm::clamp(offset * inverse_ + 0.5F, glm::vec3(0), largest_));
  }

 private:
  glm::vec3 inverse_;
  glm::vec3 largest_;
};

std::vector<uint32_t> along_curve(const DecodedBlock& block, const glm::ivec3& shift) {
  std::vector<std::pair<uint64_t, uint32_t>> codes;
  codes.reserve(block.size());
  for (uint32_t i = 0; i < block.size(); ++i) codes.emplace_back(interleave(position_code(block.indices[i], shift)), i);
  std::sort(codes.begin(), codes.end());
  std::vector<uint32_t> order;
  order.reserve(codes.size());
  for (const auto& [code, i] : codes) order.push_back(i);
  return order;
}

/// The surfels of a block along a Morton curve, positions from code 0 on.
std::vector<MergedSurfel> surfels_of(const DecodedBlock& block, int color_bits, const PackedLattice& lattice) {
  const float widest = largest_drawn_radius(block.radii);
  std::vector<MergedSurfel> surfels;
  surfels.reserve(block.size());
  const glm::dvec3 step = lattice.step();
  for (const uint32_t i : along_curve(block, lattice.shift)) {
    const glm::vec3 light =
        block.colors.empty() ? glm::vec3(0) : linear_of_code(color_code(block.colors[i], color_bits));
    surfels.push_back({glm::vec3(step * glm::dvec3(position_code(block.indices[i], lattice.shift))), block.normals[i],
                       std::min(block.radii[i], widest), block.weights[i], light, i});
  }
  return surfels;
}

template <typename Get>
LogScale log_scale_of(std::span<const MergedSurfel> surfels, Get get) {
  std::vector<float> values;
  values.reserve(surfels.size());
  for (const MergedSurfel& surfel : surfels) values.push_back(get(surfel));
  return LogScale::of(values);
}

}  // namespace

PackedBlock pack_block(const DecodedBlock& block, int color_bits, bool oriented) {
  SURFCAST_EXPECTS(block.size() > 0);
  PackedBlock packed;
  packed.lattice = packed_lattice(block);
  SurfelSequence sequence = merge_levels(surfels_of(block, color_bits, packed.lattice), oriented);
  packed.radius = log_scale_of(sequence.surfels, [](const MergedSurfel& s) { return s.radius; });
  packed.weight = log_scale_of(sequence.surfels, [](const MergedSurfel& s) { return s.weight; });
  const CodeFinder code_of(packed.lattice);
  packed.surfels.reserve(sequence.surfels.size());
  packed.representatives.reserve(sequence.surfels.size());
  for (const MergedSurfel& s : sequence.surfels) {
    packed.representatives.push_back(s.representative);
    packed.surfels.push_back(pack_surfel(code_of(s.position), normal_code(s.normal),
                                         packed.radius.code(double{s.radius}), packed.weight.code(double{s.weight}),
                                         block.colors.empty() ? 0 : code_of_linear(s.light)));
  }
  packed.runs = std::move(sequence.runs);
  return packed;
}

namespace {

/// The values of a scalar attribute as doubles; nothing if the block has none of that name.
std::vector<double> scalar_values(const DecodedBlock& block, std::string_view name) {
  std::vector<double> doubles;
  for (const ScalarAttribute& scalar : block.scalars) {
    if (scalar.name != name) continue;
    std::visit([&doubles](const auto& values) { doubles.assign(values.begin(), values.end()); }, scalar.values);
  }
  return doubles;
}

LinearScale scale_of(std::span<const double> values) {
  constexpr double kSteps = 65535;
  double least = std::numeric_limits<double>::infinity();
  double largest = -least;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    largest = std::max(largest, value);
  }
  return least <= largest ? LinearScale{least, largest / kSteps - least / kSteps} : LinearScale{};
}

/// What is no number is the smallest.
uint32_t intensity_code(double value, const LinearScale& scale) {
  if (!(scale.step > 0) || std::isnan(value)) return 0;
  return static_cast<uint32_t>(std::lround(std::clamp((value - scale.first) / scale.step, 0.0, 65535.0)));
}

uint32_t class_code(double value) {
  return std::isnan(value) ? 0 : static_cast<uint32_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace

void pack_attributes(const DecodedBlock& block, PackedBlock& packed) {
  const std::vector<double> intensities = scalar_values(block, "intensity");
  const std::vector<double> classes = scalar_values(block, "classification");
  packed.intensity = scale_of(intensities);
  packed.attributes.reserve(packed.surfels.size());
  for (const uint32_t i : packed.representatives) {
    const uint32_t intensity = intensities.empty() ? 0 : intensity_code(intensities[i], packed.intensity);
    packed.attributes.push_back(intensity | (classes.empty() ? 0 : class_code(classes[i]) << 16));
  }
}

std::vector<uint32_t> linear_root_table() {
  std::vector<uint32_t> table;
  for (uint16_t level = 0; level < 256; ++level) {
    const double root = std::sqrt(double{to_linear(glm::u16vec3(level), 8).r});
    table.push_back(static_cast<uint32_t>(std::lround(root * 2047)) |
                    (static_cast<uint32_t>(std::lround(root * 1023)) << 16));
  }
  return table;
}

}  // namespace surfcast
