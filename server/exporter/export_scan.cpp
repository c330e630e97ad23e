#include "exporter/export_scan.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <memory>
#include <utility>

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include "base/mapped_file.h"
#include "exporter/csv_writer.h"
#include "exporter/las_copy.h"
#include "exporter/las_table.h"
#include "exporter/ply_writer.h"
#include "exporter/table_format.h"
#include "scan/las_records.h"
#include "scan/scan_folder.h"
#include "scan/scan_format.h"
#include "scan/scan_stream.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;

/// Calls `use` with all pieces in order, which are read by all threads, as many at a time as there are threads.
template <typename T>
Status for_each_piece(size_t pieces, const std::function<Result<T>(size_t)>& read,
                      const std::function<Status(T)>& use) {
  const auto at_once = static_cast<size_t>(oneapi::tbb::info::default_concurrency());
  for (size_t first = 0; first < pieces; first += at_once) {
    std::vector<Result<T>> batch(std::min(at_once, pieces - first));
    oneapi::tbb::parallel_for(size_t{0}, batch.size(), [&](size_t i) { batch[i] = read(first + i); });
    for (Result<T>& piece : batch) {
      if (!piece) return fail(std::move(piece.error()));
      if (Status status = use(std::move(*piece)); !status) return status;
    }
  }
  return {};
}

std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_las(const std::string& extension) {
  return extension == ".las" || extension == ".laz";
}

/// Whether the source is a single file of point records.
Result<bool> holds_records(const fs::path& source) {
  if (scan::scan_folder_of(source)) return false;
  const Result<MappedFile> file = MappedFile::open(source);
  if (!file) return fail(file.error());
  const Result<scan::ScanFormat> format = scan::scan_format_of(file->bytes(), source);
  if (!format) return fail(format.error().kind, source.string() + ": " + format.error().message);
  return *format == scan::ScanFormat::kLas;
}

Result<ExportReport> copy_records(const fs::path& source, const fs::path& target, const ExportOptions& options) {
  const Result<scan::LasRecords> records = scan::LasRecords::open(source, options.selection);
  if (!records) return fail(records.error());
  LasCopy copy = plan_las_copy(records->header(), records->file(), extension_of(target) == ".laz");
  copy.head.chunk_size = options.chunk_size;
  Result<LasFileWriter> writer = LasFileWriter::create(target, copy.head);
  if (!writer) return fail(std::move(writer.error()));
  using Bytes = std::vector<std::byte>;
  const Status copied = for_each_piece<Bytes>(
      records->pieces(), [&](size_t piece) { return records->read(piece); },
      [&](Bytes piece) { return writer->append(without_packets(std::move(piece), records->header(), copy)); });
  if (!copied) return fail(copied.error());
  if (writer->points() == 0)
    return fail(ErrorKind::kInvalidInput, source.string() + ": has no points in the selection");
  return writer->finish().map([&](uint64_t bytes) { return ExportReport{writer->points(), bytes, copy.notes}; });
}

class LasTableWriter : public PointWriter {
 public:
  LasTableWriter(LasFileWriter file, LasTable table) : file_(std::move(file)), table_(std::move(table)) {}

  Status append(const scan::ScanPoints& points) override {
    return las_records_of(points, table_).and_then([this](const std::vector<std::byte>& records) {
      return file_.append(records);
    });
  }
  [[nodiscard]] uint64_t written() const override { return file_.points(); }
  Result<uint64_t> finish() override { return file_.finish(); }

 private:
  LasFileWriter file_;
  LasTable table_;
};

Result<std::unique_ptr<PointWriter>> create_las(const fs::path& target, const scan::ScanStream& scan,
                                                const ExportOptions& options, std::vector<std::string>& notes) {
  LasPoints points{&scan.schema(), scan.bounds(), scan.size(), options.scale, extension_of(target) == ".laz"};
  Result<LasTable> table = plan_las_table(points);
  if (!table) return fail(std::move(table.error()));
  if (!scan.schema().grid || *scan.schema().grid != table->grid)
    notes.push_back("coordinates are rounded to multiples of " + shortest(table->grid.scale.x));
  table->head.chunk_size = options.chunk_size;
  Result<LasFileWriter> file = LasFileWriter::create(target, table->head);
  if (!file) return fail(std::move(file.error()));
  return std::make_unique<LasTableWriter>(std::move(*file), std::move(*table));
}

Result<std::unique_ptr<PointWriter>> create_writer(const fs::path& target, const scan::ScanStream& scan,
                                                   const ExportOptions& options, std::vector<std::string>& notes) {
  const std::string extension = extension_of(target);
  if (extension == ".ply") return create_ply(target, scan.schema(), scan.size());
  if (extension == ".csv") return create_csv(target, scan.schema());
  return create_las(target, scan, options, notes);
}

Result<ExportReport> convert_points(const fs::path& source, const fs::path& target, const ExportOptions& options) {
  const Result<scan::ScanStream> scan = scan::ScanStream::open(source, options.limit, {}, options.selection);
  if (!scan) return fail(scan.error());
  ExportReport report;
  report.notes = scan->schema().notes;
  const Result<std::unique_ptr<PointWriter>> writer = create_writer(target, *scan, options, report.notes);
  if (!writer) return fail(writer.error());
  const Status written = for_each_piece<scan::ScanPoints>(
      scan->pieces(), [&](size_t piece) { return scan->read(piece); },
      [&](const scan::ScanPoints& points) { return (*writer)->append(points); });
  if (!written) return fail(written.error());
  report.points = (*writer)->written();
  if (report.points < scan->size())
    report.notes.push_back(std::to_string(scan->size() - report.points) + " points without coordinates are left out");
  return (*writer)->finish().map([&](uint64_t bytes) {
    report.bytes = bytes;
    return report;
  });
}

}  // namespace

Result<ExportReport> export_scan(const fs::path& source, const fs::path& target, const ExportOptions& options) {
  const std::string extension = extension_of(target);
  if (std::find(std::begin(kExtensions), std::end(kExtensions), extension) == std::end(kExtensions)) {
    return fail(ErrorKind::kUnsupported,
                target.string() + ": the name must end in .las, .laz, .ply or .csv, which are the formats written");
  }
  const Result<bool> records = holds_records(source);
  if (!records) return fail(records.error());
  if (*records && is_las(extension) && !options.scale) return copy_records(source, target, options);
  return convert_points(source, target, options);
}

}  // namespace surfcast::exporter
