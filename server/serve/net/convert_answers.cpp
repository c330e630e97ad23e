// Pictures, picks and profiles as messages.
#include <utility>

#include "net/convert.h"
#include "protocol/errors.h"
#include "protocol/picture_fields.h"

namespace surfcast::net {
namespace {

wire::FileFormat to_wire(picture::FileFormat value) {
  switch (value) {
    case picture::FileFormat::kJpeg:
      return wire::FILE_FORMAT_JPEG;
    case picture::FileFormat::kWebp:
      return wire::FILE_FORMAT_WEBP;
    case picture::FileFormat::kExr:
      return wire::FILE_FORMAT_EXR;
    case picture::FileFormat::kPng:
      break;
  }
  return wire::FILE_FORMAT_PNG;
}

void to_wire(const geometry::Camera& camera, wire::Camera* message) {
  net::to_wire(camera.position, message->mutable_position());
  net::to_wire(camera.focal_point, message->mutable_focal_point());
  net::to_wire(camera.view_up, message->mutable_view_up());
  message->set_view_angle(camera.view_angle);
}

}  // namespace

void to_wire(const service::ProfileResult& result, wire::Profile& message) {
  const pick::Band& band = result.band;
  message.set_total(band.total);
  message.set_length(band.length);
  message.set_z_up(result.z_up);
  to_wire(band.grid.scale, message.mutable_scale());
  to_wire(band.grid.offset, message.mutable_offset());
  message.set_color_bits(static_cast<uint32_t>(result.color_bits));
  for (const pick::BandPoint& point : band.points) {
    message.add_x(point.position.x);
    message.add_y(point.position.y);
    message.add_z(point.position.z);
    message.add_along(point.place.along);
    message.add_across(point.place.across);
    if (result.color_bits == 0) continue;
    message.add_red(point.color.r);
    message.add_green(point.color.g);
    message.add_blue(point.color.b);
  }
  for (size_t a = 0; a < result.attributes.size(); ++a) {
    wire::AttributeColumn* column = message.add_attributes();
    column->set_attribute(protocol::clean_utf8(result.attributes[a]));
    for (size_t i = a; i < band.values.size(); i += result.attributes.size()) column->add_values(band.values[i]);
  }
}

void to_wire(const std::optional<service::PickedPoint>& picked, wire::PickResult& message) {
  message.set_hit(picked.has_value());
  if (!picked) return;
  to_wire(picked->position, message.mutable_position());
  if (picked->source_position) to_wire(*picked->source_position, message.mutable_source_position());
  to_wire(picked->normal, message.mutable_normal());
  if (picked->color) {
    message.mutable_color()->set_red(picked->color->r);
    message.mutable_color()->set_green(picked->color->g);
    message.mutable_color()->set_blue(picked->color->b);
  }
  message.set_radius(picked->radius);
  message.set_distance(picked->distance);
  message.set_depth(picked->depth);
  message.set_surfel(picked->number);
  message.set_model(protocol::clean_utf8(picked->model));
  for (const kinds::PickedValue& value : picked->values) {
    wire::AttributeValue* attribute = message.add_attributes();
    attribute->set_attribute(protocol::clean_utf8(value.attribute));
    attribute->set_value(value.value);
  }
}

void to_wire(service::EncodedPicture picture, wire::Picture& message) {
  message.set_data(picture.bytes.data(), picture.bytes.size());
  message.set_format(to_wire(picture.format));
  to_wire(picture.camera, message.mutable_camera());
  message.mutable_resolution()->set_width(static_cast<uint32_t>(picture.width));
  message.mutable_resolution()->set_height(static_cast<uint32_t>(picture.height));
  message.set_normalization(picture.normalization == picture::Normalization::kSurfel ? wire::NORMALIZATION_SURFEL
                                                                                     : wire::NORMALIZATION_PIXEL);
  message.set_spacing(picture.spacing);
  message.set_render_scale(picture.render_scale);
  message.set_expected_error(picture.expected_error);
  message.set_expected_ms(picture.expected_ms);
  message.set_converged(picture.converged && !picture.preview);
  message.set_preview(picture.preview);
  message.set_surfels_drawn(picture.stats.surfels_drawn);
  message.set_blocks_drawn(picture.stats.blocks_drawn);
  message.set_blocks_selected(picture.stats.blocks_selected);
  message.set_blocks_waited_for(picture.stats.blocks_waited_for);
  message.set_blocks_resident(picture.stats.blocks_resident);
  message.set_bytes_resident(picture.stats.bytes_resident);
  for (const picture::LevelStats& stats : picture.stats.levels) {
    wire::Level* level = message.add_levels();
    level->set_level(static_cast<uint32_t>(stats.level));
    level->set_blocks_selected(stats.selected);
    level->set_blocks_drawn(stats.drawn);
  }
  message.set_gl_renderer(protocol::clean_utf8(picture.stats.gl_renderer));
  for (const picture::StageTime& time : picture.stats.stages) {
    wire::Stage* stage = message.add_stages();
    stage->set_name(protocol::clean_utf8(time.name));
    stage->set_milliseconds(time.milliseconds);
  }
}

void to_wire(const picture::EncodedDepth& depth, wire::DepthPlane& message) {
  message.set_width(static_cast<uint32_t>(depth.width));
  message.set_height(static_cast<uint32_t>(depth.height));
  message.set_cell(static_cast<uint32_t>(depth.cell));
  message.set_first(depth.first);
  message.set_last(depth.last);
  message.set_codes(depth.codes.data(), depth.codes.size());
  message.set_seen_through(depth.seen_through);
}

void to_wire(view::ViewMessage message, wire::ViewFrame& frame) {
  frame.set_frame(message.frame);
  frame.set_more(message.more);
  if (!message.first) {
    const std::vector<std::byte>& piece = message.picture.bytes;
    frame.mutable_picture()->set_data(piece.data(), piece.size());
    return;
  }
  frame.set_update(message.update);
  frame.mutable_resolution()->set_width(static_cast<uint32_t>(message.width));
  frame.mutable_resolution()->set_height(static_cast<uint32_t>(message.height));
  frame.set_moving(message.moving);
  if (const std::optional<service::PacketPlace>& place = message.picture.video) {
    frame.mutable_video()->set_codec(wire::VIDEO_CODEC_VP9);
    frame.mutable_video()->set_key(place->key);
    frame.mutable_video()->set_refers_to(place->refers_to);
  }
  if (message.picture.depth) to_wire(*message.picture.depth, *frame.mutable_depth());
  to_wire(std::move(message.picture), *frame.mutable_picture());
}

std::string media_type(picture::FileFormat format) {
  return std::string(protocol::media_type(to_wire(format)));
}

}  // namespace surfcast::net
