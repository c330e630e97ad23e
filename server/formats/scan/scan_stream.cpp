#include "scan/scan_stream.h"

#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "scan/gltf_points.h"
#include "scan/las_reader.h"
#include "scan/pnts_reader.h"
#include "scan/readers.h"
#include "scan/sampled_rows.h"
#include "scan/scan_folder.h"
#include "scan/scan_format.h"
#include "scan/selected_rows.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

Result<std::unique_ptr<RowSource>> rows_of(ScanFormat format, std::span<const std::byte> bytes,
                                           const std::filesystem::path& path, const DecodingLimit& limit,
                                           const Selection& selection) {
  switch (format) {
    case ScanFormat::kPly:
      return ply_rows(bytes);
    case ScanFormat::kLas:
      return las_rows(bytes, selection);
    case ScanFormat::kPcd:
      return pcd_rows(bytes, limit);
    case ScanFormat::kPtx:
      return ptx_rows(bytes);
    case ScanFormat::kAsciiGrid:
      return ascii_grid_rows(bytes, path);
    case ScanFormat::kDraco:
      return draco_rows(bytes, limit);
    case ScanFormat::kE57:
      return e57_rows(bytes);
    case ScanFormat::kExpe:
      return expe_rows(bytes);
    case ScanFormat::kPnts:
      return pnts_rows(bytes, limit);
    case ScanFormat::kGltf:
      return gltf_rows(bytes, path, limit);
    case ScanFormat::kText:
      break;
  }
  return text_rows(bytes);
}

/// The roles with which facts are collected. Without names, x, y and z come first and the others have no role yet.
Result<ColumnRoles> first_roles(const RowSource& rows) {
  if (!rows.columns().empty() && rows.columns()[0].name.empty()) {
    ColumnRoles roles;
    roles.position = {0, 1, 2};
    return roles;
  }
  return assign_roles(rows.columns(), {});
}

/// Reads all pieces on all threads. Of several errors, returns the one of the first piece.
Result<TableFacts> survey_rows(const RowSource& rows, const MappedFile* file) {
  const Result<ColumnRoles> roles = first_roles(rows);
  if (!roles) return fail(roles);
  const bool unnamed = rows.columns()[0].name.empty();
  std::vector<Result<TableFacts>> facts(rows.pieces());
  oneapi::tbb::parallel_for(size_t{0}, rows.pieces(), [&](size_t i) {
    const Result<PointTable> table = rows.read(i);
    facts[i] = table ? Result<TableFacts>(find_facts(*table, *roles, unnamed)) : fail(table);
    if (file != nullptr) file->release_pages();
  });
  TableFacts all;
  for (const Result<TableFacts>& piece : facts) {
    if (!piece) return fail(piece);
    all.include(*piece);
  }
  Status whole = check_announced(all.rows, all.announced + rows.traits().announced);
  if (!whole) return fail(whole);
  return all;
}

}  // namespace

/// Leaves a part of the rows, if one is wanted.
Status ScanStream::take_sample(std::optional<uint64_t> sample) {
  if (!sample) return {};
  Result<RowSample> taken = sample_rows(*rows_, *sample);
  if (!taken) return fail(taken);
  rows_ = std::move(taken->rows);
  facts_.points_of_file = taken->of_rows;
  return {};
}

Status ScanStream::examine(std::span<const std::byte> bytes, const std::filesystem::path& path,
                           const Opening& opening) {
  Result<std::unique_ptr<RowSource>> rows =
      scan_format_of(bytes, path)
          .and_then([&](ScanFormat format) { return rows_of(format, bytes, path, opening.limit, opening.selection); })
          .and_then([&](std::unique_ptr<RowSource> all) { return select_rows(std::move(all), opening.selection); });
  if (!rows) return fail_about(path.string(), rows);
  rows_ = std::move(*rows);
  return examine_rows(path, opening);
}

Status ScanStream::examine_folder(const ScanFolder& folder, const std::filesystem::path& path, const Opening& opening) {
  Result<std::unique_ptr<RowSource>> rows =
      folder_rows(folder, opening.limit, opening.selection).and_then([&](std::unique_ptr<RowSource> all) {
        return select_rows(std::move(all), opening.selection);
      });
  if (!rows) return fail_about(path.string(), rows);
  rows_ = std::move(*rows);
  return examine_rows(path, opening);
}

Status ScanStream::examine_rows(const std::filesystem::path& path, const Opening& opening) {
  path_ = path;
  if (opening.facts != nullptr) {
    facts_ = *opening.facts;
    return {};
  }
  const auto named = [&path](const Error& error) { return fail(error.kind, path.string() + ": " + error.message); };
  if (Status taken = take_sample(opening.sample); !taken) return named(taken.error());
  const Result<TableFacts> facts = survey_rows(*rows_, file_ ? &*file_ : nullptr);
  if (!facts) return named(facts.error());
  if (!opening.selection.everything() && facts->rows == 0) {
    return named({ErrorKind::kInvalidInput, "has no points in the selection"});
  }
  Result<TableMeaning> meaning = decide_meaning(*rows_, *facts);
  if (!meaning) return named(meaning.error());
  facts_.meaning = std::move(*meaning);
  facts_.meaning.schema.name = path.filename().string();
  facts_.points = facts->rows;
  if (!opening.sample) facts_.points_of_file = facts_.points;
  facts_.bounds = facts->bounds;
  return {};
}

Result<ScanStream> ScanStream::open_content(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                            const DecodingLimit& limit) {
  ScanStream stream;
  if (Status status = stream.examine(bytes, path, {limit, {}, {}}); !status) return fail(status);
  return stream;
}

Result<ScanStream> ScanStream::of_rows_as(std::unique_ptr<RowSource> rows, const std::filesystem::path& path,
                                          const Opening& opening) {
  ScanStream stream;
  Result<std::unique_ptr<RowSource>> selected = select_rows(std::move(rows), opening.selection);
  if (!selected) return fail_about(path.string(), selected);
  stream.rows_ = std::move(*selected);
  if (Status status = stream.examine_rows(path, opening); !status) return fail(status);
  return stream;
}

Result<ScanStream> ScanStream::of_rows(std::unique_ptr<RowSource> rows, const std::filesystem::path& path,
                                       std::optional<uint64_t> sample, const Selection& selection) {
  return of_rows_as(std::move(rows), path, {{}, sample, selection});
}

Result<ScanStream> ScanStream::reopen_rows(std::unique_ptr<RowSource> rows, const std::filesystem::path& path,
                                           const Selection& selection, const ScanFacts& facts) {
  return of_rows_as(std::move(rows), path, {{}, {}, selection, &facts});
}

Result<ScanStream> ScanStream::open_as(const std::filesystem::path& path, const Opening& opening) {
  ScanStream stream;
  if (const std::optional<ScanFolder> folder = scan_folder_of(path)) {
    const Status status = stream.examine_folder(*folder, path, opening);
    if (!status) return fail(status);
    return stream;
  }
  if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) {
    return fail(ErrorKind::kUnsupported, path.string() + ": a folder that holds no description of a scan");
  }
  Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  stream.file_ = std::move(*file);
  if (Status status = stream.examine(stream.file_->bytes(), path, opening); !status) return fail(status);
  return stream;
}

Result<ScanStream> ScanStream::open(const std::filesystem::path& path, const DecodingLimit& limit,
                                    std::optional<uint64_t> sample, const Selection& selection) {
  return open_as(path, {limit, sample, selection});
}

Result<ScanStream> ScanStream::reopen(const std::filesystem::path& path, const DecodingLimit& limit,
                                      const Selection& selection, const ScanFacts& facts) {
  return open_as(path, {limit, {}, selection, &facts});
}

Result<ScanPoints> ScanStream::read(size_t piece) const {
  const Result<PointTable> table = rows_->read(piece);
  if (!table) return fail_about(path_.string(), table);
  ScanPoints points = points_of(*table, facts_.meaning);
  if (file_) file_->release_pages();
  return points;
}

std::vector<std::filesystem::path> files_of_scan(const std::filesystem::path& path) {
  if (const std::optional<ScanFolder> folder = scan_folder_of(path)) return files_of_folder(*folder);
  std::vector<std::filesystem::path> files = {path};
  const std::filesystem::path projection = projection_file(path);
  if (std::error_code ignored; !std::filesystem::exists(projection, ignored)) return files;
  const Result<MappedFile> file = MappedFile::open(path);
  if (file && looks_like_ascii_grid(as_text(file->bytes()))) files.push_back(projection);
  return files;
}

Status check_header(const std::filesystem::path& path) {
  if (scan_folder_of(path)) return {};
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  const Result<ScanFormat> format = scan_format_of(file->bytes(), path);
  const auto named = [&path](const Error& error) { return fail(error.kind, path.string() + ": " + error.message); };
  if (!format) return named(format.error());
  if (*format != ScanFormat::kPly && *format != ScanFormat::kLas) return {};
  const Result<std::unique_ptr<RowSource>> rows = rows_of(*format, file->bytes(), path, {}, {});
  if (!rows) return named(rows.error());
  return {};
}

}  // namespace surfcast::scan
