#include "cmd/input_summary.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "base/json_text.h"
#include "builder/grid_input.h"
#include "builder/input_files.h"
#include "ellipsoid/ellipsoid_input.h"
#include "gaussian/gaussian_reader.h"
#include "grid/open_scan.h"
#include "mesh/mesh_reader.h"
#include "model/volume_facts.h"

namespace surfcast::cmd {
namespace {

using Facts = nlohmann::ordered_json;

Facts numbers(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

Result<Facts> facts_of_scan(const std::filesystem::path& path) {
  const Result<scan::ScanStream> scan = grid::open_scan(path);
  if (!scan) return fail(scan);
  const scan::ScanSchema& schema = scan->schema();
  Facts facts{{"kind", "scan"}, {"points", scan->size()}};
  if (!scan->bounds().empty()) {
    facts["bounds_min"] = numbers(scan->bounds().min);
    facts["bounds_max"] = numbers(scan->bounds().max);
  }
  facts["up"] = schema.z_up ? "z" : "y";
  facts["color_bits"] = schema.color_bits;
  facts["normals"] = schema.normals;
  facts["radii"] = schema.radii;
  facts["attributes"] = Facts::array();
  for (const scan::ScalarField& field : schema.scalars) {
    facts["attributes"].push_back(field.name + " " + model::type_name(static_cast<uint8_t>(field.type)));
  }
  if (schema.sensor) facts["sensor"] = numbers(*schema.sensor);
  if (!schema.crs.empty()) facts["coordinate_system"] = schema.crs;
  if (!schema.notes.empty()) facts["notes"] = schema.notes;
  return facts;
}

Result<Facts> facts_of_grid(const std::filesystem::path& path) {
  const Result<builder::GridInput> grid = builder::GridInput::open(path);
  if (!grid) return fail(grid);
  const model::Volume& volume = grid->volume();
  Facts facts{{"kind", "volume"},
              {"format", grid->header().format},
              {"size", {volume.size.x, volume.size.y, volume.size.z}},
              {"type", model::type_name(volume)},
              {"spacing", numbers(spacing_of(volume))}};
  if (!volume.length_unit.empty()) facts["length_unit"] = volume.length_unit;
  if (!volume.sample_unit.empty()) facts["sample_unit"] = volume.sample_unit;
  if (volume.frame != model::WorldFrame::kUnstated) facts["axes"] = frame_name(volume);
  return facts;
}

Result<Facts> facts_of_gaussians(const std::filesystem::path& path) {
  const Result<gaussian::GaussianReader> reader = gaussian::GaussianReader::open(path);
  if (!reader) return fail(reader);
  return Facts{{"kind", "gaussians"}, {"gaussians", reader->traits().count}, {"degree", reader->traits().degree}};
}

Result<Facts> facts_of_ellipsoids(const std::filesystem::path& path) {
  const Result<ellipsoid::InputPtr> input = ellipsoid::open_ellipsoids(path);
  if (!input) return fail(input);
  Facts facts{{"kind", (*input)->facts().tensors ? "tensors" : "ellipsoids"}, {"samples", (*input)->samples()}};
  facts["attributes"] = Facts::array();
  for (const auto& attribute : (*input)->facts().attributes) facts["attributes"].push_back(attribute.name);
  return facts;
}

Result<Facts> facts_of_mesh(const std::filesystem::path& path) {
  const Result<mesh::Mesh> mesh = mesh::read_mesh(path, *mesh::mesh_format_of(path), {});
  if (!mesh) return fail(mesh);
  return Facts{{"kind", "mesh"},
               {"triangles", mesh->triangles()},
               {"materials", mesh->materials.size()},
               {"bounds_min", numbers(mesh->bounds().min)},
               {"bounds_max", numbers(mesh->bounds().max)}};
}

Result<Facts> facts_of(const std::filesystem::path& path) {
  switch (builder::kind_of_input(path)) {
    case builder::InputKind::kGrid:
      return facts_of_grid(path);
    case builder::InputKind::kGaussians:
      return facts_of_gaussians(path);
    case builder::InputKind::kEllipsoids:
      return facts_of_ellipsoids(path);
    case builder::InputKind::kMesh:
      return facts_of_mesh(path);
    case builder::InputKind::kScan:
      break;
  }
  return facts_of_scan(path);
}

std::string text_of(const Facts& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (!value.is_array()) return json_text(value);
  std::string text;
  for (const Facts& part : value) {
    text += (text.empty() ? "" : (part.is_string() ? ", " : " ")) + text_of(part);
  }
  return text.empty() ? "none" : text;
}

}  // namespace

Result<std::string> summarize_input(const std::filesystem::path& path, bool json) {
  const Result<Facts> facts = facts_of(path);
  if (!facts) return fail(facts);
  Facts all{{"input", path.string()}, {"bytes", builder::bytes_of_input(path)}};
  all.update(*facts);
  if (json) return json_text(all, 2) + "\n";
  std::string lines;
  for (const auto& [name, value] : all.items()) lines += name + ": " + text_of(value) + "\n";
  return lines;
}

}  // namespace surfcast::cmd
