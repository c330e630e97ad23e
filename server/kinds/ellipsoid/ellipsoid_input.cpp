#include "ellipsoid/ellipsoid_input.h"

#include <utility>

#include "ellipsoid/input_formats.h"
#include "grid/grid_format.h"
#include "grid/grid_reader.h"
#include "grid/vtk_points.h"
#include "stream/mapped_stream.h"

namespace surfcast::ellipsoid {
namespace {

bool is_tensor_grid(const std::filesystem::path& path, const InputOptions& options) {
  const Result<grid::GridReader> reader = grid::GridReader::open(path, {}, options.order);
  return reader && reader->header().components() > 1;
}

}  // namespace

bool holds_ellipsoids(const std::filesystem::path& path, const InputOptions& options) {
  std::error_code ignored;  // if a file does not exist, reading it reports the error
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  const Result<stream::FilePtr> file = stream::open_shared(path);
  if (!file || (*file)->bytes().empty()) return false;
  if (grid::is_vtk_point_set(*file)) return holds_vtk_tensors(*file);
  if (grid::grid_format_of(*file)) return is_tensor_grid(path, options);
  return is_ellipsoid_table(*file, options.asked);
}

bool is_vtk_point_set(const std::filesystem::path& path) {
  const Result<stream::FilePtr> file = stream::open_shared(path);
  return file && is_vtk_point_set(*file);
}

Result<InputPtr> open_ellipsoids(const std::filesystem::path& path, const InputOptions& options) {
  const Result<stream::FilePtr> file = stream::open_shared(path);
  if (!file) return fail(file);
  if ((*file)->bytes().empty()) return fail(ErrorKind::kInvalidInput, path.string() + ": the file is empty");
  if (is_vtk_point_set(*file)) return open_vtk_tensors(*file, path, options);
  if (!grid::grid_format_of(*file)) return open_table(*file, path, options);
  Result<grid::GridReader> reader = grid::GridReader::open(path, {}, options.order);
  if (!reader) return fail(reader);
  if (reader->header().components() > 1) return open_grid_tensors(std::move(*reader), path, options);
  return fail(ErrorKind::kUnsupported, path.string() + ": has one number a sample and no tensors");
}

}  // namespace surfcast::ellipsoid
