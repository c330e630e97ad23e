#include "grid/open_scan.h"

#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "grid/vtk_points.h"

namespace surfcast::grid {
namespace {

/// The file if it has points of VTK, else null.
stream::FilePtr vtk_points_at(const std::filesystem::path& path) {
  std::error_code ignored;  // what cannot be opened is reported where it is read
  if (!std::filesystem::is_regular_file(path, ignored)) return nullptr;
  Result<stream::FilePtr> file = stream::open_shared(path);
  return file && is_vtk_point_set(*file) ? std::move(*file) : nullptr;
}

tl::unexpected<Error> in_file(const Error& error, const std::filesystem::path& path) {
  return fail(error.kind, path.string() + ": " + error.message);
}

}  // namespace

bool holds_vtk_points(const std::filesystem::path& path) {
  return vtk_points_at(path) != nullptr;
}

Result<scan::ScanStream> open_scan(const std::filesystem::path& path, const scan::DecodingLimit& limit,
                                   std::optional<uint64_t> sample, const scan::Selection& selection) {
  const stream::FilePtr file = vtk_points_at(path);
  if (file == nullptr) return scan::ScanStream::open(path, limit, sample, selection);
  Result<std::unique_ptr<scan::RowSource>> rows = vtk_point_rows(file, limit);
  if (!rows) return in_file(rows.error(), path);
  return scan::ScanStream::of_rows(std::move(*rows), path, sample, selection);
}

Result<scan::ScanStream> reopen_scan(const std::filesystem::path& path, const scan::DecodingLimit& limit,
                                     const scan::Selection& selection, const scan::ScanFacts& facts) {
  const stream::FilePtr file = vtk_points_at(path);
  if (file == nullptr) return scan::ScanStream::reopen(path, limit, selection, facts);
  Result<std::unique_ptr<scan::RowSource>> rows = vtk_point_rows(file, limit);
  if (!rows) return in_file(rows.error(), path);
  return scan::ScanStream::reopen_rows(std::move(*rows), path, selection, facts);
}

Status check_scan(const std::filesystem::path& path) {
  const stream::FilePtr file = vtk_points_at(path);
  if (file == nullptr) return scan::check_header(path);
  if (Status status = check_vtk_points(file); !status) return in_file(status.error(), path);
  return {};
}

}  // namespace surfcast::grid
