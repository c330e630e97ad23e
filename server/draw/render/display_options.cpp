#include "render/display_options.h"

#include <algorithm>
#include <string>

#include "render/color_maps.h"
#include "surfel/opacity.h"

namespace surfcast::render {
namespace {

/// The largest intensity of LAS, for models that do not state their range.
constexpr double kLasIntensity = 65535;

bool has_scalar(const model::ModelInfo& info, const char* name) {
  return std::find(info.scalar_names.begin(), info.scalar_names.end(), name) != info.scalar_names.end();
}

tl::unexpected<Error> lacks(const char* what) {
  return fail(ErrorKind::kInvalidInput, "color_by: the model has no " + std::string(what));
}

void set_range(const picture::Coloring& coloring, double low, double high, DisplayOptions& display) {
  display.first = coloring.first.value_or(low);
  display.last = coloring.last.value_or(high);
}

/// The number of codes of the block along an axis whose positions are less than `place` (`reached`: or equal).
/// Positions increase with the codes.
uint32_t codes_below(const residency::PackedLattice& lattice, int axis, double place, bool reached) {
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

/// None if no code of the block is in the box.
std::optional<layout::ClipRange> clip_range(const residency::PackedLattice& lattice, const geometry::Box& box) {
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

std::vector<layout::ClipRange> clip_ranges(const residency::PackedLattice& lattice,
                                           const std::vector<geometry::Box>& boxes) {
  std::vector<layout::ClipRange> ranges;
  for (const geometry::Box& box : boxes) {
    if (const std::optional<layout::ClipRange> range = clip_range(lattice, box)) ranges.push_back(*range);
  }
  return ranges;
}

/// The ranges of which one must contain a surfel; empty if they contain all surfels of the block.
std::vector<layout::ClipRange> ranges_to_be_in(const residency::PackedLattice& lattice,
                                               const std::vector<geometry::Box>& boxes) {
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

/// The position on the colour map of the values `first + step * code`: x is the position of code 0, y the change per
/// code. A range of zero width separates the values below it from the others.
glm::vec4 ramp(const DisplayOptions& display, double first, double step) {
  const double width = std::max(display.last - display.first, 1e-300);
  const auto finite = [](double value) { return static_cast<float>(std::clamp(value, -1e30, 1e30)); };
  return {finite((first - display.first) / width), finite(step / width), 0, 0};
}

}  // namespace

SeenThrough seen_through(const model::ModelInfo& info, const picture::PictureRequest& request) {
  SeenThrough through;
  const model::AttributeRange* alpha = info.range_of(surfel::kOpacityAttribute);
  through.by_file = alpha != nullptr && surfel::tells_opacities(alpha->smallest, alpha->largest);
  through.by_class = has_scalar(info, "classification") &&
                     std::ranges::any_of(request.class_opacities, [](const auto& of) { return of.opacity < 1; });
  through.ghosts = !request.clip.empty() && request.ghost > 0;
  through.any = through.by_file || through.by_class || through.ghosts || request.opacity < 1 ||
                request.xray != picture::XRay::kOff;
  return through;
}

Result<DisplayOptions> resolve_display_options(const model::ModelInfo& info, const picture::PictureRequest& request) {
  const picture::Coloring& coloring = request.coloring;
  const bool classified = has_scalar(info, "classification");
  DisplayOptions display;
  display.color = coloring.source;
  display.map = coloring.map;
  display.up_axis = info.z_up ? 2 : 1;
  display.clipped = !request.clip.empty();
  display.hides_classes = classified && request.hidden_classes.any();
  display.through = seen_through(info, request);
  display.attributes = display.hides_classes || display.through.by_class || display.through.by_file;
  display.volumes = look_of(request);
  if (display.color == picture::SurfelColor::kElevation) {
    set_range(coloring, info.elevation.low, info.elevation.high, display);
  } else if (display.color == picture::SurfelColor::kIntensity) {
    if (!has_scalar(info, "intensity")) return lacks("intensity");
    const model::AttributeRange* stated = info.range_of("intensity");
    set_range(coloring, stated == nullptr ? 0 : stated->low, stated == nullptr ? kLasIntensity : stated->high, display);
    display.attributes = true;
  } else if (display.color == picture::SurfelColor::kClassification) {
    if (!classified) return lacks("classification");
    display.attributes = true;
  }
  return display;
}

std::vector<uint32_t> color_table(const DisplayOptions& display) {
  return display.color == picture::SurfelColor::kClassification ? class_color_table() : map_color_table(display.map);
}

layout::ThroughConstants through_constants(const picture::PictureRequest& request) {
  layout::ThroughConstants constants{};
  constants.ghost.x = static_cast<float>(request.ghost);
  for (glm::vec4& classes : constants.classes) classes = glm::vec4(1);
  for (const picture::ClassOpacity& of : request.class_opacities) {
    constants.classes[of.code / 4][of.code % 4] = static_cast<float>(of.opacity);
  }
  return constants;
}

layout::DisplayConstants display_constants(const DisplayOptions& display, const picture::PictureRequest& request) {
  layout::DisplayConstants constants{};
  for (size_t code = 0; code < request.hidden_classes.size(); ++code) {
    if (!request.hidden_classes[code]) continue;
    constants.hidden[code / 128][static_cast<int>(code / 32 % 4)] |= 1U << (code % 32);
  }
  constants.axis = {display.up_axis, static_cast<int>(kMapEntries) - 1, 0, 0};
  return constants;
}

layout::BlockDisplay block_display(const DisplayOptions& display, const geometry::Clip& clip,
                                   const residency::ResidentBlock& block, std::vector<layout::ClipRange>& ranges) {
  layout::BlockDisplay result{};
  if (display.color == picture::SurfelColor::kElevation) {
    result.ramp =
        ramp(display, block.lattice.position(glm::uvec3(0))[display.up_axis], block.lattice.step()[display.up_axis]);
  } else if (display.color == picture::SurfelColor::kIntensity && block.intensity) {
    result.ramp = ramp(display, block.intensity->first, block.intensity->step);
  }
  if (!display.clipped) return result;
  const std::vector<layout::ClipRange> inside = ranges_to_be_in(block.lattice, clip.inside);
  const std::vector<layout::ClipRange> outside = clip_ranges(block.lattice, clip.outside);
  result.clips = {static_cast<int>(ranges.size()), static_cast<int>(inside.size()), static_cast<int>(outside.size()),
                  0};
  ranges.insert(ranges.end(), inside.begin(), inside.end());
  ranges.insert(ranges.end(), outside.begin(), outside.end());
  return result;
}

}  // namespace surfcast::render
