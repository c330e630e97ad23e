#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/mapped_file.h"
#include "base/result.h"
#include "mesh/mesh.h"
#include "scan/row_source.h"

namespace surfcast::mesh {

/// A file that is read as a mesh.
struct ModelFile {
  std::filesystem::path path;
  std::shared_ptr<const MappedFile> content;

  [[nodiscard]] std::span<const std::byte> bytes() const { return content->bytes(); }
};

/// Every reader fails without the file's name. Sizes, indices and numbers are checked; what is damaged in part is an
/// error, except for materials and images, which are notes.
Result<Mesh> read_obj(const ModelFile& file, const scan::DecodingLimit& limit);
Result<Mesh> read_stl(const ModelFile& file, const scan::DecodingLimit& limit);
Result<Mesh> read_ply_mesh(const ModelFile& file, const scan::DecodingLimit& limit);
/// glTF 2.0, as text or binary.
Result<Mesh> read_gltf(const ModelFile& file, const scan::DecodingLimit& limit);

/// Files beside images that a model names: materials of OBJ, buffers of glTF.
std::vector<std::filesystem::path> files_of_obj(const ModelFile& file);
std::vector<std::filesystem::path> files_of_gltf(const ModelFile& file);

}  // namespace surfcast::mesh
