#include "laz/chunk_table.h"

#include <algorithm>
#include <string>

#include "base/invalid_input.h"
#include "laz/byte_access.h"
#include "laz/integer_decoder.h"

namespace surfcast::laz {
namespace {

/// The offset of the table precedes the first chunk.
constexpr size_t kOffsetBytes = 8;
/// Version and number of chunks precede the coded entries.
constexpr size_t kTableHeaderBytes = 8;
/// Points that one byte of a chunk can encode, at the very most. Each point but the first takes a symbol of 64 or 128
/// and two or three of 33. A symbol of n takes -log2(1 - (n - 1) / 2^15) bits at least, because each of the others has
/// a probability of 2^-15 or more. The sum is 0.007 bits, which makes 1143 points of a byte; this is a round number
/// above.
constexpr uint64_t kPointsOfByte = 2048;

/// A writer that cannot seek back to the point data stores the offset in the last bytes of the file.
Result<size_t> table_offset(std::span<const std::byte> file, size_t data_offset) {
  if (file.size() < data_offset || file.size() - data_offset < kOffsetBytes) {
    return invalid_input("truncated: the file ends where the LAZ points begin");
  }
  auto offset = load<int64_t>(&file[data_offset]);
  if (offset == -1) offset = load<int64_t>(file.data() + file.size() - kOffsetBytes);
  const auto first_chunk = static_cast<int64_t>(data_offset + kOffsetBytes);
  if (offset < first_chunk) return invalid_input("the LAZ chunk table is missing: the file was not written to its end");
  if (file.size() < kTableHeaderBytes || static_cast<uint64_t>(offset) > file.size() - kTableHeaderBytes) {
    return invalid_input("truncated: the LAZ chunk table lies beyond the end of the file");
  }
  return static_cast<size_t>(offset);
}

Status check_number_of_chunks(uint64_t chunks, const PointData& points, uint32_t chunk_size, size_t data_bytes) {
  // Every chunk begins with an uncompressed record.
  if (chunks > data_bytes / points.record_length) return invalid_input("the LAZ chunk table has more chunks than fit");
  if (chunk_size == kVariableChunks) return {};
  const uint64_t needed = points.count / chunk_size + (points.count % chunk_size != 0 ? 1 : 0);
  if (chunks >= needed) return {};  // the header may state fewer points than there are
  return invalid_input("the LAZ chunk table has " + std::to_string(chunks) + " chunks, " +
                       std::to_string(points.count) + " points need " + std::to_string(needed));
}

/// An entry: the number of points (for chunks of variable size only), then the number of bytes.
class EntryDecoder {
 public:
  EntryDecoder(std::span<const std::byte> bytes, uint32_t chunk_size) : in_(bytes), chunk_size_(chunk_size) {}

  Chunk next() {
    if (chunk_size_ == kVariableChunks) points_ = numbers_.decode(in_, points_, 0);
    bytes_ = numbers_.decode(in_, bytes_, 1);
    const uint64_t count = chunk_size_ == kVariableChunks ? static_cast<uint32_t>(points_) : chunk_size_;
    return {0, count, 0, static_cast<uint32_t>(bytes_)};
  }
  [[nodiscard]] bool damaged() const { return in_.damaged(); }

 private:
  ArithmeticDecoder in_;
  uint32_t chunk_size_;
  int32_t points_ = 0;
  int32_t bytes_ = 0;
  IntegerDecoder<32, 2> numbers_;
};

/// Computes the positions of the chunks and checks that they end at or before `end`.
Status place_chunks(std::vector<Chunk>& chunks, const PointData& points, size_t end) {
  uint64_t first = 0;
  size_t offset = points.offset + kOffsetBytes;
  for (Chunk& chunk : chunks) {
    chunk.first = first;
    chunk.count = std::min(chunk.count, points.count - first);
    chunk.offset = offset;
    if (Status status = check_chunk(chunk, points.record_length, end); !status) return status;
    first += chunk.count;
    offset += chunk.size;
  }
  std::erase_if(chunks, [](const Chunk& chunk) { return chunk.count == 0; });
  if (first == points.count) return {};
  return invalid_input("the LAZ chunks hold " + std::to_string(first) + " points, the header states " +
                       std::to_string(points.count));
}

}  // namespace

Status check_chunk(const Chunk& chunk, size_t record_length, size_t end) {
  if (chunk.offset > end || chunk.size > end - chunk.offset) return invalid_input("a LAZ chunk runs beyond the points");
  if (chunk.count != 0 && chunk.size < record_length) return invalid_input("a LAZ chunk is too short for a point");
  if (chunk.count <= 1 + kPointsOfByte * chunk.size) return {};
  return invalid_input("a LAZ chunk is damaged: " + std::to_string(chunk.count) + " points do not fit into its " +
                       std::to_string(chunk.size) + " bytes");
}

Result<std::vector<Chunk>> read_chunk_table(std::span<const std::byte> file, const PointData& points,
                                            uint32_t chunk_size) {
  const Result<size_t> offset = table_offset(file, points.offset);
  if (!offset) return fail(offset);
  const auto version = load<uint32_t>(&file[*offset]);
  if (version != 0) {
    return fail(ErrorKind::kUnsupported, "LAZ chunk table version " + std::to_string(version) + " is not supported");
  }
  const auto number = load<uint32_t>(&file[*offset + 4]);
  const size_t data_bytes = *offset - points.offset - kOffsetBytes;
  if (Status status = check_number_of_chunks(number, points, chunk_size, data_bytes); !status) {
    return fail(status);
  }
  std::vector<Chunk> chunks(number);
  EntryDecoder entries(file.subspan(*offset + kTableHeaderBytes), chunk_size);
  std::generate(chunks.begin(), chunks.end(), [&entries] { return entries.next(); });
  if (entries.damaged()) return invalid_input("the LAZ chunk table is damaged");
  if (Status status = place_chunks(chunks, points, *offset); !status) return fail(status);
  return chunks;
}

}  // namespace surfcast::laz
