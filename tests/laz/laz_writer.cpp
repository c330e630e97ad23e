#include "laz/laz_writer.h"

#include <algorithm>

#include "laz/byte_access.h"
#include "laz/laszip_record.h"

namespace surfcast::laz::testing {
namespace {

using Bytes = std::vector<std::byte>;

template <typename... Numbers>
void append(Bytes& to, Numbers... numbers) {
  const auto append_one = [&to](auto number) {
    to.resize(to.size() + sizeof(number));
    store(&to[to.size() - sizeof(number)], number);
  };
  (append_one(numbers), ...);
}

/// Points in the chunks of a file of so many points.
std::vector<size_t> chunk_counts(const LazWriter& writer, size_t points) {
  if (writer.variable_chunks) return writer.chunk_sizes;
  std::vector<size_t> counts;
  for (size_t left = points; left > 0; left -= counts.back())
    counts.push_back(std::min<size_t>(left, writer.chunk_size));
  return counts;
}

}  // namespace

Bytes LazWriter::laszip_record() const {
  return encode_laszip_record(coding());
}

Bytes LazWriter::point_data(std::span<const std::byte> records, size_t data_offset) const {
  Bytes data;
  append(data, int64_t{-1});
  std::vector<ChunkSize> chunks;
  for (const size_t count : chunk_counts(*this, records.size() / record_length)) {
    const auto of_chunk = records.first(count * record_length);
    records = records.subspan(of_chunk.size());
    const Bytes chunk = count == 0 ? Bytes() : encode_chunk(coding(), of_chunk);
    chunks.push_back({count, chunk.size()});
    data.insert(data.end(), chunk.begin(), chunk.end());
  }
  const auto table_offset = static_cast<int64_t>(data_offset + data.size());
  if (!offset_at_end) store(data.data(), table_offset);
  const Bytes table = encode_chunk_table(coding(), chunks);
  data.insert(data.end(), table.begin(), table.end());
  if (offset_at_end) append(data, table_offset);
  return data;
}

Coding LazWriter::coding() const {
  return {*record_layout(point_format, record_length), variable_chunks ? kVariableChunks : chunk_size, layered_version};
}

}  // namespace surfcast::laz::testing
