#include "builder/input_files.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "base/ascii_text.h"
#include "builder/build_kinds.h"
#include "builder/grid_input.h"
#include "builder/mesh_input.h"
#include "ellipsoid/ellipsoid_input.h"
#include "gaussian/gaussian_format.h"
#include "gaussian/gaussian_reader.h"
#include "gaussian/sog_meta.h"
#include "grid/grid_reader.h"
#include "grid/open_scan.h"
#include "mesh/mesh_reader.h"
#include "scan/scan_folder.h"
#include "scan/scan_format.h"
#include "scan/scan_stream.h"
#include "scan/text_tokens.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

/// The file that begins a model of Gaussians: of a folder, its description.
fs::path first_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? path / "meta.json" : path;
}

Result<gaussian::SogMeta> read_description(const fs::path& path) {
  const Result<stream::FilePtr> file = stream::open_shared(path);
  if (!file) return fail(file);
  return gaussian::parse_sog_meta(scan::as_text((*file)->bytes())).map_error([&](const Error& error) {
    return Error{error.kind, path.string() + ": " + error.message};
  });
}

bool is_description(const fs::path& path) {
  const Result<stream::FilePtr> file = stream::open_shared(path);
  return file && gaussian::gaussian_format_of(*file, path) == gaussian::GaussianFormat::kSogMeta;
}

/// Of SOG the description alone: its pictures would be decoded.
Status check_gaussians(const fs::path& path) {
  const fs::path first = first_file(path);
  if (is_description(first)) return read_description(first).map([](const gaussian::SogMeta&) {});
  return gaussian::GaussianReader::open(first).map([](const gaussian::GaussianReader&) {});
}

/// Of a table its header alone: its rows would be read.
Status check_ellipsoids(const fs::path& path) {
  if (!is_grid(path) && !ellipsoid::is_vtk_point_set(path)) return scan::check_header(path);
  return ellipsoid::open_ellipsoids(path).map([](const ellipsoid::InputPtr&) {});
}

Result<Files> files_of_gaussians(const fs::path& path) {
  Files files{first_file(path)};
  if (!is_description(files.front())) return files;
  const Result<gaussian::SogMeta> meta = read_description(files.front());
  if (!meta) return fail(meta);
  const fs::path folder = files.front().parent_path();
  for (const std::string& name : gaussian::picture_names(*meta)) files.push_back(folder / name);
  return files;
}

Result<Files> files_of_grid(const fs::path& path) {
  const Result<grid::GridReader> reader = grid::GridReader::open(path);
  if (!reader) return fail(reader);
  Files files{path};
  for (fs::path& file : reader->data_files()) files.push_back(std::move(file));
  return files;
}

}  // namespace

InputKind kind_of_input(const fs::path& path) {
  if (scan::scan_folder_of(path)) return InputKind::kScan;
  if (holds_gaussians(path)) return InputKind::kGaussians;
  if (ellipsoid::holds_ellipsoids(path)) return InputKind::kEllipsoids;
  if (is_grid(path)) return InputKind::kGrid;
  return is_mesh(path) ? InputKind::kMesh : InputKind::kScan;
}

Files inputs_in(const fs::path& folder) {
  const std::vector<std::string> extensions = input_extensions();
  const auto may_be_input = [&](const std::string& name) {
    return std::ranges::any_of(extensions,
                               [lower = to_lower(name)](const auto& extension) { return lower.ends_with(extension); });
  };
  Files files;
  std::error_code code;
  for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code)) {
    std::error_code ignored;
    if (at->is_regular_file(ignored) && may_be_input(at->path().filename().string())) files.push_back(at->path());
  }
  std::ranges::sort(files);
  return files;
}

Result<Files> inputs_at(const fs::path& path) {
  std::error_code ignored;
  const bool by_itself = scan::scan_folder_of(path) || fs::exists(path / "meta.json", ignored);
  if (by_itself || !fs::is_directory(path, ignored)) return Files{path};
  Files files = inputs_in(path);
  if (!files.empty()) return files;
  return fail(ErrorKind::kInvalidInput, path.string() + ": a folder without a file that a model is built of");
}

Status check_input(const fs::path& path) {
  switch (kind_of_input(path)) {
    case InputKind::kGrid:
      return GridInput::open(path).map([](const GridInput&) {});
    case InputKind::kGaussians:
      return check_gaussians(path);
    case InputKind::kEllipsoids:
      return check_ellipsoids(path);
    case InputKind::kMesh:
      return {};  // its sizes are checked when it is read
    case InputKind::kScan:
      break;
  }
  return grid::check_scan(path);
}

Result<Files> files_of_input(const fs::path& path) {
  switch (kind_of_input(path)) {
    case InputKind::kGrid:
      return files_of_grid(path);
    case InputKind::kGaussians:
      return files_of_gaussians(path);
    case InputKind::kEllipsoids:
      return is_grid(path) ? files_of_grid(path) : Files{path};
    case InputKind::kMesh:
      return mesh::files_of_mesh(path, *mesh::mesh_format_of(path));
    case InputKind::kScan:
      break;
  }
  return scan::files_of_scan(path);
}

uint64_t bytes_of_input(const fs::path& path) {
  const Result<Files> files = files_of_input(path);
  if (!files) return 0;
  uint64_t bytes = 0;
  for (const fs::path& file : *files) {
    std::error_code code;
    const uint64_t size = fs::file_size(file, code);
    if (!code) bytes += size;
  }
  return bytes;
}

std::vector<std::string> input_extensions() {
  std::vector<std::string> all = scan::scan_extensions();
  for (const char* points : {".vtp", ".vtu", ".vts"}) all.emplace_back(points);
  for (const char* grid :
       {".nrrd", ".nhdr", ".mha", ".mhd", ".vtk", ".vti", ".nii", ".nii.gz", ".hdr", ".mif", ".mif.gz", ".mih"}) {
    all.emplace_back(grid);
  }
  for (const char* gaussians : {".splat", ".spz", ".sog", ".zip"}) all.emplace_back(gaussians);
  for (const char* mesh : {".obj", ".gltf", ".glb", ".stl"}) all.emplace_back(mesh);
  return all;
}

std::vector<std::string> data_extensions() {
  return {".raw", ".raw.gz", ".raw.bz2", ".zraw", ".img",  ".img.gz", ".dat",  ".mtl", ".bin",
          ".prj", ".png",    ".jpg",     ".jpeg", ".webp", ".tif",    ".tiff", ".bmp", ".tga"};
}

}  // namespace surfcast::builder
