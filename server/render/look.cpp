#include "render/look.h"

#include <algorithm>
#include <string>

#include "render/color_maps.h"

namespace surfcast {
namespace {

/// The largest intensity of LAS, for models that do not state theirs.
constexpr double kLasIntensity = 65535;

bool has_scalar(const ModelInfo& info, const char* name) {
  return std::find(info.scalar_names.begin(), info.scalar_names.end(), name) != info.scalar_names.end();
}

tl::unexpected<Error> lacks(const char* what) {
  return fail(ErrorKind::kInvalidInput, "color_by: the model has no " + std::string(what));
}

void set_range(const Coloring& coloring, double low, double high, Look& look) {
  look.first = coloring.first.value_or(low);
  look.last = coloring.last.value_or(high);
}

/// How many of the block's codes on an axis, whose positions grow with them, lie below a place (`reached`: or on it).
uint32_t codes_below(const PackedLattice& lattice, int axis, double place, bool reached) {
  uint32_t first = 0;
  uint32_t last = lattice.largest[axis] + 1;
  while (first < last) {
    const uint32_t middle = first + (last - first) / 2;
    glm::uvec3 code(0);
    code[axis] = middle;
    const double position = lattice.position(code)[axis];
    if (reached ? position <= place : position < place) {
      first = middle + 1;
    } else {
      last = middle;
    }
  }
  return first;
}

/// None when no code of the block is in the box.
std::optional<layout::ClipRange> clip_range(const PackedLattice& lattice, const Box& box) {
  layout::ClipRange range{};
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t first = codes_below(lattice, axis, box.min[axis], false);
    const uint32_t end = codes_below(lattice, axis, box.max[axis], true);
    if (first >= end) return std::nullopt;
    range.low[axis] = first;
    range.high[axis] = end - 1;
  }
  return range;
}

std::vector<layout::ClipRange> clip_ranges(const PackedLattice& lattice, const std::vector<Box>& boxes) {
  std::vector<layout::ClipRange> ranges;
  for (const Box& box : boxes) {
    if (const std::optional<layout::ClipRange> range = clip_range(lattice, box)) ranges.push_back(*range);
  }
  return ranges;
}

/// Ranges of which a surfel must be in one; none when every surfel of the block is.
std::vector<layout::ClipRange> ranges_to_be_in(const PackedLattice& lattice, const std::vector<Box>& boxes) {
  if (boxes.empty()) return {};
  std::vector<layout::ClipRange> ranges = clip_ranges(lattice, boxes);
  const bool whole = std::any_of(ranges.begin(), ranges.end(), [&](const layout::ClipRange& range) {
    return glm::uvec3(range.low) == glm::uvec3(0) && glm::uvec3(range.high) == lattice.largest;
  });
  if (whole) return {};
  constexpr layout::ClipRange kNothing{glm::uvec4(1), glm::uvec4(0)};
  if (ranges.empty()) ranges.push_back(kNothing);
  return ranges;
}

/// The place on the colour map of a value `first + step * code`: x at code 0, y for a step. A range without width
/// parts the values below it from the others.
glm::vec4 ramp(const Look& look, double first, double step) {
  const double width = std::max(look.last - look.first, 1e-300);
  const auto finite = [](double value) { return static_cast<float>(std::clamp(value, -1e30, 1e30)); };
  return {finite((first - look.first) / width), finite(step / width), 0, 0};
}

}  // namespace

Result<Look> look_of(const ModelInfo& info, const PictureRequest& request) {
  const Coloring& coloring = request.coloring;
  const bool classified = has_scalar(info, "classification");
  Look look;
  look.color = coloring.source;
  look.map = coloring.map;
  look.up_axis = info.z_up ? 2 : 1;
  look.clipped = !request.clip.empty();
  look.hides_classes = classified && request.hidden_classes.any();
  look.attributes = look.hides_classes;
  if (look.color == SurfelColor::kElevation) {
    set_range(coloring, info.bounds.min[look.up_axis], info.bounds.max[look.up_axis], look);
  } else if (look.color == SurfelColor::kIntensity) {
    if (!has_scalar(info, "intensity")) return lacks("intensity");
    const AttributeRange* stated = info.range_of("intensity");
    set_range(coloring, stated == nullptr ? 0 : stated->low, stated == nullptr ? kLasIntensity : stated->high, look);
    look.attributes = true;
  } else if (look.color == SurfelColor::kClassification) {
    if (!classified) return lacks("classification");
    look.attributes = true;
  }
  return look;
}

std::vector<uint32_t> color_table(const Look& look) {
  return look.color == SurfelColor::kClassification ? class_color_table() : map_color_table(look.map);
}

layout::LookConstants look_constants(const Look& look, const PictureRequest& request) {
  layout::LookConstants constants{};
  for (size_t code = 0; code < request.hidden_classes.size(); ++code) {
    if (!request.hidden_classes[code]) continue;
    constants.hidden[code / 128][static_cast<int>(code / 32 % 4)] |= 1U << (code % 32);
  }
  constants.axis = {look.up_axis, static_cast<int>(kMapEntries) - 1, 0, 0};
  return constants;
}

layout::BlockLook block_look(const Look& look, const Clip& clip, const ResidentBlock& block,
                             std::vector<layout::ClipRange>& ranges) {
  layout::BlockLook result{};
  if (look.color == SurfelColor::kElevation) {
    result.ramp = ramp(look, block.lattice.position(glm::uvec3(0))[look.up_axis], block.lattice.step()[look.up_axis]);
  } else if (look.color == SurfelColor::kIntensity && block.intensity) {
    result.ramp = ramp(look, block.intensity->first, block.intensity->step);
  }
  if (!look.clipped) return result;
  const std::vector<layout::ClipRange> inside = ranges_to_be_in(block.lattice, clip.inside);
  const std::vector<layout::ClipRange> outside = clip_ranges(block.lattice, clip.outside);
  result.clips = {static_cast<int>(ranges.size()), static_cast<int>(inside.size()), static_cast<int>(outside.size()),
                  0};
  ranges.insert(ranges.end(), inside.begin(), inside.end());
  ranges.insert(ranges.end(), outside.begin(), outside.end());
  return result;
}

}  // namespace surfcast
