#include "residency/packing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/vec2.hpp>
#include <limits>
#include <string_view>
#include <utility>

#include "base/contract.h"
#include "geometry/morton.h"
#include "shared/frame_layout.h"
#include "shared/surfel_layout.h"
#include "surfel/curvature.h"
#include "surfel/drawn_radius.h"
#include "surfel/opacity.h"
#include "surfel/srgb.h"

namespace surfcast::residency {
namespace {

/// The right shift, with rounding, after which lattice indices up to `extent` fit in position codes.
int shift_for(int extent) {
  const auto largest = static_cast<int64_t>(SURFCAST_POSITION_MASK);
  int shift = std::max(0, static_cast<int>(std::bit_width(static_cast<unsigned>(extent))) - SURFCAST_POSITION_BITS);
  while (((int64_t{extent} + ((int64_t{1} << shift) >> 1)) >> shift) > largest) ++shift;
  return shift;
}

glm::ivec3 extent_of(const model::DecodedBlock& block) {
  glm::ivec3 extent(0);
  for (const glm::ivec3& index : block.indices) extent = glm::max(extent, index);
  return extent;
}

glm::uvec3 position_code(const glm::ivec3& index, const glm::ivec3& shift) {
  return glm::uvec3(index + ((glm::ivec3(1) << shift) >> 1)) >> glm::uvec3(shift);
}

/// As encode_normal, but in single precision, with an error of a thousandth of a step.
glm::u16vec2 normal_code(const glm::vec3& n) {
  const float norm = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  const float x = n.x / norm;
  const float y = n.y / norm;
  const float folded_x = n.z < 0 ? std::copysign(1 - std::abs(y), x) : x;
  const float folded_y = n.z < 0 ? std::copysign(1 - std::abs(x), y) : y;
  constexpr auto kHalf = static_cast<float>(SURFCAST_NORMAL_HALF);
  return glm::u16vec2((folded_x + 1) * kHalf + 0.5F, (folded_y + 1) * kHalf + 0.5F);
}

uint32_t color_code(const glm::u16vec3& color, int bits) {
  const auto level = [bits](uint32_t value) { return bits == 16 ? (value * 255 + 32767) / 65535 : value; };
  return level(color.r) | (level(color.g) << 8) | (level(color.b) << 16);
}

/// The linear light of each 8 bit sRGB value.
const std::array<float, 256>& linear_levels() {
  static const std::array<float, 256> kLevels = [] {
    std::array<float, 256> levels{};
    for (uint16_t i = 0; i < 256; ++i) levels[i] = surfel::to_linear(glm::u16vec3(i), 8).r;
    return levels;
  }();
  return kLevels;
}

glm::vec3 linear_of_code(uint32_t color) {
  const std::array<float, 256>& levels = linear_levels();
  return {levels[color & 255], levels[(color >> 8) & 255], levels[color >> 16]};
}

/// The nearest 8 bit sRGB value of linear light in steps of 1/65535, a twentieth of the finest step of sRGB.
const std::array<uint8_t, 65536>& nearest_levels() {
  static const std::array<uint8_t, 65536> kNearest = [] {
    const std::array<float, 256>& levels = linear_levels();
    std::array<uint8_t, 65536> nearest{};
    uint8_t level = 0;
    for (size_t i = 0; i < nearest.size(); ++i) {
      const float light = static_cast<float>(i) / 65535.0F;
      while (level < 255 && levels[level + 1] - light < light - levels[level]) ++level;
      nearest[i] = level;
    }
    return nearest;
  }();
  return kNearest;
}

/// Rounds a number that is not negative to the nearest integer.
uint32_t rounded(float value) {
  const float above = value + 0.5F;
  return static_cast<uint32_t>(above);
}

uint32_t nearest_level(float light) {
  return nearest_levels()[rounded(std::clamp(light, 0.0F, 1.0F) * 65535.0F)];
}

uint32_t code_of_linear(const glm::vec3& light) {
  return nearest_level(light.r) | (nearest_level(light.g) << 8) | (nearest_level(light.b) << 16);
}

/// Unpacked by shaders/include/surfel.glsl.
glm::uvec4 pack_surfel(const glm::uvec3& position, const glm::u16vec2& normal, uint32_t radius, uint32_t weight,
                       uint32_t color) {
  return {position.x | (uint32_t{normal.x} << SURFCAST_POSITION_BITS),
          position.y | (uint32_t{normal.y} << SURFCAST_POSITION_BITS),
          position.z | (radius << SURFCAST_POSITION_BITS) | ((weight >> 8) << 30), color | (weight << 24)};
}

}  // namespace

LogScale LogScale::between(float least, float largest) {
  constexpr double kMaxOctaves = 32;
  const double top = std::log2(double{largest});
  return {top, std::min(kMaxOctaves, top - std::log2(double{least}))};
}

uint32_t LogScale::code(float value) const {
  if (octaves <= 0) return 0;
  const float u = (static_cast<float>(log2_largest) - std::log2(value)) / static_cast<float>(octaves);
  return rounded(std::clamp(u, 0.0F, 1.0F) * SURFCAST_SIZE_STEPS);
}

namespace {

PackedLattice packed_lattice(const model::DecodedBlock& block) {
  const glm::ivec3 extent = extent_of(block);
  const glm::ivec3 shift(shift_for(extent.x), shift_for(extent.y), shift_for(extent.z));
  return {block.grid, block.origin, shift, position_code(extent, shift)};
}

/// Computes the position code of an offset from the corner. Single precision suffices, because codes have 20 bits.
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

/// A surfel and its position along the curve.
struct OnCurve {
  uint64_t code = 0;
  uint32_t surfel = 0;
};

/// Sorts stably by `bits` bits of the codes, starting at bit `shift`.
void sort_by_digit(std::span<const OnCurve> from, int shift, int bits, std::span<OnCurve> to) {
  const uint64_t mask = (uint64_t{1} << bits) - 1;
  std::vector<uint32_t> next(mask + 1);
  for (const OnCurve& one : from) ++next[(one.code >> shift) & mask];
  uint32_t before = 0;
  for (uint32_t& count : next) before += std::exchange(count, before);
  for (const OnCurve& one : from) to[next[(one.code >> shift) & mask]++] = one;
}

/// A radix sort, which takes a quarter of the time of a comparison sort.
void sort_along_curve(std::vector<OnCurve>& surfels, uint64_t largest) {
  constexpr int kDigitBits = 11;
  std::vector<OnCurve> other(surfels.size());
  for (int shift = 0; shift < static_cast<int>(std::bit_width(largest)); shift += kDigitBits) {
    sort_by_digit(surfels, shift, kDigitBits, other);
    std::swap(surfels, other);
  }
}

std::vector<OnCurve> along_curve(const model::DecodedBlock& block, const glm::ivec3& shift) {
  std::vector<OnCurve> surfels;
  surfels.reserve(block.size());
  uint64_t largest = 0;
  for (uint32_t i = 0; i < block.size(); ++i) {
    surfels.push_back({geometry::interleave(position_code(block.indices[i], shift)), i});
    largest = std::max(largest, surfels.back().code);
  }
  sort_along_curve(surfels, largest);
  return surfels;
}

constexpr uint8_t kFullOpacity = 255;

/// The opacities of the block's surfels, of kFullOpacity; empty without.
std::vector<uint8_t> opacity_codes(const model::DecodedBlock& block) {
  std::vector<uint8_t> codes;
  for (const surfel::ScalarAttribute& scalar : block.scalars) {
    if (scalar.name != surfel::kOpacityAttribute) continue;
    for (size_t i = 0; i < block.size(); ++i) {
      codes.push_back(static_cast<uint8_t>(std::lround(kFullOpacity * surfel::opacity_at(scalar.values, i))));
    }
  }
  return codes;
}

uint8_t opacity_code(const MergedSurfel& surfel) {
  return static_cast<uint8_t>(std::lround(float{kFullOpacity} * surfel.opacity));
}

/// The surfels of a block in Morton order, with positions relative to code 0.
std::vector<MergedSurfel> surfels_of(const model::DecodedBlock& block, int color_bits, const PackedLattice& lattice) {
  const float widest = surfel::largest_drawn_radius(block.radii, block.scatter);
  const std::vector<uint8_t> opacities = opacity_codes(block);
  std::vector<MergedSurfel> surfels;
  surfels.reserve(block.size());
  const glm::dvec3 step = lattice.step();
  for (const auto& [code, i] : along_curve(block, lattice.shift)) {
    const glm::vec3 light =
        block.colors.empty() ? glm::vec3(0) : linear_of_code(color_code(block.colors[i], color_bits));
    surfels.push_back({glm::vec3(step * glm::dvec3(position_code(block.indices[i], lattice.shift))), block.normals[i],
                       block.is_scatter(i) ? block.radii[i] : std::min(block.radii[i], widest), block.weights[i], light,
                       i, block.is_scatter(i),
                       opacities.empty() ? 1.0F : static_cast<float>(opacities[i]) / float{kFullOpacity}});
  }
  return surfels;
}

LogScale log_scale_of(std::span<const MergedSurfel> surfels, float MergedSurfel::*size) {
  float least = surfels.front().*size;
  float largest = least;
  for (const MergedSurfel& surfel : surfels) {
    least = std::min(least, surfel.*size);
    largest = std::max(largest, surfel.*size);
  }
  return LogScale::between(least, largest);
}

}  // namespace

namespace {

/// The texel of a surfel of a block with these scales.
class TexelPacker {
 public:
  TexelPacker(const PackedSurfels& packed, bool colored)
      : packed_(packed), colored_(colored), code_of_(packed.lattice) {}
  [[nodiscard]] glm::uvec4 operator()(const MergedSurfel& s) const {
    return pack_surfel(code_of_(s.position), normal_code(s.normal), packed_.radius.code(s.radius),
                       packed_.weight.code(s.weight), colored_ ? code_of_linear(s.light) : 0);
  }

 private:
  const PackedSurfels& packed_;
  bool colored_;
  CodeFinder code_of_;
};

/// The second texel of a surfel. `ratio`: of the drawn radius to the stored one, to which the code is relative.
glm::uvec4 pack_curvature(const surfel::CurvatureCode& code, float ratio) {
  static_assert(surfel::kCurvatureSteps == SURFCAST_CURVATURE_STEPS);
  static_assert(surfel::kBorderSteps == SURFCAST_BORDER_STEPS);
  uint32_t bits = 0;
  for (size_t i = 0; i < 3; ++i) {
    const int step = static_cast<int>(std::lround(static_cast<float>(code.at(i)) * ratio));
    bits |= static_cast<uint32_t>(step + SURFCAST_CURVATURE_STEPS) << (10 * i);
  }
  return {bits, static_cast<uint32_t>(code[3]), 0, 0};
}

/// A run of surfels with two texels each, with the radii of its chunks.
PackedRun curved_run(std::span<const MergedSurfel> surfels, size_t first) {
  PackedRun run;
  run.first = static_cast<uint32_t>(2 * first);
  run.count = static_cast<uint32_t>(2 * surfels.size());
  run.scatter = surfels.front().scatter;
  constexpr size_t kPerChunk = SURFCAST_CHUNK / 2;
  for (size_t i = 0; i < surfels.size(); i += kPerChunk) {
    const auto chunk = surfels.subspan(i, std::min(kPerChunk, surfels.size() - i));
    const auto [least, most] = std::minmax_element(chunk.begin(), chunk.end(),
                                                   [](const auto& a, const auto& b) { return a.radius < b.radius; });
    run.chunks.push_back({least->radius, most->radius});
  }
  return run;
}

/// Discs and scatter have runs of their own.
std::vector<PackedRun> curved_runs(std::span<const MergedSurfel> surfels) {
  const auto scatter = std::find_if(surfels.begin(), surfels.end(), [](const auto& s) { return s.scatter; });
  const auto discs = static_cast<size_t>(scatter - surfels.begin());
  std::vector<PackedRun> runs;
  if (discs > 0) runs.push_back(curved_run(surfels.first(discs), 0));
  if (discs < surfels.size()) runs.push_back(curved_run(surfels.subspan(discs), discs));
  return runs;
}

void pack_curved(const model::DecodedBlock& block, const surfel::CurvatureColumns& curvature,
                 std::vector<MergedSurfel> surfels, PackedSurfels& packed) {
  std::stable_partition(surfels.begin(), surfels.end(), [](const auto& s) { return !s.scatter; });
  packed.curved = true;
  packed.radius = log_scale_of(surfels, &MergedSurfel::radius);
  packed.weight = log_scale_of(surfels, &MergedSurfel::weight);
  const TexelPacker texel(packed, !block.colors.empty());
  for (const MergedSurfel& s : surfels) {
    packed.surfels.push_back(texel(s));
    packed.surfels.push_back(pack_curvature(curvature.at(s.representative), s.radius / block.radii[s.representative]));
    packed.representatives.insert(packed.representatives.end(), 2, s.representative);
    packed.opacities.insert(packed.opacities.end(), 2, opacity_code(s));
  }
  packed.runs = curved_runs(surfels);
}

}  // namespace

PackedSurfels pack_block(const model::DecodedBlock& block, int color_bits, bool oriented) {
  SURFCAST_EXPECTS(block.size() > 0);
  PackedSurfels packed;
  packed.lattice = packed_lattice(block);
  std::vector<MergedSurfel> surfels = surfels_of(block, color_bits, packed.lattice);
  if (const surfel::CurvatureColumns curvature(block.scalars); !curvature.empty()) {
    pack_curved(block, curvature, std::move(surfels), packed);
    return packed;
  }
  SurfelSequence sequence = merge_levels(std::move(surfels), oriented);
  packed.radius = log_scale_of(sequence.surfels, &MergedSurfel::radius);
  packed.weight = log_scale_of(sequence.surfels, &MergedSurfel::weight);
  const TexelPacker texel(packed, !block.colors.empty());
  packed.surfels.reserve(sequence.surfels.size());
  packed.representatives.reserve(sequence.surfels.size());
  packed.opacities.reserve(sequence.surfels.size());
  for (const MergedSurfel& s : sequence.surfels) {
    packed.representatives.push_back(s.representative);
    packed.opacities.push_back(opacity_code(s));
    packed.surfels.push_back(texel(s));
  }
  packed.runs = std::move(sequence.runs);
  return packed;
}

namespace {

/// The values of a scalar attribute as doubles; empty if the block lacks the attribute.
std::vector<double> scalar_values(const model::DecodedBlock& block, std::string_view name) {
  std::vector<double> doubles;
  for (const surfel::ScalarAttribute& scalar : block.scalars) {
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

/// NaN maps to the smallest code.
uint32_t intensity_code(double value, const LinearScale& scale) {
  if (!(scale.step > 0) || std::isnan(value)) return 0;
  return static_cast<uint32_t>(std::lround(std::clamp((value - scale.first) / scale.step, 0.0, 65535.0)));
}

uint32_t class_code(double value) {
  return std::isnan(value) ? 0 : static_cast<uint32_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace

void pack_attributes(const model::DecodedBlock& block, PackedSurfels& packed) {
  const std::vector<double> intensities = scalar_values(block, "intensity");
  const std::vector<double> classes = scalar_values(block, "classification");
  packed.intensity = scale_of(intensities);
  packed.attributes.reserve(packed.surfels.size());
  for (size_t k = 0; k < packed.representatives.size(); ++k) {
    const uint32_t i = packed.representatives[k];
    const uint32_t intensity = intensities.empty() ? 0 : intensity_code(intensities[i], packed.intensity);
    const uint32_t code = classes.empty() ? 0 : class_code(classes[i]);
    packed.attributes.push_back(intensity | (code << 16) | (uint32_t{packed.opacities[k]} << 24));
  }
}

std::vector<uint32_t> linear_root_table() {
  std::vector<uint32_t> table;
  for (uint16_t level = 0; level < 256; ++level) {
    const double root = std::sqrt(double{surfel::to_linear(glm::u16vec3(level), 8).r});
    table.push_back(static_cast<uint32_t>(std::lround(root * 2047)) |
                    (static_cast<uint32_t>(std::lround(root * 1023)) << 16));
  }
  return table;
}

}  // namespace surfcast::residency
