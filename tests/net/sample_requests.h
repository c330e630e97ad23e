#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include "protocol/sample_fields.h"
#include "surfcast.pb.h"

namespace surfcast::net {

inline void fill(wire::Vector3* vector, double x, double y, double z) {
  vector->set_x(x);
  vector->set_y(y);
  vector->set_z(z);
}

/// A picture with every field set, but for those that exclude the spacing.
inline wire::DrawPicture sample_picture() {
  wire::DrawPicture picture;
  picture.set_model("cube");
  fill(picture.mutable_camera()->mutable_position(), 500'000.25, 4e6, 12);
  fill(picture.mutable_camera()->mutable_focal_point(), 500'010, 4e6, -3);
  fill(picture.mutable_camera()->mutable_view_up(), 0, 0.1, 1);
  picture.mutable_camera()->set_view_angle(45);
  picture.mutable_resolution()->set_width(16);
  picture.mutable_resolution()->set_height(9);
  picture.set_format(wire::FILE_FORMAT_JPEG);
  picture.set_quality(80);
  picture.mutable_coloring()->set_source(wire::COLOR_SOURCE_INTENSITY);
  picture.mutable_coloring()->set_first(-1);
  picture.mutable_coloring()->set_last(1);
  picture.add_hidden_classes(7);
  picture.add_hidden_classes(300);
  picture.add_hidden_models("nave");
  wire::ClipBox* clip = picture.add_clip_boxes();
  fill(clip->mutable_box()->mutable_min(), -1, -1, -1);
  fill(clip->mutable_box()->mutable_max(), 1, 2, 3);
  clip->set_inverted(true);
  picture.mutable_eye_dome()->set_strength(1);
  picture.mutable_eye_dome()->set_radius(2);
  wire::TransferPoint& point = *picture.mutable_transfer()->add_points();
  point.set_value(-3);
  point.mutable_color()->set_red(255);
  point.set_opacity(0.5);
  picture.mutable_transfer()->set_first(1);
  picture.add_iso_surfaces()->set_value(0.5);
  picture.mutable_iso_surfaces(0)->mutable_color()->set_green(9);
  picture.mutable_iso_surfaces(0)->set_opacity(0.5);
  wire::Slice* slice = picture.add_slices();
  fill(slice->mutable_point(), 1, 2, 3);
  fill(slice->mutable_normal(), 0, 0, 1);
  slice->set_axis(wire::GRID_AXIS_J);
  slice->set_index(4);
  picture.add_class_opacities()->set_code(5);
  picture.mutable_class_opacities(0)->set_opacity(0.25);
  for (const protocol::PictureField& field : protocol::picture_fields()) {
    if (field.value.kind == protocol::FieldKind::kStructured || field.name == "error" || field.name == "time") continue;
    if (!protocol::set_picture_field(picture, field.name, protocol::sample_text(field))) std::abort();
  }
  picture.add_channels(wire::CHANNEL_DEPTH);
  picture.add_channels(wire::CHANNEL_SURFEL);
  return picture;
}

inline wire::GetPoints sample_points() {
  wire::GetPoints points;
  points.set_model("cube");
  fill(points.add_boxes()->mutable_min(), 1, 2, 3);
  fill(points.mutable_boxes(0)->mutable_max(), 4, 5, 6);
  wire::Corridor* corridor = points.add_corridors();
  for (const double number : {0.0, 1.0, 2.0, 3.0}) corridor->add_line(number);
  corridor->set_width(0.5);
  corridor->set_low(-1);
  corridor->set_high(8);
  points.add_classes(2);
  points.set_every(3);
  points.set_format(wire::POINT_FORMAT_LAZ);
  points.set_max_points(7);
  points.set_only_count(true);
  points.set_normals(true);
  points.set_world_coordinates(true);
  return points;
}

/// A request of every kind, each with every field set, by the name of its kind. Ids are small and different.
/// The same, whose spacing is chosen.
inline wire::DrawPicture sample_picture_to_error() {
  wire::DrawPicture picture = sample_picture();
  picture.clear_spacing();
  picture.set_error(40);
  return picture;
}

inline std::vector<wire::Request> sample_requests() {
  std::vector<wire::Request> requests(13);
  requests[0].mutable_list_models();
  requests[1].mutable_describe_model()->set_model("teapot");
  *requests[2].mutable_draw_picture() = sample_picture();
  requests[3].mutable_cancel()->set_request_id(3);
  requests[4].mutable_ping();
  *requests[5].mutable_pick_surfel()->mutable_picture() = sample_picture();
  requests[5].mutable_pick_surfel()->set_x(3);
  requests[5].mutable_pick_surfel()->set_y(5);
  *requests[6].mutable_open_view()->mutable_picture() = sample_picture();
  requests[6].mutable_open_view()->set_target_fps(25);
  requests[7].mutable_update_view()->set_update(12);
  requests[7].mutable_update_view()->set_moving(true);
  *requests[7].mutable_update_view()->mutable_picture() = sample_picture();
  requests[8].mutable_frame_painted()->set_frame(1);
  requests[8].mutable_frame_painted()->set_client_ms(4.5);
  requests[9].mutable_close_view()->set_view(7);
  requests[10].mutable_get_profile()->set_model("cube");
  fill(requests[10].mutable_get_profile()->add_line(), 1, 2, 3);
  fill(requests[10].mutable_get_profile()->add_line(), 4, 5, 6);
  requests[10].mutable_get_profile()->set_width(0.5);
  requests[10].mutable_get_profile()->set_max_points(7);
  *requests[11].mutable_get_points() = sample_points();
  *requests[12].mutable_draw_picture() = sample_picture_to_error();
  for (size_t i = 0; i < requests.size(); ++i) requests[i].set_id(i + 1);
  requests[7].set_id(7);  // the view's
  requests[8].set_id(7);
  return requests;
}

}  // namespace surfcast::net
