#include "protocol/save_picture.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/json_text.h"
#include "protocol/camera_path.h"
#include "protocol/film.h"
#include "protocol/picture_fields.h"

namespace surfcast::protocol {
namespace {

using nlohmann::json;

json to_json(const wire::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

json to_json(const wire::Camera& camera) {
  return {{"position", to_json(camera.position())},
          {"focal_point", to_json(camera.focal_point())},
          {"view_up", to_json(camera.view_up())},
          {"view_angle", camera.view_angle()}};
}

Status write_to_stdout(const std::string& data) {
  if (std::fwrite(data.data(), 1, data.size(), stdout) == data.size() && std::fflush(stdout) == 0) return {};
  return fail(ErrorKind::kIo, "cannot write the picture to standard output");
}

using Draw = std::function<Result<wire::Picture>(const wire::DrawPicture&)>;

/// Draws the frames of the camera path, and hands each to `take` with its number.
Status draw_path(const RequestFlags& flags, const wire::DrawPicture& picture, const Draw& draw,
                 const std::function<Status(int, const wire::Picture&)>& take) {
  const Result<CameraPath> path = CameraPath::read(flags.path(), flags.seconds_per_view());
  if (!path) return fail(path);
  const Result<int> frames = path->frames(flags.frames_per_second());
  if (!frames) return fail(frames);
  for (int number = 0; number < *frames; ++number) {
    wire::DrawPicture frame = picture;
    *frame.mutable_camera() = path->camera_of(number, flags.frames_per_second());
    const Result<wire::Picture> drawn = draw(frame);
    if (!drawn) return fail(drawn);
    if (Status taken = take(number, *drawn); !taken) return taken;
  }
  return {};
}

Status draw_frames(const RequestFlags& flags, const wire::DrawPicture& picture, const Draw& draw) {
  return draw_path(flags, picture, draw, [&](int number, const wire::Picture& drawn) -> Status {
    const Result<std::string> name = frame_name(flags.output(), number);
    return name ? save_picture(drawn, *name, {}) : fail(name);
  });
}

Status draw_film(const RequestFlags& flags, const wire::DrawPicture& picture, const Draw& draw) {
  Result<FilmWriter> film = FilmWriter::create(flags.output(), flags.frames_per_second());
  if (!film) return fail(film);
  const auto add = [&](int /*number*/, const wire::Picture& drawn) { return film->append(drawn.data()); };
  if (Status drawn = draw_path(flags, picture, draw, add); !drawn) return drawn;
  return film->finish();
}

}  // namespace

std::string picture_stats_json(const wire::Picture& picture) {
  json stages = json::object();
  for (const wire::Stage& stage : picture.stages()) stages[stage.name()] = stage.milliseconds();
  json levels = json::array();
  for (const wire::Level& level : picture.levels()) {
    levels.push_back({{"level", level.level()},
                      {"blocks_selected", level.blocks_selected()},
                      {"blocks_drawn", level.blocks_drawn()}});
  }
  json document = {{"format", name_of(picture.format())},
                   {"bytes", picture.data().size()},
                   {"resolution", {picture.resolution().width(), picture.resolution().height()}},
                   {"camera", to_json(picture.camera())},
                   {"normalization", picture.normalization() == wire::NORMALIZATION_SURFEL ? "surfel" : "pixel"},
                   {"spacing", picture.spacing()},
                   {"render_scale", picture.render_scale()},
                   {"converged", picture.converged()},
                   {"surfels_drawn", picture.surfels_drawn()},
                   {"blocks_drawn", picture.blocks_drawn()},
                   {"blocks_selected", picture.blocks_selected()},
                   {"blocks_waited_for", picture.blocks_waited_for()},
                   {"blocks_resident", picture.blocks_resident()},
                   {"bytes_resident", picture.bytes_resident()},
                   {"levels", levels},
                   {"gl_renderer", picture.gl_renderer()},
                   {"milliseconds", stages}};
  if (picture.expected_ms() > 0) {  // the spacing was chosen
    document["expected_error"] = picture.expected_error();
    document["expected_ms"] = picture.expected_ms();
  }
  return json_text(document, 2) + "\n";
}

Status save_picture(const wire::Picture& picture, const std::string& output, const std::string& stats) {
  Status written =
      output == "-" ? write_to_stdout(picture.data()) : write_file_atomically(output, std::string_view(picture.data()));
  if (!written || stats.empty()) return written;
  return write_file_atomically(stats, picture_stats_json(picture));
}

Status draw_and_save(const RequestFlags& flags, const wire::DrawPicture& picture,
                     const std::function<Result<wire::Picture>(const wire::DrawPicture&)>& draw) {
  if (flags.path().empty()) {
    const Result<wire::Picture> drawn = draw(picture);
    return drawn ? save_picture(*drawn, flags.output(), flags.stats()) : fail(drawn);
  }
  return is_film(flags.output()) ? draw_film(flags, picture, draw) : draw_frames(flags, picture, draw);
}

}  // namespace surfcast::protocol
