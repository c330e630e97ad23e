#include "scan/las_records.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_for.h>

#include "laz/laz_file.h"

namespace surfcast {
namespace {

/// The count of a chunk is a claim until it is decoded, so memory is taken as the points turn up.
Result<std::vector<std::byte>> decode_chunk(const LazFile& file, const laz::Chunk& chunk) {
  constexpr uint64_t kPointsAtOnce = 1 << 16;
  Result<LazChunkReader> reader = file.read_chunk(chunk);
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

Result<LasRecords> decode_records(const LazFile& file, LasRecords records) {
  const std::span<const laz::Chunk> chunks = file.chunks();
  records.decoded.resize(chunks.size());
  std::vector<Status> statuses(chunks.size());
  tbb::parallel_for(size_t{0}, chunks.size(), [&](size_t i) {
    Result<std::vector<std::byte>> decoded = decode_chunk(file, chunks[i]);
    if (decoded) {
      records.decoded[i] = std::move(*decoded);
    } else {
      statuses[i] = fail(decoded.error());
    }
  });
  for (const Status& status : statuses) {
    if (!status) return fail(status.error());
  }
  records.runs.assign(records.decoded.begin(), records.decoded.end());
  return records;
}

}  // namespace

Result<LasRecords> las_records(std::span<const std::byte> bytes, const LasHeader& header) {
  LasRecords records;
  records.count = header.count;
  records.stride = header.record_length;
  if (!header.compressed) {
    records.runs = {bytes.subspan(header.data_offset, header.count * header.record_length)};
    return records;
  }
  if (header.laszip_record.empty())
    return fail(ErrorKind::kInvalidInput, "LAZ compressed, but without a LASzip record");
  const LazPoints points = {header.point_format, header.record_length, header.count, header.data_offset};
  const Result<LazFile> file = LazFile::open(bytes, points, header.laszip_record);
  if (!file) return fail(file.error());
  return decode_records(*file, std::move(records));
}

}  // namespace surfcast
