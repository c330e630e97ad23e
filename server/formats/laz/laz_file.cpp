#include "laz/laz_file.h"

#include <utility>

#include "base/contract.h"

namespace surfcast::laz {

Status LazChunkReader::read(std::span<std::byte> records) {
  SURFCAST_EXPECTS(records.size() <= left_);
  left_ -= records.size();
  decoder_->decode(records);
  if (decoder_->damaged()) return fail(ErrorKind::kInvalidInput, "a LAZ chunk is damaged");
  return {};
}

Result<LazFile> LazFile::open(std::span<const std::byte> file, const LazPoints& points,
                              std::span<const std::byte> laszip_record) {
  const Result<laz::RecordLayout> layout = laz::record_layout(points.point_format, points.record_length);
  if (!layout) return fail(layout);
  const Result<laz::LaszipRecord> coding = laz::parse_laszip_record(laszip_record, *layout);
  if (!coding) return fail(coding);
  Result<std::vector<laz::Chunk>> chunks =
      laz::read_chunk_table(file, {points.data_offset, points.count, points.record_length}, coding->chunk_size);
  if (!chunks) return fail(chunks);
  return LazFile(file, *layout, *coding, std::move(*chunks));
}

Result<LazFile> LazFile::open_chunks(std::span<const std::byte> file, const LazPoints& points,
                                     std::span<const std::byte> laszip_record, std::vector<laz::Chunk> chunks) {
  const Result<laz::RecordLayout> layout = laz::record_layout(points.point_format, points.record_length);
  if (!layout) return fail(layout);
  const Result<laz::LaszipRecord> coding = laz::parse_laszip_record(laszip_record, *layout);
  if (!coding) return fail(coding);
  for (const laz::Chunk& chunk : chunks) {
    if (Status status = laz::check_chunk(chunk, points.record_length, file.size()); !status) return fail(status);
  }
  return LazFile(file, *layout, *coding, std::move(chunks));
}

Result<LazChunkReader> LazFile::read_chunk(const laz::Chunk& chunk) const {
  const std::span<const std::byte> bytes = file_.subspan(chunk.offset, chunk.size);
  Result<std::unique_ptr<laz::RecordDecoder>> decoder =
      layout_.layered ? laz::decode_layered(layout_, bytes, chunk.count, coding_.stale_channels)
                      : laz::decode_pointwise(layout_, bytes);
  if (!decoder) return fail(decoder);
  return LazChunkReader(std::move(*decoder), chunk.count * layout_.length);
}

}  // namespace surfcast::laz
