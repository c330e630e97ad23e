#include "render/glyph_plan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "base/contract.h"
#include "ellipsoid/merge_ellipsoids.h"
#include "kinds/glyph_block.h"
#include "render/color_maps.h"

namespace surfcast::render {
namespace {

int radius_code(picture::GlyphRadius radius) {
  switch (radius) {
    case picture::GlyphRadius::kRoot:
      return SURFCAST_GLYPH_ROOT;
    case picture::GlyphRadius::kUnit:
      return SURFCAST_GLYPH_UNIT;
    case picture::GlyphRadius::kEigenvalue:
      break;
  }
  return SURFCAST_GLYPH_EIGENVALUE;
}

/// What colours the glyphs of a block. Tensors without stored colours show their directions.
int color_code(const kinds::GlyphBlock& block, picture::SurfelColor color) {
  switch (color) {
    case picture::SurfelColor::kDirection:
      return SURFCAST_GLYPH_DIRECTION;
    case picture::SurfelColor::kDec:
      return SURFCAST_GLYPH_DEC;
    case picture::SurfelColor::kAttribute:
      return SURFCAST_GLYPH_ATTRIBUTE;
    case picture::SurfelColor::kElevation:
      return SURFCAST_GLYPH_HEIGHT;
    default:
      break;
  }
  return block.source().tensors && !block.colored() ? SURFCAST_GLYPH_DIRECTION : SURFCAST_GLYPH_STORED;
}

tl::unexpected<Error> lacks(const char* option, const std::string& attribute) {
  return fail(ErrorKind::kInvalidInput, std::string(option) + ": the model has no ellipsoids with " + attribute);
}

/// Place and change on the colour map per unit of an attribute.
glm::vec2 ramp_of(const DisplayOptions& display) {
  const double width = std::max(display.last - display.first, 1e-300);
  const auto finite = [](double value) { return static_cast<float>(std::clamp(value, -1e30, 1e30)); };
  return {finite(-display.first / width), finite(1 / width)};
}

layout::GlyphThreshold threshold_of(const model::EllipsoidSource& source, const picture::Threshold& threshold) {
  const int number = attribute_number(source, threshold.attribute);
  return {glm::vec4(threshold.smallest, threshold.largest, std::max(number, 0), number < 0 ? 1 : 0)};
}

/// The centres within half a layer of a slice have values from -1/2 to 1/2: dot(n, c) + w in the camera frame, lengths
/// in units of the projection. A layer of a plane across the grid is as thick as the longest step along its normal:
/// then it has no holes.
layout::GlyphThreshold layer_of(const model::EllipsoidSource& source, const picture::Slice& slice,
                                const geometry::CameraFrame& frame, int unit) {
  const glm::dmat3 steps(source.index_to_world);
  glm::dvec3 normal = slice.normal;
  glm::dvec3 point = slice.point;
  if (slice.axis) {
    normal = glm::transpose(glm::inverse(steps))[*slice.axis];
    point = source.index_to_world[3] + slice.index * steps[*slice.axis];
  } else {
    const glm::dvec3 along = glm::abs(normal * steps);
    normal /= std::max({along.x, along.y, along.z, 1e-300});
  }
  const glm::dvec3 turned(glm::dot(frame.right, normal), glm::dot(frame.up, normal), glm::dot(frame.forward, normal));
  return {glm::vec4(glm::vec3(std::ldexp(1.0, -unit) * turned), glm::dot(normal, frame.eye - point))};
}

layout::GlyphView view_of(const RegionTask& task, const VisibleBlock& visible, int unit, GlyphPlan& plan) {
  const auto* block = dynamic_cast<const kinds::GlyphBlock*>(visible.resident->header.get());
  SURFCAST_EXPECTS(block != nullptr);
  const picture::PictureRequest& request = *task.request;
  layout::GlyphView view{};
  view.size.x = static_cast<float>(std::ldexp(glyph_scale(block->source(), request.glyphs), unit));
  view.size.w = static_cast<float>(request.glyphs.sharpness);
  view.look = {radius_code(request.glyphs.radius), color_code(*block, task.display.color), 0,
               static_cast<int>(kMapEntries) - 1};
  if (view.look.y == SURFCAST_GLYPH_ATTRIBUTE) {
    const glm::vec2 ramp = ramp_of(task.display);
    view.size.y = ramp.x;
    view.size.z = ramp.y;
    view.look.z = attribute_number(block->source(), request.coloring.attribute);
    if (view.look.z < 0) view.look.y = SURFCAST_GLYPH_STORED;
  } else if (view.look.y == SURFCAST_GLYPH_HEIGHT) {
    std::vector<layout::ClipRange> none;
    const glm::vec4 ramp = block_display(task.display, {}, *visible.resident, none).ramp;
    view.size.y = ramp.x;
    view.size.z = ramp.y;
    view.look.z = task.display.up_axis;
  }
  plan.colored |= view.look.y == SURFCAST_GLYPH_ATTRIBUTE || view.look.y == SURFCAST_GLYPH_HEIGHT;
  view.which = {static_cast<int>(plan.ranges.size()), static_cast<int>(request.glyphs.thresholds.size()), 0, 0};
  for (const picture::Threshold& threshold : request.glyphs.thresholds) {
    plan.ranges.push_back(threshold_of(block->source(), threshold));
  }
  view.which.z = static_cast<int>(plan.ranges.size());
  if (!block->source().on_grid()) return view;
  view.which.w = static_cast<int>(request.volumes.slices.size());
  for (const picture::Slice& slice : request.volumes.slices) {
    plan.ranges.push_back(layer_of(block->source(), slice, task.frame, unit));
  }
  return view;
}

/// How far a glyph of a block reaches at most from its centre, world units. By default that is twice the largest radius
/// r of the block (model::EncodedBlock::max_radius): factor value <= 2 r / scale for all of its glyphs.
double extent_of(const ldc::BlockEntry& block, const model::EllipsoidSource& source,
                 const picture::GlyphOptions& glyphs) {
  const double scale = glyph_scale(source, glyphs);
  const double largest = 2 * block.max_radius / source.scale();
  const double factor = block.level == 0 ? 1 : ellipsoid::largest_factor(static_cast<double>(source.counts.drawn));
  switch (glyphs.radius) {
    case picture::GlyphRadius::kRoot:
      return scale * std::sqrt(factor * largest);
    case picture::GlyphRadius::kUnit:
      return scale * factor;
    case picture::GlyphRadius::kEigenvalue:
      break;
  }
  return scale * largest;
}

}  // namespace

std::vector<double> glyph_reaches(const model::ModelFile& model, const picture::GlyphOptions& glyphs) {
  const bool wider = glyphs.shape == picture::GlyphShape::kSuperquadric;
  if (model.ellipsoid_sources().empty()) return {};
  if (!wider && !glyphs.scale && glyphs.radius == picture::GlyphRadius::kEigenvalue) return {};
  const double corner = wider ? std::sqrt(3.0) : 1;  // superquadrics come up to a box
  std::vector<double> reaches(model.blocks().size());
  for (size_t i = reaches.size(); i-- > 0;) {  // parents precede their children
    const ldc::BlockEntry& block = model.blocks()[i];
    if (model.info().kinds[block.kind].kind != model::kEllipsoidKind) continue;
    for (const model::EllipsoidSource& source : model.ellipsoid_sources()) {
      reaches[i] = std::max(reaches[i], corner * extent_of(block, source, glyphs) / 2);
    }
    if (block.parent == ldc::BlockEntry::kNoParent) continue;
    reaches[block.parent] = std::max(reaches[block.parent], reaches[i]);
  }
  return reaches;
}

uint64_t most_glyphs(const picture::PictureRequest& request, uint32_t glyphs_per_surfel) {
  const double spacing = std::max(request.spacing, 1e-3);
  const double surfels = static_cast<double>(request.width) * request.height / (spacing * spacing);
  return static_cast<uint64_t>(std::min(glyphs_per_surfel * surfels, 1e18));
}

double glyph_scale(const model::EllipsoidSource& source, const picture::GlyphOptions& glyphs) {
  if (glyphs.scale) return *glyphs.scale;
  switch (glyphs.radius) {
    case picture::GlyphRadius::kRoot:
      return source.reach / std::sqrt(source.high);
    case picture::GlyphRadius::kUnit:
      return source.reach;
    case picture::GlyphRadius::kEigenvalue:
      break;
  }
  return source.scale();
}

int attribute_number(const model::EllipsoidSource& source, const std::string& name) {
  const auto found = std::ranges::find(source.attributes, name, &model::EllipsoidAttribute::name);
  const auto number = found - source.attributes.begin();
  const size_t known = model::kDerivedAttributes + ellipsoid::kMaxPackedColumns;
  return found == source.attributes.end() || static_cast<size_t>(number) >= known ? -1 : static_cast<int>(number);
}

Status resolve_glyphs(std::span<const model::EllipsoidSource> sources, const picture::PictureRequest& request,
                      DisplayOptions& display) {
  const auto has = [&](const std::string& name) {
    return std::ranges::any_of(sources, [&](const auto& source) { return attribute_number(source, name) >= 0; });
  };
  for (const picture::Threshold& threshold : request.glyphs.thresholds) {
    if (!has(threshold.attribute)) return lacks("threshold", threshold.attribute);
  }
  if (display.color != picture::SurfelColor::kAttribute) return {};
  const std::string& name = request.coloring.attribute;
  if (!has(name)) return lacks("color_by", name);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const model::EllipsoidSource& source : sources) {
    const int number = attribute_number(source, name);
    if (number < 0) continue;
    low = std::min(low, source.attributes[static_cast<size_t>(number)].smallest);
    high = std::max(high, source.attributes[static_cast<size_t>(number)].largest);
  }
  display.first = request.coloring.first.value_or(low);
  display.last = request.coloring.last.value_or(high);
  return {};
}

GlyphPlan plan_glyphs(const RegionTask& task, int unit) {
  GlyphPlan plan;
  for (const VisibleBlock& block : task.blocks) {
    if (task.kinds[block.kind]->drawn_as() != kinds::DrawnAs::kGlyphs) continue;
    plan.views.push_back(view_of(task, block, unit, plan));
  }
  return plan;
}

GlyphLights lights_of(const picture::PictureRequest& request) {
  GlyphLights result{};
  if (request.shading == picture::Shading::kUnlit) result.lighting.size.x = -1;
  if (request.shading == picture::Shading::kUnlit) return result;
  const picture::Lighting& lighting = request.lighting;
  result.lighting.terms = {lighting.ambient, lighting.specular, lighting.exponent, 0};
  result.lighting.size.x = static_cast<int>(lighting.lights.size());
  for (const picture::Light& light : lighting.lights) {
    result.lights.push_back({glm::vec4(glm::vec3(glm::normalize(light.direction)), light.power)});
  }
  return result;
}

}  // namespace surfcast::render
