#include "net/http_answer.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include <spdlog/fmt/fmt.h>

#include "base/json_text.h"
#include "model/volume_facts.h"
#include "net/convert.h"
#include "protocol/errors.h"
#include "protocol/pick_result_text.h"
#include "protocol/profile_file.h"

namespace surfcast::net {
namespace {

using nlohmann::json;

constexpr std::string_view kJson = "application/json";

/// What a page of the viewer may load and talk to: its own server, and pictures that it made itself.
constexpr std::string_view kPolicy =
    "default-src 'self'; img-src 'self' blob: data:; connect-src 'self' ws: wss:; style-src 'self' 'unsafe-inline'; "
    "worker-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'";

unsigned status_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kInvalidInput:
    case ErrorKind::kLimit:
      return 400;
    case ErrorKind::kUnsupported:
      return 501;
    case ErrorKind::kNotFound:
      return 404;
    case ErrorKind::kCancelled:
    case ErrorKind::kUnavailable:
    case ErrorKind::kReplaced:
      return 503;
    case ErrorKind::kIo:
    case ErrorKind::kInternal:
      break;
  }
  return 500;
}

HttpAnswer json_answer(const json& document) {
  return text_answer(json_text(document, 2) + "\n", kJson);
}

json to_json(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

json to_json(const geometry::Camera& camera) {
  return {{"position", to_json(camera.position)},
          {"focal_point", to_json(camera.focal_point)},
          {"view_up", to_json(camera.view_up)},
          {"view_angle", camera.view_angle}};
}

/// A header's value must be a token there: anything else becomes an underscore.
std::string token(std::string_view text) {
  std::string clean(text);
  for (char& c : clean) {
    const bool allowed = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    if (!allowed) c = '_';
  }
  return clean;
}

std::string server_timing(const std::vector<picture::StageTime>& stages) {
  std::ostringstream out;
  for (const picture::StageTime& stage : stages) {
    if (out.tellp() > 0) out << ", ";
    out << token(stage.name) << ";dur=" << stage.milliseconds;
  }
  return out.str();
}

}  // namespace

HttpAnswer text_answer(std::string_view text, std::string_view content_type) {
  HttpAnswer answer;
  answer.content_type = content_type;
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  answer.body.assign(first, first + text.size());
  return answer;
}

HttpAnswer error_answer(const Error& error, unsigned status) {
  HttpAnswer answer = json_answer(
      {{"error", {{"kind", protocol::name_of(error.kind)}, {"message", protocol::clean_utf8(error.message)}}}});
  answer.status = status;
  if (status == 503) answer.headers.emplace_back("Retry-After", "1");
  return answer;
}

HttpAnswer error_answer(const Error& error) {
  return error_answer(error, status_of(error.kind));
}

namespace {

const char* name_of(service::ScanStatus::State state) {
  switch (state) {
    case service::ScanStatus::State::kWaiting:
      return "waiting";
    case service::ScanStatus::State::kBuilding:
      return "building";
    case service::ScanStatus::State::kFailed:
      break;
  }
  return "failed";
}

json to_json(const service::ScanStatus& scan) {
  json document{{"model", scan.model}, {"state", name_of(scan.state)}, {"preview", scan.edition > 0}};
  if (scan.state == service::ScanStatus::State::kFailed) {
    document["problem"] = scan.problem;
    return document;
  }
  document["percent"] = std::floor(1000 * scan.done) / 10;
  document["seconds_left"] = scan.seconds_left > 0 ? json(std::ceil(scan.seconds_left)) : json();
  return document;
}

json to_json(const model::AttributeRange& range) {
  return {{"attribute", range.attribute},
          {"smallest", range.smallest},
          {"largest", range.largest},
          {"low", range.low},
          {"high", range.high}};
}

json to_json(const model::Volume& volume) {
  const glm::dmat4x3& axes = volume.index_to_world;
  return {{"name", volume.name},
          {"size", {volume.size.x, volume.size.y, volume.size.z}},
          {"spacing", to_json(spacing_of(volume))},
          {"index_to_world", {to_json(axes[0]), to_json(axes[1]), to_json(axes[2]), to_json(axes[3])}},
          {"frame", frame_name(volume)},
          {"length_unit", volume.length_unit},
          {"type", type_name(volume)},
          {"low", volume.low},
          {"high", volume.high},
          {"sample_unit", volume.sample_unit},
          {"histogram", volume.histogram}};
}

json to_json(const model::EllipsoidAttribute& attribute) {
  return {{"attribute", attribute.name}, {"smallest", attribute.smallest}, {"largest", attribute.largest}};
}

json to_json(const model::EllipsoidSource& source) {
  json ranges = json::array();
  for (const model::EllipsoidAttribute& attribute : source.attributes) ranges.push_back(to_json(attribute));
  return {{"name", source.name},
          {"tensors", source.tensors},
          {"size", {source.size.x, source.size.y, source.size.z}},
          {"samples", source.counts.samples},
          {"drawn", source.counts.drawn},
          {"scale", source.scale()},
          {"mean_fa", source.mean_anisotropy},
          {"mean_mode", source.mean_mode},
          {"mean_eigenvalues", to_json(source.mean_values)},
          {"length_unit", source.length_unit},
          {"sample_unit", source.sample_unit},
          {"ranges", ranges}};
}

template <typename Values, typename Convert>
json array_of(const Values& values, const Convert& convert) {
  json array = json::array();
  for (const auto& value : values) array.push_back(convert(value));
  return array;
}

json to_json(const model::CoordinateSystem& system) {
  return {{"name", system.name}, {"id", system.id}, {"wkt", system.wkt}};
}

json to_json(const model::Georeference& georeference) {
  json document = to_json(georeference.system);
  if (georeference.source.known()) document["source"] = to_json(georeference.source);
  return document;
}

json to_json(const geometry::Box& box) {
  return {{"min", to_json(box.min)}, {"max", to_json(box.max)}};
}

json to_json(const std::vector<model::KindCount>& kinds) {
  return array_of(kinds, [](const model::KindCount& kind) {
    return json{{"kind", kind.kind}, {"blocks", kind.blocks}, {"count", kind.items}};
  });
}

json to_json(const service::MemberDescription& member) {
  return {{"model", member.name}, {"bounds", to_json(member.bounds)}, {"kinds", to_json(member.kinds)}};
}

json description_of(const std::string& name, const service::ModelDescription& description) {
  const model::ModelInfo& info = description.info;
  return {{"model", name},
          {"surfels", info.surfels},
          {"bounds", to_json(info.bounds)},
          {"elevation", {{"low", info.elevation.low}, {"high", info.elevation.high}}},
          {"oriented", info.oriented},
          {"up_axis", std::string(info.upside_down ? "-" : "") + (info.z_up ? "z" : "y")},
          {"color_bits", info.color_bits},
          {"attributes", info.scalar_names},
          {"sources", info.source_names},
          {"levels", description.levels},
          {"blocks", description.blocks},
          {"spacing", description.spacing},
          {"kinds", to_json(info.kinds)},
          {"volumes", array_of(description.volumes, [](const model::Volume& volume) { return to_json(volume); })},
          {"ellipsoids",
           array_of(description.ellipsoids, [](const model::EllipsoidSource& source) { return to_json(source); })},
          {"ranges", array_of(info.ranges, [](const model::AttributeRange& range) { return to_json(range); })},
          {"classes", array_of(info.classes, [](const model::ClassCount& count) {
             return json{{"code", count.code}, {"surfels", count.surfels}};
           })}};
}

}  // namespace

HttpAnswer models_answer(const service::ModelList& models, const UploadConfig& uploads) {
  json document{{"models", models.names},
                {"scans", array_of(models.scans, [](const service::ScanStatus& scan) { return to_json(scan); })}};
  if (!uploads.folder.empty()) {
    document["uploads"] = {{"max_bytes", uploads.bytes}, {"extensions", all_extensions(uploads)}};
  }
  return json_answer(document);
}

HttpAnswer uploaded_answer(const char* what, const std::string& name) {
  HttpAnswer answer = json_answer({{what, name}});
  answer.status = 201;
  return answer;
}

HttpAnswer model_answer(const std::string& name, const service::ModelDescription& description) {
  json document = description_of(name, description);
  if (description.georeference.known()) document["coordinate_system"] = to_json(description.georeference);
  if (!description.members.empty()) {
    document["members"] =
        array_of(description.members, [](const service::MemberDescription& member) { return to_json(member); });
  }
  return json_answer(document);
}

HttpAnswer picture_answer(service::EncodedPicture picture) {
  HttpAnswer answer;
  answer.content_type = media_type(picture.format);
  answer.headers = {{"Server-Timing", server_timing(picture.stats.stages)},
                    {"X-Surfcast-Camera", json_text(to_json(picture.camera))},
                    {"X-Surfcast-Surfels", std::to_string(picture.stats.surfels_drawn)},
                    {"X-Surfcast-Blocks", std::to_string(picture.stats.blocks_drawn)},
                    {"X-Surfcast-Converged", picture.converged && !picture.preview ? "true" : "false"},
                    {"X-Surfcast-Preview", picture.preview ? "true" : "false"},
                    {"Cache-Control", "no-cache"}};
  if (picture.expected_ms > 0) {  // the spacing was chosen
    answer.headers.emplace_back("X-Surfcast-Spacing", fmt::format("{}", picture.spacing));
    answer.headers.emplace_back("X-Surfcast-Render-Scale", fmt::format("{}", picture.render_scale));
    answer.headers.emplace_back("X-Surfcast-Expected-Error", fmt::format("{}", picture.expected_error));
    answer.headers.emplace_back("X-Surfcast-Expected-Ms", fmt::format("{}", picture.expected_ms));
  }
  answer.body = std::move(picture.bytes);
  answer.memory = std::move(picture.memory);
  return answer;
}

HttpAnswer file_answer(const StaticFile& file, std::string_view if_none_match) {
  HttpAnswer answer;
  answer.content_type = file.media_type;
  answer.headers = {{"Cache-Control", file.immutable ? "public, max-age=31536000, immutable" : "no-cache"},
                    {"ETag", file.tag},
                    {"Content-Security-Policy", std::string(kPolicy)}};
  if (if_none_match.find(file.tag) == std::string_view::npos) {
    answer.body = file.content;
  } else {
    answer.status = 304;
  }
  return answer;
}

HttpAnswer pick_answer(const std::optional<service::PickedPoint>& picked) {
  wire::PickResult result;
  to_wire(picked, result);
  return text_answer(protocol::pick_result_json(result), kJson);
}

HttpAnswer profile_answer(const std::string& name, const service::ProfileResult& profile,
                          protocol::ProfileFormat format) {
  wire::Profile message;
  to_wire(profile, message);
  HttpAnswer answer = text_answer(protocol::profile_file(message, format), protocol::media_type(format));
  const std::string file = token(name) + "-profile." + std::string(protocol::extension_of(format));
  answer.headers = {{"Content-Disposition", "attachment; filename=\"" + file + "\""},
                    {"X-Surfcast-Points", std::to_string(profile.band.points.size())},
                    {"X-Surfcast-Total", std::to_string(profile.band.total)},
                    {"Cache-Control", "no-cache"}};
  return answer;
}

HttpAnswer point_count_answer(uint64_t points, uint64_t most) {
  HttpAnswer answer = json_answer({{"points", points}});
  answer.headers = {{"X-Surfcast-Max-Points", std::to_string(most)}, {"Cache-Control", "no-cache"}};
  return answer;
}

HttpAnswer points_answer(const std::string& name, std::string_view format, uint64_t points) {
  HttpAnswer answer;
  answer.content_type = format == "csv" ? "text/csv; charset=utf-8" : "application/octet-stream";
  const std::string file = token(name) + "-points." + std::string(format);
  answer.headers = {{"Content-Disposition", "attachment; filename=\"" + file + "\""},
                    {"X-Surfcast-Points", std::to_string(points)},
                    {"Cache-Control", "no-cache"}};
  return answer;
}

HttpAnswer no_viewer_answer() {
  HttpAnswer answer = text_answer(
      "This Surfcast server has no viewer. Build it in client/web (make, with npm installed), or name its folder with\n"
      "surfcastd serve --viewer DIR. The models are listed at /api/models.\n",
      "text/plain; charset=utf-8");
  answer.headers = {{"Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'"}};
  return answer;
}

}  // namespace surfcast::net
