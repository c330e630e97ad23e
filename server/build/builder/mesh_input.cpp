#include "builder/mesh_input.h"

#include <algorithm>
#include <utility>

#include "base/spool_file.h"
#include "builder/spooled_rows.h"
#include "mesh/mesh_reader.h"

namespace surfcast::builder {
namespace {

using scan::ScalarType;

template <typename T>
void put(const T& value, std::vector<std::byte>& bytes) {
  const auto* first = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof(T));
}

/// Opacity is stored where a material may be transparent.
bool blends(const mesh::Mesh& mesh) {
  return std::any_of(mesh.materials.begin(), mesh.materials.end(),
                     [](const mesh::Material& material) { return material.alpha == mesh::AlphaMode::kBlend; });
}

/// What is stored of surfels beside places, normals and radii.
struct Columns {
  bool color = false;
  bool alpha = false;
};

/// How surfels wait, in the order of columns_of().
void put_surfel(const mesh::MeshSurfel& surfel, const Columns& columns, std::vector<std::byte>& bytes) {
  put(surfel.position, bytes);
  put(surfel.normal, bytes);
  put(surfel.radius, bytes);
  if (columns.color) put(surfel.color, bytes);
  if (columns.alpha) put(surfel.alpha, bytes);
}

std::vector<scan::ColumnInfo> columns_of(const Columns& stored) {
  std::vector<scan::ColumnInfo> columns;
  for (const char* name : {"x", "y", "z"}) columns.push_back({name, ScalarType::kFloat64, false});
  for (const char* name : {"nx", "ny", "nz", "radius"}) columns.push_back({name, ScalarType::kFloat32, false});
  for (const char* name : {"red", "green", "blue"}) {
    if (stored.color) columns.push_back({name, ScalarType::kUint8, false});
  }
  if (stored.alpha) columns.push_back({"alpha", ScalarType::kUint8, false});
  return columns;
}

scan::RowTraits traits_of(const mesh::Mesh& mesh, const mesh::MeshReport& report) {
  scan::RowTraits traits;
  traits.may_be_graphics = !mesh.z_up;
  traits.surface_step = report.widest;
  traits.exact_radii = true;
  traits.two_sided = report.two_sided;
  return traits;
}

/// Half of the memory is for the mesh, half for a texture.
scan::DecodingLimit half_of(const scan::DecodingLimit& limit) {
  return {limit.max_bytes / 2};
}

}  // namespace

bool is_mesh(const std::filesystem::path& path, mesh::FacePolicy faces) {
  return mesh::mesh_format_of(path, faces).has_value();
}

Result<scan::ScanStream> open_mesh(const std::filesystem::path& path, const MeshOptions& options,
                                   const scan::DecodingLimit& limit, std::optional<uint64_t> sample,
                                   const std::filesystem::path& target, std::vector<InputMesh>& found) {
  const std::optional<mesh::MeshFormat> format = mesh::mesh_format_of(path, options.faces);
  if (!format) return fail(ErrorKind::kInvalidInput, path.string() + ": is no mesh");
  const Result<mesh::Mesh> mesh = mesh::read_mesh(path, *format, half_of(limit));
  if (!mesh) return fail(mesh);
  Result<SpoolFile> file = SpoolFile::create(target);
  if (!file) return fail(file);
  const mesh::SampleOptions sampling{options.spacing, std::min(options.most_surfels, sample.value_or(UINT64_MAX))};
  const Columns columns{mesh->colored(), blends(*mesh)};
  std::vector<std::byte> bytes;
  Result<mesh::MeshReport> report =
      mesh::sample_mesh(*mesh, sampling, half_of(limit), [&](std::span<const mesh::MeshSurfel> surfels) {
        bytes.clear();
        for (const mesh::MeshSurfel& surfel : surfels) put_surfel(surfel, columns, bytes);
        return file->append(bytes).map([](uint64_t) {});
      });
  if (!report) return fail_about(path.string(), report);
  if (report->surfels == 0) {
    return fail(ErrorKind::kInvalidInput, path.string() + ": none of its triangles has an area that can be seen");
  }
  found.push_back({path.filename().string(), *report});
  return scan::ScanStream::of_rows(spooled_rows(std::move(*file), columns_of(columns), traits_of(*mesh, *report)), path,
                                   {});
}

}  // namespace surfcast::builder
