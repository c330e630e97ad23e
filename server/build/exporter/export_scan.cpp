#include "exporter/export_scan.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include "base/ascii_text.h"
#include "base/atomic_file.h"
#include "base/mapped_file.h"
#include "exporter/las14.h"
#include "exporter/las_copy.h"
#include "exporter/las_table.h"
#include "exporter/model_points.h"
#include "exporter/octree_file_writer.h"
#include "exporter/point_encoder.h"
#include "exporter/point_writer.h"
#include "exporter/table_format.h"
#include "grid/open_scan.h"
#include "scan/las_records.h"
#include "scan/scan_folder.h"
#include "scan/scan_format.h"
#include "scan/scan_stream.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

/// Calls `use` with all pieces in order, which are read by all threads, as many at a time as there are threads.
template <typename T>
Status for_each_piece(size_t pieces, const std::function<Result<T>(size_t)>& read,
                      const std::function<Status(T)>& use) {
  const auto at_once = static_cast<size_t>(oneapi::tbb::info::default_concurrency());
  for (size_t first = 0; first < pieces; first += at_once) {
    std::vector<Result<T>> batch(std::min(at_once, pieces - first));
    oneapi::tbb::parallel_for(size_t{0}, batch.size(), [&](size_t i) { batch[i] = read(first + i); });
    for (Result<T>& piece : batch) {
      if (!piece) return fail(piece);
      if (Status status = use(std::move(*piece)); !status) return status;
    }
  }
  return {};
}

/// What is written.
struct TargetForm {
  PointFormat format = PointFormat::kLaz;
  std::optional<OctreeForm> octree;  ///< none: points in their order
};

/// The form of a file, by its name.
Result<TargetForm> form_of(const fs::path& target) {
  const std::string extension = lower_extension(target);
  if (target.filename() == "ept.json") return TargetForm{PointFormat::kLaz, OctreeForm::kEpt};
  if (target.filename() == "metadata.json") return TargetForm{PointFormat::kLaz, OctreeForm::kPotree2};
  if (extension == ".laz" && lower_extension(target.stem()) == ".copc")
    return TargetForm{PointFormat::kLaz, OctreeForm::kCopc};
  if (!extension.empty()) {
    if (const auto format = point_format_of(std::string_view(extension).substr(1))) return TargetForm{*format, {}};
  }
  std::string names;
  for (const auto& [name, format] : kPointFormats) names += (names.empty() ? "." : ", .") + std::string(name);
  return fail(ErrorKind::kUnsupported, target.string() +
                                           ": its extension names none of the formats that are written: " + names +
                                           ", .copc.laz, ept.json, metadata.json");
}

bool is_las(PointFormat format) {
  return format == PointFormat::kLas || format == PointFormat::kLaz;
}

/// Whether the source is a single file of point records.
Result<bool> holds_records(const fs::path& source) {
  if (scan::scan_folder_of(source)) return false;
  const Result<MappedFile> file = MappedFile::open(source);
  if (!file) return fail(file);
  // What is of no format here may be one of grid::open_scan, which reports all others.
  const Result<scan::ScanFormat> format = scan::scan_format_of(file->bytes(), source);
  return format && *format == scan::ScanFormat::kLas;
}

Result<std::unique_ptr<RecordWriter>> create_records(const fs::path& target, LasHead head, const TargetForm& form,
                                                     const ExportOptions& options) {
  head.chunk_size = options.encoding.chunk_size.value_or(head.chunk_size);
  if (form.octree) {
    OctreeOptions octree = options.octree;
    octree.leaf_points = options.encoding.chunk_size.value_or(octree.leaf_points);
    return create_octree_file(target, std::move(head), *form.octree, octree);
  }
  Result<LasFileWriter> file = LasFileWriter::create(target, std::move(head));
  if (!file) return fail(file);
  return std::make_unique<LasFileWriter>(std::move(*file));
}

Result<ExportReport> copy_records(const fs::path& source, const fs::path& target, const TargetForm& form,
                                  const ExportOptions& options) {
  const Result<scan::LasRecords> records = scan::LasRecords::open(source, options.selection);
  if (!records) return fail(records);
  LasCopy copy = plan_las_copy(records->header(), records->file(), form.format == PointFormat::kLaz);
  const int point_format = copy.head.point_format;
  const size_t record_bytes = copy.head.record_length;
  if (form.octree) {
    for (std::string& note : become_version_14(copy.head, records->header().crs)) copy.notes.push_back(std::move(note));
  }
  const Result<std::unique_ptr<RecordWriter>> writer = create_records(target, copy.head, form, options);
  if (!writer) return fail(writer);
  const auto as_written = [&](Bytes piece) {
    piece = without_packets(std::move(piece), records->header(), copy);
    return form.octree ? modern_records(std::move(piece), point_format, record_bytes) : piece;
  };
  const Status copied = for_each_piece<Bytes>(
      records->pieces(), [&](size_t piece) { return records->read(piece).map(as_written); },
      [&](const Bytes& piece) { return (*writer)->append(piece); });
  if (!copied) return fail(copied);
  if ((*writer)->points() == 0)
    return fail(ErrorKind::kInvalidInput, source.string() + ": has no points in the selection");
  return (*writer)->finish().map([&](uint64_t bytes) { return ExportReport{(*writer)->points(), bytes, copy.notes}; });
}

/// A file of encoded points.
class EncodedFile : public PointWriter {
 public:
  static Result<std::unique_ptr<PointWriter>> create(const fs::path& target, std::unique_ptr<PointEncoder> encoder) {
    Result<AtomicFile> file = AtomicFile::create(target);
    if (!file) return fail(file);
    if (Status status = file->append(encoder->head()); !status) return fail(status);
    return std::make_unique<EncodedFile>(std::move(*file), std::move(encoder));
  }
  EncodedFile(AtomicFile file, std::unique_ptr<PointEncoder> encoder)
      : file_(std::move(file)), encoder_(std::move(encoder)) {}

  Status append(const scan::ScanPoints& points) override {
    written_ += points.size();
    return encoder_->rows(points).and_then([this](const std::vector<std::byte>& bytes) { return file_.append(bytes); });
  }
  [[nodiscard]] uint64_t written() const override { return written_; }
  Result<uint64_t> finish() override {
    Status status = file_.append(encoder_->tail());
    const uint64_t bytes = file_.position();
    if (status) status = file_.commit();
    if (!status) return fail(status);
    return bytes;
  }

 private:
  AtomicFile file_;
  std::unique_ptr<PointEncoder> encoder_;
  uint64_t written_ = 0;
};

class LasTableWriter : public PointWriter {
 public:
  LasTableWriter(std::unique_ptr<RecordWriter> file, LasTable table)
      : file_(std::move(file)), table_(std::move(table)) {}

  Status append(const scan::ScanPoints& points) override {
    return las_records_of(points, table_).and_then([this](const std::vector<std::byte>& records) {
      return file_->append(records);
    });
  }
  [[nodiscard]] uint64_t written() const override { return file_->points(); }
  Result<uint64_t> finish() override { return file_->finish(); }

 private:
  std::unique_ptr<RecordWriter> file_;
  LasTable table_;
};

Result<std::unique_ptr<PointWriter>> create_las(const fs::path& target, LasPoints points, const TargetForm& form,
                                                const ExportOptions& options, std::vector<std::string>& notes) {
  points.scale = options.encoding.scale;
  points.compressed = form.format == PointFormat::kLaz;
  points.modern = form.octree.has_value();
  Result<LasTable> table = plan_las_table(points);
  if (!table) return fail(table);
  if (!points.schema->grid || *points.schema->grid != table->grid)
    notes.push_back("coordinates are rounded to multiples of " + shortest(table->grid.scale.x));
  if (form.octree) {
    for (std::string& note : become_version_14(table->head, points.schema->crs)) notes.push_back(std::move(note));
  }
  Result<std::unique_ptr<RecordWriter>> file = create_records(target, table->head, form, options);
  if (!file) return fail(file);
  return std::make_unique<LasTableWriter>(std::move(*file), std::move(*table));
}

Result<std::unique_ptr<PointWriter>> create_writer(const fs::path& target, const scan::ScanStream& scan,
                                                   const TargetForm& form, const ExportOptions& options,
                                                   std::vector<std::string>& notes) {
  // Not all is known beforehand that LAS states before its points: some of them may lack coordinates.
  if (is_las(form.format)) {
    const LasPoints points{.schema = &scan.schema(), .bounds = scan.bounds(), .count = scan.size()};
    return create_las(target, points, form, options, notes);
  }
  return make_point_encoder(form.format, scan.schema(), {.count = scan.size(), .bounds = scan.bounds()},
                            options.encoding)
      .and_then([&](std::unique_ptr<PointEncoder> encoder) { return EncodedFile::create(target, std::move(encoder)); });
}

Result<ExportReport> convert_points(const fs::path& source, const fs::path& target, const TargetForm& form,
                                    const ExportOptions& options) {
  const Result<scan::ScanStream> scan = grid::open_scan(source, options.limit, {}, options.selection);
  if (!scan) return fail(scan);
  ExportReport report;
  report.notes = scan->schema().notes;
  const Result<std::unique_ptr<PointWriter>> writer = create_writer(target, *scan, form, options, report.notes);
  if (!writer) return fail(writer);
  const Status written = for_each_piece<scan::ScanPoints>(
      scan->pieces(), [&](size_t piece) { return scan->read(piece); },
      [&](const scan::ScanPoints& points) { return (*writer)->append(points); });
  if (!written) return fail(written);
  report.points = (*writer)->written();
  if (report.points < scan->size())
    report.notes.push_back(std::to_string(scan->size() - report.points) + " points without coordinates are left out");
  return (*writer)->finish().map([&](uint64_t bytes) {
    report.bytes = bytes;
    return report;
  });
}

Result<PointFacts> count_points(const ModelPoints& points, WantedFacts wanted) {
  PointFacts facts;
  const Status counted = for_each_piece<PointFacts>(
      points.pieces(), [&](size_t piece) { return points.count(piece, wanted); },
      [&facts](const PointFacts& piece) -> Status {
        facts.add(piece);
        return {};
      });
  if (!counted) return fail(counted);
  return facts;
}

Result<std::unique_ptr<PointWriter>> create_model_writer(const fs::path& target, scan::ScanSchema schema,
                                                         const PointFacts& facts, const TargetForm& form,
                                                         const ExportOptions& options,
                                                         std::vector<std::string>& notes) {
  if (form.octree) {
    schema.grid = facts.grid;
    const LasPoints points{.schema = &schema, .bounds = facts.bounds, .count = facts.count};
    return create_las(target, points, form, options, notes);
  }
  Result<std::unique_ptr<PointEncoder>> encoder =
      make_point_encoder(form.format, std::move(schema), facts, options.encoding);
  if (!encoder) return fail(encoder);
  if (std::string note = (*encoder)->note(); !note.empty()) notes.push_back(std::move(note));
  return EncodedFile::create(target, std::move(*encoder));
}

Result<ExportReport> export_points_of_model(std::shared_ptr<const model::ModelFile> model, const fs::path& target,
                                            const TargetForm& form, const ExportOptions& options) {
  const std::string source = model->path().string();
  const Result<ModelPoints> points =
      ModelPoints::open(std::move(model), source, {.points = options.selection, .source_coordinates = true});
  if (!points) return fail(points);
  const Result<PointFacts> facts = count_points(*points, facts_for(form.format));
  if (!facts) return fail(facts);
  if (facts->count == 0) return fail(ErrorKind::kInvalidInput, source + ": has no points in the selection");
  ExportReport report{facts->count, 0, {}};
  const Result<std::unique_ptr<PointWriter>> writer =
      create_model_writer(target, points->schema(), *facts, form, options, report.notes);
  if (!writer) return fail(writer);
  const Status written = for_each_piece<scan::ScanPoints>(
      points->pieces(), [&](size_t piece) { return points->read(piece); },
      [&](const scan::ScanPoints& piece) { return (*writer)->append(piece); });
  if (!written) return fail(written);
  return (*writer)->finish().map([&](uint64_t bytes) {
    report.bytes = bytes;
    return report;
  });
}

}  // namespace

Result<ExportReport> export_scan(const fs::path& source, const fs::path& target, const ExportOptions& options) {
  const Result<TargetForm> form = form_of(target);
  if (!form) return fail(form);
  if (lower_extension(source) == ".surf") {
    return model::ModelFile::open(source).and_then([&](model::ModelFile model) {
      return export_points_of_model(std::make_shared<const model::ModelFile>(std::move(model)), target, *form, options);
    });
  }
  const Result<bool> records = holds_records(source);
  if (!records) return fail(records);
  if (*records && is_las(form->format) && !options.encoding.scale) return copy_records(source, target, *form, options);
  return convert_points(source, target, *form, options);
}

Result<ExportReport> export_model(std::shared_ptr<const model::ModelFile> model, const fs::path& target,
                                  const ExportOptions& options) {
  const Result<TargetForm> form = form_of(target);
  if (!form) return fail(form);
  return export_points_of_model(std::move(model), target, *form, options);
}

}  // namespace surfcast::exporter
