#include "scan/laz_rows.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "laz/laz_file.h"
#include "scan/las_reader.h"

namespace surfcast::scan {
namespace {

/// Decodes a chunk. Memory grows with the points decoded, because the stated count of a chunk is not trustworthy.
Result<std::vector<std::byte>> decode_chunk(const laz::LazFile& file, const laz::Chunk& chunk) {
  constexpr uint64_t kPointsAtOnce = 1 << 16;
  Result<laz::LazChunkReader> reader = file.read_chunk(chunk);
  if (!reader) return fail(reader.error());
  std::vector<std::byte> records;
  for (uint64_t done = 0; done < chunk.count;) {
    const uint64_t points = std::min(chunk.count - done, kPointsAtOnce);
    const size_t before = records.size();
    records.resize(before + points * file.record_length());
    if (Status status = reader->read(std::span(records).subspan(before)); !status) return fail(status.error());
    done += points;
  }
  return records;
}

class LazRows : public RowSource {
 public:
  LazRows(laz::LazFile file, LasHeader header)
      : file_(std::move(file)), header_(std::move(header)), columns_(las_columns(header_)) {
    traits_.grid = header_.grid;
  }

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return file_.chunks().size(); }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    const laz::Chunk& chunk = file_.chunks()[piece];
    Result<std::vector<std::byte>> records = decode_chunk(file_, chunk);
    if (!records) return fail(std::move(records.error()));
    PointTable table = las_table(records->data(), chunk.count, header_);
    table.records = std::move(*records);
    return table;
  }

 private:
  laz::LazFile file_;
  LasHeader header_;
  RowTraits traits_;
  std::vector<ColumnInfo> columns_;
};

}  // namespace

Result<std::unique_ptr<RowSource>> laz_rows(std::span<const std::byte> bytes, LasHeader header) {
  if (header.laszip_record.empty()) {
    return fail(ErrorKind::kInvalidInput, "LAZ compressed, but without a LASzip record");
  }
  const laz::LazPoints points = {header.point_format, header.record_length, header.count, header.data_offset};
  Result<laz::LazFile> file = laz::LazFile::open(bytes, points, header.laszip_record);
  if (!file) return fail(std::move(file.error()));
  return std::make_unique<LazRows>(std::move(*file), std::move(header));
}

}  // namespace surfcast::scan
