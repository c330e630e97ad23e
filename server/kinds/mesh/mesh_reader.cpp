#include "mesh/mesh_reader.h"

#include <memory>
#include <system_error>
#include <utility>

#include "base/mapped_file.h"
#include "mesh/readers.h"

namespace surfcast::mesh {
namespace {

Result<ModelFile> open_file(const std::filesystem::path& path) {
  Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  return ModelFile{path, std::make_shared<const MappedFile>(std::move(*file))};
}

Result<Mesh> read(const ModelFile& file, MeshFormat format, const scan::DecodingLimit& limit) {
  switch (format) {
    case MeshFormat::kObj:
      return read_obj(file, limit);
    case MeshFormat::kPly:
      return read_ply_mesh(file, limit);
    case MeshFormat::kStl:
      return read_stl(file, limit);
    case MeshFormat::kGltf:
    case MeshFormat::kGlb:
      break;
  }
  return read_gltf(file, limit);
}

/// Files beside images that the model names.
std::vector<std::filesystem::path> named_parts(const ModelFile& file, MeshFormat format) {
  if (format == MeshFormat::kObj) return files_of_obj(file);
  if (format == MeshFormat::kGltf || format == MeshFormat::kGlb) return files_of_gltf(file);
  return {};
}

}  // namespace

std::optional<MeshFormat> mesh_format_of(const std::filesystem::path& path, FacePolicy faces) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  const Result<MappedFile> file = MappedFile::open(path);
  return file ? mesh_format_of(file->bytes(), path, faces) : std::nullopt;
}

Result<Mesh> read_mesh(const std::filesystem::path& path, MeshFormat format, const scan::DecodingLimit& limit) try {
  const Result<ModelFile> file = open_file(path);
  if (!file) return fail(file);
  Result<Mesh> mesh = read(*file, format, limit);
  if (!mesh) return fail_about(path.string(), mesh);
  if (mesh->triangles() == 0) return fail(ErrorKind::kInvalidInput, path.string() + ": has no triangles");
  mesh->contents.push_back(file->content);
  return mesh;
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::kLimit, path.string() + ": states more than there is memory for");
}

Result<std::vector<std::filesystem::path>> files_of_mesh(const std::filesystem::path& path, MeshFormat format) {
  const Result<ModelFile> file = open_file(path);
  if (!file) return fail(file);
  std::vector<std::filesystem::path> files{path};
  for (std::filesystem::path& named : named_parts(*file, format)) files.push_back(std::move(named));
  const Result<Mesh> mesh = read(*file, format, {});
  if (!mesh) return fail_about(path.string(), mesh);
  for (const ImageSource& image : mesh->images) {
    if (!image.file.empty()) files.push_back(image.file);
  }
  std::error_code ignored;
  std::erase_if(files, [&](const auto& f) { return f != path && !std::filesystem::is_regular_file(f, ignored); });
  return files;
}

}  // namespace surfcast::mesh
