#include "builder/build_plan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/hash.h"
#include "base/json_text.h"
#include "builder/input_files.h"

namespace surfcast::builder {
namespace {

using PlanJson = nlohmann::ordered_json;

constexpr int kPlanVersion = 1;

/// JSON has no infinities.
PlanJson json_number(double number) {
  if (std::isfinite(number)) return number;
  return number > 0 ? "inf" : "-inf";
}

double number_in(const PlanJson& json) {
  if (!json.is_string()) return json.get<double>();
  const double infinity = std::numeric_limits<double>::infinity();
  return json.get<std::string>() == "inf" ? infinity : -infinity;
}

PlanJson json_of(const glm::dvec3& v) {
  return {json_number(v.x), json_number(v.y), json_number(v.z)};
}

glm::dvec3 vector_in(const PlanJson& json) {
  return {number_in(json.at(0)), number_in(json.at(1)), number_in(json.at(2))};
}

PlanJson json_of(const geometry::Box& box) {
  return {{"min", json_of(box.min)}, {"max", json_of(box.max)}};
}

geometry::Box box_in(const PlanJson& json) {
  geometry::Box box;
  box.min = vector_in(json.at("min"));
  box.max = vector_in(json.at("max"));
  return box;
}

/// Null where there is no value.
template <typename T>
PlanJson json_of_optional(const std::optional<T>& value) {
  return value ? PlanJson(*value) : PlanJson();
}

template <typename T>
std::optional<T> optional_in(const PlanJson& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<T>());
}

PlanJson json_of(const geometry::Corridor& corridor) {
  PlanJson line = PlanJson::array();
  for (const glm::dvec2& corner : corridor.line) line.push_back({corner.x, corner.y});
  return {{"line", std::move(line)},
          {"half_width", corridor.half_width},
          {"low", json_number(corridor.low)},
          {"high", json_number(corridor.high)}};
}

geometry::Corridor corridor_in(const PlanJson& json) {
  geometry::Corridor corridor;
  for (const PlanJson& corner : json.at("line")) {
    corridor.line.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
  }
  corridor.half_width = json.at("half_width").get<double>();
  corridor.low = number_in(json.at("low"));
  corridor.high = number_in(json.at("high"));
  return corridor;
}

PlanJson json_of(const scan::Selection& selection) {
  PlanJson json{{"boxes", PlanJson::array()}, {"corridors", PlanJson::array()}};
  for (const geometry::Box& box : selection.zone.boxes) json["boxes"].push_back(json_of(box));
  for (const geometry::Corridor& corridor : selection.zone.corridors) json["corridors"].push_back(json_of(corridor));
  json["classes"] = selection.classes;
  json["every"] = selection.every;
  return json;
}

scan::Selection selection_in(const PlanJson& json) {
  scan::Selection selection;
  for (const PlanJson& box : json.at("boxes")) selection.zone.boxes.push_back(box_in(box));
  for (const PlanJson& corridor : json.at("corridors")) selection.zone.corridors.push_back(corridor_in(corridor));
  selection.classes = json.at("classes").get<std::vector<uint8_t>>();
  selection.every = json.at("every").get<uint64_t>();
  return selection;
}

PlanJson json_of(const PlanRequest& request) {
  return {{"program", request.program},
          {"precision", json_of_optional(request.precision)},
          {"z_up", json_of_optional(request.z_up)},
          {"radii", request.radii},
          {"selection", json_of(request.selection)},
          {"assigned_system", request.systems.assigned},
          {"overrides_stated_systems", request.systems.overrides_stated},
          {"target_system", request.systems.target},
          {"parts", json_of_optional(request.parts)},
          {"memory", request.memory}};
}

PlanRequest request_in(const PlanJson& json) {
  PlanRequest request;
  request.program = json.at("program").get<std::string>();
  request.precision = optional_in<double>(json.at("precision"));
  request.z_up = optional_in<bool>(json.at("z_up"));
  request.radii = json.at("radii").get<estimation::RadiusPolicy>();
  request.selection = selection_in(json.at("selection"));
  request.systems.assigned = json.at("assigned_system").get<std::string>();
  request.systems.overrides_stated = json.at("overrides_stated_systems").get<bool>();
  request.systems.target = json.at("target_system").get<std::string>();
  request.parts = optional_in<size_t>(json.at("parts"));
  request.memory = json.at("memory").get<uint64_t>();
  return request;
}

PlanJson json_of(const scan::ScanSchema& schema) {
  PlanJson json{{"name", schema.name}};
  if (schema.grid) json["lattice"] = {{"scale", json_of(schema.grid->scale)}, {"offset", json_of(schema.grid->offset)}};
  json["normals"] = schema.normals;
  json["radii"] = schema.radii;
  json["color_bits"] = schema.color_bits;
  json["attributes"] = PlanJson::array();
  for (const scan::ScalarField& field : schema.scalars) {
    json["attributes"].push_back({{"name", field.name}, {"type", field.type}});
  }
  if (schema.sensor) json["sensor"] = json_of(*schema.sensor);
  json["surface_step"] = json_of_optional(schema.surface_step);
  json["exact_radii"] = schema.exact_radii;
  json["two_sided"] = schema.two_sided;
  json["system"] = schema.crs;
  json["notes"] = schema.notes;
  json["z_up"] = schema.z_up;
  return json;
}

scan::ScanSchema schema_in(const PlanJson& json) {
  scan::ScanSchema schema;
  schema.name = json.at("name").get<std::string>();
  if (json.contains("lattice")) {
    schema.grid = {vector_in(json.at("lattice").at("scale")), vector_in(json.at("lattice").at("offset"))};
  }
  schema.normals = json.at("normals").get<bool>();
  schema.radii = json.at("radii").get<bool>();
  schema.color_bits = json.at("color_bits").get<int>();
  for (const PlanJson& field : json.at("attributes")) {
    schema.scalars.push_back({field.at("name").get<std::string>(), field.at("type").get<scan::ScalarType>()});
  }
  if (json.contains("sensor")) schema.sensor = vector_in(json.at("sensor"));
  schema.surface_step = optional_in<double>(json.at("surface_step"));
  schema.exact_radii = json.at("exact_radii").get<bool>();
  schema.two_sided = json.at("two_sided").get<bool>();
  schema.crs = json.at("system").get<std::string>();
  schema.notes = json.at("notes").get<std::vector<std::string>>();
  schema.z_up = json.at("z_up").get<bool>();
  return schema;
}

PlanJson json_of(const scan::ColumnRoles& roles) {
  PlanJson json{{"position", roles.position},
                {"normal", json_of_optional(roles.normal)},
                {"radius", json_of_optional(roles.radius)},
                {"color", json_of_optional(roles.color)},
                {"packed_color", json_of_optional(roles.packed_color)},
                {"packed_alpha", roles.packed_alpha},
                {"attributes", PlanJson::array()}};
  for (const scan::ColumnRoles::Scalar& scalar : roles.scalars) {
    json["attributes"].push_back({{"column", scalar.column}, {"name", scalar.name}});
  }
  return json;
}

scan::ColumnRoles roles_in(const PlanJson& json) {
  scan::ColumnRoles roles;
  roles.position = json.at("position").get<scan::ColumnTriple>();
  roles.normal = optional_in<scan::ColumnTriple>(json.at("normal"));
  roles.radius = optional_in<size_t>(json.at("radius"));
  roles.color = optional_in<scan::ColumnTriple>(json.at("color"));
  roles.packed_color = optional_in<size_t>(json.at("packed_color"));
  roles.packed_alpha = json.at("packed_alpha").get<bool>();
  for (const PlanJson& scalar : json.at("attributes")) {
    roles.scalars.push_back({scalar.at("column").get<size_t>(), scalar.at("name").get<std::string>()});
  }
  return roles;
}

PlanJson json_of(const PlannedInput& input) {
  const scan::ScanFacts& scan = input.facts.scan;
  return {{"path", input.path.string()},
          {"files", input.identity.files},
          {"bytes", input.identity.bytes},
          {"modified", input.identity.modified},
          {"points", scan.points},
          {"points_of_file", scan.points_of_file},
          {"pieces", input.facts.pieces},
          {"bounds", json_of(scan.bounds)},
          {"bounds_in_model", json_of(input.facts.bounds)},
          {"schema", json_of(scan.meaning.schema)},
          {"columns", json_of(scan.meaning.roles)},
          {"color_factor", scan.meaning.color_factor},
          {"alpha", scan.meaning.alpha}};
}

PlannedInput input_in(const PlanJson& json) {
  PlannedInput input;
  input.path = json.at("path").get<std::string>();
  input.identity = {json.at("files").get<uint64_t>(), json.at("bytes").get<uint64_t>(),
                    json.at("modified").get<int64_t>()};
  scan::ScanFacts& scan = input.facts.scan;
  scan.points = json.at("points").get<uint64_t>();
  scan.points_of_file = json.at("points_of_file").get<uint64_t>();
  input.facts.pieces = json.at("pieces").get<size_t>();
  scan.bounds = box_in(json.at("bounds"));
  input.facts.bounds = box_in(json.at("bounds_in_model"));
  scan.meaning.schema = schema_in(json.at("schema"));
  scan.meaning.roles = roles_in(json.at("columns"));
  scan.meaning.color_factor = json.at("color_factor").get<double>();
  scan.meaning.alpha = json.at("alpha").get<bool>();
  return input;
}

PlanJson json_of(const PlannedPart& planned) {
  PlanJson json{{"points", planned.part.count},
                {"first_code", planned.part.first_code},
                {"end_code", planned.part.end_code},
                {"cells", PlanJson::array()},
                {"pieces", PlanJson::array()}};
  for (const ldc::OctreeKey& key : planned.part.cells) json["cells"].push_back({key.depth, key.x, key.y, key.z});
  for (const PieceRun& run : planned.pieces) json["pieces"].push_back({run.first, run.count});
  return json;
}

PlannedPart part_in(const PlanJson& json) {
  PlannedPart planned;
  planned.part.count = json.at("points").get<uint64_t>();
  planned.part.first_code = json.at("first_code").get<uint64_t>();
  planned.part.end_code = json.at("end_code").get<uint64_t>();
  for (const PlanJson& cell : json.at("cells")) {
    planned.part.cells.push_back({cell.at(0).get<uint8_t>(), cell.at(1).get<uint32_t>(), cell.at(2).get<uint32_t>(),
                                  cell.at(3).get<uint32_t>()});
  }
  for (const PlanJson& run : json.at("pieces")) {
    planned.pieces.push_back({run.at(0).get<uint64_t>(), run.at(1).get<uint64_t>()});
  }
  return planned;
}

PlanJson json_of(const BuildPlan& plan) {
  PlanJson json{{"request", json_of(plan.request)},
                {"points_read", plan.report.points_read},
                {"dropped", {{"not_finite", plan.report.not_finite}, {"zero_normals", plan.report.zero_normals}}},
                {"inputs", PlanJson::array()},
                {"parts", PlanJson::array()}};
  for (const PlannedInput& input : plan.inputs) json["inputs"].push_back(json_of(input));
  for (const PlannedPart& part : plan.parts) json["parts"].push_back(json_of(part));
  return json;
}

BuildPlan plan_in(const PlanJson& json) {
  BuildPlan plan;
  plan.request = request_in(json.at("request"));
  plan.report.points_read = json.at("points_read").get<uint64_t>();
  plan.report.not_finite = json.at("dropped").at("not_finite").get<uint64_t>();
  plan.report.zero_normals = json.at("dropped").at("zero_normals").get<uint64_t>();
  for (const PlanJson& input : json.at("inputs")) plan.inputs.push_back(input_in(input));
  for (const PlanJson& part : json.at("parts")) plan.parts.push_back(part_in(part));
  return plan;
}

/// Whether the runs lie within so many pieces.
bool runs_fit(const std::vector<PlannedPart>& parts, uint64_t pieces) {
  return std::all_of(parts.begin(), parts.end(), [pieces](const PlannedPart& part) {
    return !part.part.cells.empty() && std::all_of(part.pieces.begin(), part.pieces.end(), [&](const PieceRun& run) {
      return run.first <= pieces && run.count <= pieces - run.first;
    });
  });
}

uint64_t piece_count(const std::vector<PlannedInput>& inputs) {
  uint64_t pieces = 0;
  for (const PlannedInput& input : inputs) pieces += input.facts.pieces;
  return pieces;
}

std::string digest_of(const PlanJson& plan) {
  const std::string text = plan.dump();
  return hash_name(std::as_bytes(std::span(text)));
}

tl::unexpected<Error> damaged_plan() {
  return fail(ErrorKind::kInvalidInput, "is damaged");
}

}  // namespace

std::vector<bool> BuildPlan::inputs_of(size_t part) const {
  std::vector<bool> needed(inputs.size());
  const std::vector<size_t> pieces = pieces_of(part);
  uint64_t first = 0;
  for (size_t i = 0; i < inputs.size(); ++i) {
    const uint64_t end = first + inputs[i].facts.pieces;
    const auto found = std::lower_bound(pieces.begin(), pieces.end(), first);
    needed[i] = found != pieces.end() && *found < end;
    first = end;
  }
  return needed;
}

std::vector<size_t> BuildPlan::pieces_of(size_t part) const {
  std::vector<size_t> pieces;
  for (const PieceRun& run : parts[part].pieces) {
    for (uint64_t i = 0; i < run.count; ++i) pieces.push_back(run.first + i);
  }
  return pieces;
}

std::vector<Part> BuildPlan::divided() const {
  std::vector<Part> all;
  for (const PlannedPart& planned : parts) all.push_back(planned.part);
  return all;
}

Result<InputIdentity> identity_of(const std::filesystem::path& path) {
  Result<std::vector<std::filesystem::path>> files = files_of_input(path);
  if (!files) return fail(files);
  InputIdentity identity;
  identity.files = files->size();
  identity.modified = std::numeric_limits<int64_t>::min();  // the clock of file systems may begin in the future
  for (const std::filesystem::path& file : *files) {
    std::error_code code;
    identity.bytes += std::filesystem::file_size(file, code);
    if (code) return fail(ErrorKind::kNotFound, file.string() + ": " + code.message());
    const auto modified = std::filesystem::last_write_time(file, code).time_since_epoch();
    identity.modified =
        std::max(identity.modified, int64_t{std::chrono::duration_cast<std::chrono::nanoseconds>(modified).count()});
  }
  return identity;
}

std::vector<PieceRun> runs_of(const std::vector<size_t>& pieces) {
  std::vector<PieceRun> runs;
  for (const size_t piece : pieces) {
    const bool follows = !runs.empty() && runs.back().first + runs.back().count == piece;
    if (!follows) runs.push_back({piece, 0});
    ++runs.back().count;
  }
  return runs;
}

std::string text_of(const PlanRequest& request) {
  return json_text(json_of(request));
}

Result<std::string> write_plan(BuildPlan& plan) {
  try {  // `dump` throws where `json_text` would replace bytes: a plan must name its inputs exactly
    PlanJson json{{"surfcast_build_plan", kPlanVersion}, {"digest", ""}, {"plan", json_of(plan)}};
    plan.digest = digest_of(json["plan"]);
    json["digest"] = plan.digest;
    return json.dump(1) + "\n";
  } catch (const PlanJson::exception&) {
    return fail(ErrorKind::kUnsupported, "the name of an input is not UTF-8");
  }
}

Result<BuildPlan> read_plan(const std::string& text) {
  const PlanJson json = parse_ordered_json_text(text);
  if (!json.is_object() || !json.contains("surfcast_build_plan")) return damaged_plan();
  if (json["surfcast_build_plan"] != kPlanVersion) {
    return fail(ErrorKind::kUnsupported, "is of another version of the format");
  }
  try {
    if (digest_of(json.at("plan")) != json.at("digest")) return damaged_plan();
    BuildPlan plan = plan_in(json.at("plan"));
    plan.digest = json.at("digest").get<std::string>();
    if (plan.parts.empty() || !runs_fit(plan.parts, piece_count(plan.inputs))) return damaged_plan();
    return plan;
  } catch (const PlanJson::exception&) {
    return damaged_plan();
  }
}

}  // namespace surfcast::builder
