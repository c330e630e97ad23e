#include "scan/las_records.h"

#include <algorithm>
#include <utility>

#include "scan/las_reader.h"

namespace surfcast::scan {

LasRecords::LasRecords(const std::filesystem::path& path, MappedFile file, LasHeader header,
                       std::unique_ptr<RowSource> rows, RowFilter filter)
    : path_(path),
      file_(std::move(file)),
      header_(std::move(header)),
      rows_(std::move(rows)),
      filter_(std::move(filter)) {}

Result<LasRecords> LasRecords::open(const std::filesystem::path& path, const Selection& selection) {
  const auto named = [&path](const Error& error) { return fail(error.kind, path.string() + ": " + error.message); };
  Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  Result<LasHeader> header = parse_las_header(file->bytes());
  if (!header) return named(header.error());
  Result<std::unique_ptr<RowSource>> rows = las_rows(file->bytes(), selection);
  if (!rows) return named(rows.error());
  Result<RowFilter> filter = RowFilter::make((*rows)->columns(), selection);
  if (!filter) return named(filter.error());
  return LasRecords(path, std::move(*file), std::move(*header), std::move(*rows), std::move(*filter));
}

Result<std::vector<std::byte>> LasRecords::read(size_t piece) const {
  const Result<PointTable> table = rows_->read(piece);
  if (!table) return fail_about(path_.string(), table);
  const std::vector<uint32_t> chosen = filter_.chosen(*table);
  const size_t length = header_.record_length;
  std::vector<std::byte> records(chosen.size() * length);
  std::byte* to = records.data();
  for (const uint32_t row : chosen) to = std::copy_n(table->las_records + row * length, length, to);
  file_.release_pages();
  return records;
}

}  // namespace surfcast::scan
