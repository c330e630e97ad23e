#pragma once

#include "base/result.h"
#include "exporter/point_facts.h"
#include "geometry/box.h"
#include "geometry/camera.h"
#include "geometry/clip.h"
#include "geometry/zone.h"
#include "kinds/source_block.h"
#include "pick/band.h"
#include "picture/device_info.h"
#include "picture/picture.h"
#include "render/renderer.h"
#include "scan/selection.h"
#include "service/model_queries.h"
#include "service/point_stream.h"
#include "surfel/grid.h"
#include "worker/archive.h"

// The members of the structures that cross between the server and a render worker. Each is taken apart by a structured
// binding, which does not compile any more once a structure has another member.

namespace surfcast {

template <typename Archive, worker::Is<Error> T>
void fields(Archive& archive, T& value) {
  auto& [kind, message] = value;
  archive(kind, message);
}

}  // namespace surfcast

namespace surfcast::geometry {

template <typename Archive, worker::Is<Box> T>
void fields(Archive& archive, T& value) {
  auto& [min, max] = value;
  archive(min, max);
}

template <typename Archive, worker::Is<Clip> T>
void fields(Archive& archive, T& value) {
  auto& [inside, outside] = value;
  archive(inside, outside);
}

template <typename Archive, worker::Is<Camera> T>
void fields(Archive& archive, T& value) {
  auto& [position, focal_point, view_up, view_angle] = value;
  archive(position, focal_point, view_up, view_angle);
}

template <typename Archive, worker::Is<Corridor> T>
void fields(Archive& archive, T& value) {
  auto& [line, half_width, low, high] = value;
  archive(line, half_width, low, high);
}

template <typename Archive, worker::Is<Zone> T>
void fields(Archive& archive, T& value) {
  auto& [boxes, corridors] = value;
  archive(boxes, corridors);
}

}  // namespace surfcast::geometry

namespace surfcast::picture {

template <typename Archive, worker::Is<Coloring> T>
void fields(Archive& archive, T& value) {
  auto& [source, map, first, last, attribute] = value;
  archive(source, map, first, last, attribute);
}

template <typename Archive, worker::Is<EyeDome> T>
void fields(Archive& archive, T& value) {
  auto& [strength, radius] = value;
  archive(strength, radius);
}

template <typename Archive, worker::Is<ClassOpacity> T>
void fields(Archive& archive, T& value) {
  auto& [code, opacity] = value;
  archive(code, opacity);
}

template <typename Archive, worker::Is<TransferPoint> T>
void fields(Archive& archive, T& value) {
  auto& [at, color, opacity, extinction] = value;
  archive(at, color, opacity, extinction);
}

template <typename Archive, worker::Is<Transfer> T>
void fields(Archive& archive, T& value) {
  auto& [points, spacing, preset, first, last] = value;
  archive(points, spacing, preset, first, last);
}

template <typename Archive, worker::Is<IsoSurface> T>
void fields(Archive& archive, T& value) {
  auto& [at, color, opacity] = value;
  archive(at, color, opacity);
}

template <typename Archive, worker::Is<Slice> T>
void fields(Archive& archive, T& value) {
  auto& [point, normal, axis, index] = value;
  archive(point, normal, axis, index);
}

template <typename Archive, worker::Is<VolumeOptions> T>
void fields(Archive& archive, T& value) {
  auto& [transfer, shaded, medium, isos, slices] = value;
  archive(transfer, shaded, medium, isos, slices);
}

template <typename Archive, worker::Is<Threshold> T>
void fields(Archive& archive, T& value) {
  auto& [attribute, smallest, largest] = value;
  archive(attribute, smallest, largest);
}

template <typename Archive, worker::Is<GlyphOptions> T>
void fields(Archive& archive, T& value) {
  auto& [shape, radius, scale, sharpness, thresholds] = value;
  archive(shape, radius, scale, sharpness, thresholds);
}

template <typename Archive, worker::Is<Light> T>
void fields(Archive& archive, T& value) {
  auto& [direction, power] = value;
  archive(direction, power);
}

template <typename Archive, worker::Is<Lighting> T>
void fields(Archive& archive, T& value) {
  auto& [ambient, specular, exponent, lights] = value;
  archive(ambient, specular, exponent, lights);
}

template <typename Archive, worker::Is<PlainOptions> T>
void fields(Archive& archive, T& value) {
  with_members(value, archive);
}

template <typename Archive, worker::Is<PictureParameters> T>
void fields(Archive& archive, T& value) {
  auto& [camera, width, height, silhouettes, blends_behind, surveyed, format, loading, edition, viewer, rest_spacing,
         displayed_cut, max_missing_blocks, coloring, hidden_classes, clip, eye_dome, volumes, glyphs, lighting,
         class_opacities, hidden_models, depth_texels] = value;
  archive(camera, width, height, silhouettes, blends_behind, surveyed, format, loading, edition, viewer, rest_spacing);
  archive(displayed_cut, max_missing_blocks, coloring, hidden_classes, clip, eye_dome, volumes, glyphs, lighting);
  archive(class_opacities, hidden_models, depth_texels);
}

/// It has no members but those of its two bases.
template <typename Archive, worker::Is<PictureRequest> T>
void fields(Archive& archive, T& value) {
  static_assert(sizeof(PictureRequest) == sizeof(PlainOptions) + sizeof(PictureParameters));
  worker::BaseOf<PlainOptions, T>& options = value;
  worker::BaseOf<PictureParameters, T>& parameters = value;
  archive(options, parameters);
}

template <typename Archive, worker::Is<StageTime> T>
void fields(Archive& archive, T& value) {
  auto& [name, milliseconds] = value;
  archive(name, milliseconds);
}

template <typename Archive, worker::Is<LevelStats> T>
void fields(Archive& archive, T& value) {
  auto& [level, selected, drawn] = value;
  archive(level, selected, drawn);
}

template <typename Archive, worker::Is<FrameStats> T>
void fields(Archive& archive, T& value) {
  auto& [surfels_drawn, blocks_drawn, blocks_selected, holes, blocks_waited_for, blocks_missing, blocks_resident,
         bytes_resident, levels, gl_renderer, stages] = value;
  archive(surfels_drawn, blocks_drawn, blocks_selected, holes, blocks_waited_for, blocks_missing, blocks_resident);
  archive(bytes_resident, levels, gl_renderer, stages);
}

template <typename Archive, worker::Is<DepthMap> T>
void fields(Archive& archive, T& value) {
  auto& [width, height, cell, inverse, seen_through] = value;
  archive(width, height, cell, inverse, seen_through);
}

/// The pixels travel in shared memory.
template <typename Archive, worker::Is<Frame> T>
void fields(Archive& archive, T& value) {
  auto& [image, camera, converged, nothing_pending, cut, spacing, render_scale, expected_error, expected_ms, preview,
         depth, stats] = value;
  auto& [width, height, format, pixels] = image;
  archive(width, height, format, camera, converged, nothing_pending, cut, preview, depth, stats);
  archive(spacing, render_scale, expected_error, expected_ms);
}

template <typename Archive, worker::Is<MemoryBudgets> T>
void fields(Archive& archive, T& value) {
  auto& [gpu, host] = value;
  archive(gpu, host);
}

template <typename Archive, worker::Is<DeviceInfo> T>
void fields(Archive& archive, T& value) {
  auto& [vendor, renderer, version, software, memory] = value;
  archive(vendor, renderer, version, software, memory);
}

}  // namespace surfcast::picture

namespace surfcast::render {

/// The worker has its own table of kinds and its own guard.
template <typename Archive, worker::Is<RendererConfig> T>
void fields(Archive& archive, T& value) {
  auto& [gpu, gpu_bytes, host_bytes, sharers, decoders, upload_bytes, motion_glyphs, viewers, gpu_kernels, list_entries,
         surveys, shader_defines, kinds, load_guard] = value;
  archive(gpu, gpu_bytes, host_bytes, sharers, decoders, upload_bytes, motion_glyphs, viewers, gpu_kernels,
          list_entries, surveys);
  archive(shader_defines);
}

}  // namespace surfcast::render

namespace surfcast::surfel {

template <typename Archive, worker::Is<Grid> T>
void fields(Archive& archive, T& value) {
  auto& [scale, offset] = value;
  archive(scale, offset);
}

}  // namespace surfcast::surfel

namespace surfcast::kinds {

template <typename Archive, worker::Is<PickedValue> T>
void fields(Archive& archive, T& value) {
  auto& [attribute, number] = value;
  archive(attribute, number);
}

template <typename Archive, worker::Is<PickedSurfel> T>
void fields(Archive& archive, T& value) {
  auto& [position, normal, color, radius, distance, values, depth, number, member] = value;
  archive(position, normal, color, radius, distance, values, depth, number, member);
}

}  // namespace surfcast::kinds

namespace surfcast::pick {

template <typename Archive, worker::Is<CoursePlace> T>
void fields(Archive& archive, T& value) {
  auto& [along, across] = value;
  archive(along, across);
}

template <typename Archive, worker::Is<BandPoint> T>
void fields(Archive& archive, T& value) {
  auto& [position, place, color] = value;
  archive(position, place, color);
}

template <typename Archive, worker::Is<BandQuery> T>
void fields(Archive& archive, T& value) {
  auto& [line, width, most] = value;
  archive(line, width, most);
}

}  // namespace surfcast::pick

namespace surfcast::scan {

template <typename Archive, worker::Is<Selection> T>
void fields(Archive& archive, T& value) {
  auto& [zone, classes, every] = value;
  archive(zone, classes, every);
}

}  // namespace surfcast::scan

namespace surfcast::exporter {

template <typename Archive, worker::Is<ModelSelection> T>
void fields(Archive& archive, T& value) {
  auto& [points, source_coordinates, normals] = value;
  archive(points, source_coordinates, normals);
}

template <typename Archive, worker::Is<PointFacts> T>
void fields(Archive& archive, T& value) {
  auto& [count, bounds, returns, grid] = value;
  archive(count, bounds, returns, grid);
}

}  // namespace surfcast::exporter

namespace surfcast::service {

template <typename Archive, worker::Is<SurfaceQuery> T>
void fields(Archive& archive, T& value) {
  auto& [request, up_from_model] = value;
  archive(request, up_from_model);
}

template <typename Archive, worker::Is<PixelQuery> T>
void fields(Archive& archive, T& value) {
  auto& [picture, x, y, most_blocks] = value;
  archive(picture, x, y, most_blocks);
}

template <typename Archive, worker::Is<PointsQuery> T>
void fields(Archive& archive, T& value) {
  auto& [model, selection, format, most, only_count] = value;
  archive(model, selection, format, most, only_count);
}

template <typename Archive, worker::Is<PointPiece> T>
void fields(Archive& archive, T& value) {
  auto& [bytes, last] = value;
  archive(bytes, last);
}

}  // namespace surfcast::service
