#include "scan/read_scan.h"

#include <span>

#include "base/mapped_file.h"
#include "scan/las_reader.h"
#include "scan/ply_reader.h"
#include "scan/scan_format.h"

namespace surfcast {
namespace {

Result<ScanPoints> read_format(ScanFormat format, std::span<const std::byte> bytes) {
  switch (format) {
    case ScanFormat::kPly:
      return read_ply(bytes);
    case ScanFormat::kLas:
      return read_las(bytes);
  }
  return fail(ErrorKind::kInternal, "scan format without a reader");
}

}  // namespace

Result<ScanPoints> read_scan(const std::filesystem::path& path) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file.error());
  Result<ScanPoints> points = scan_format_of(file->bytes(), path).and_then([&](ScanFormat format) {
    return read_format(format, file->bytes());
  });
  if (!points) return fail(points.error().kind, path.string() + ": " + points.error().message);
  points->name = path.filename().string();
  return points;
}

}  // namespace surfcast
