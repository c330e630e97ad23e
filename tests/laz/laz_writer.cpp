#include "laz/laz_writer.h"

#include <algorithm>

#include "laz/byte_access.h"
#include "laz/chunk_encoders.h"
#include "laz/integer_encoder.h"

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

struct Entry {
  size_t points;
  size_t bytes;
};

Bytes encode_table(const std::vector<Entry>& entries, bool variable) {
  ArithmeticEncoder out;
  IntegerEncoder<32, 2> numbers;
  Entry last = {0, 0};
  for (const Entry& entry : entries) {
    if (variable) numbers.encode(out, static_cast<int32_t>(last.points), static_cast<int32_t>(entry.points), 0);
    numbers.encode(out, static_cast<int32_t>(last.bytes), static_cast<int32_t>(entry.bytes), 1);
    last = entry;
  }
  Bytes table;
  append(table, uint32_t{0}, static_cast<uint32_t>(entries.size()));
  const Bytes coded = out.finish();
  table.insert(table.end(), coded.begin(), coded.end());
  return table;
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
  const RecordLayout layout = *record_layout(point_format, record_length);
  Bytes items;
  uint16_t count = 0;
  const auto item = [&](uint16_t type, size_t size, uint16_t version) {
    append(items, type, static_cast<uint16_t>(size), version);
    ++count;
  };
  layout.layered ? item(10, 30, layered_version) : item(6, 20, 2);
  if (layout.gps_time) item(7, 8, 2);
  if (layout.color && !layout.layered) item(8, 6, 2);
  if (layout.color && layout.layered) layout.infrared ? item(12, 8, layered_version) : item(11, 6, layered_version);
  if (layout.wave_packet) layout.layered ? item(13, 29, layered_version) : item(9, 29, 1);
  if (layout.extra_bytes() != 0)
    item(layout.layered ? 14 : 0, layout.extra_bytes(), layout.layered ? layered_version : 2);
  Bytes record;
  append(record, static_cast<uint16_t>(layout.layered ? 3 : 2), uint16_t{0}, uint8_t{3}, uint8_t{4}, uint16_t{3});
  append(record, uint32_t{0}, variable_chunks ? kVariableChunks : chunk_size, int64_t{-1}, int64_t{-1}, count);
  record.insert(record.end(), items.begin(), items.end());
  return record;
}

Bytes LazWriter::point_data(std::span<const std::byte> records, size_t data_offset) const {
  const RecordLayout layout = *record_layout(point_format, record_length);
  Bytes data;
  append(data, int64_t{-1});
  std::vector<Entry> entries;
  for (const size_t count : chunk_counts(*this, records.size() / record_length)) {
    const auto of_chunk = records.first(count * record_length);
    records = records.subspan(of_chunk.size());
    const Bytes chunk = count == 0       ? Bytes()
                        : layout.layered ? encode_layered(layout, of_chunk, layered_version < 4)
                                         : encode_pointwise(layout, of_chunk);
    entries.push_back({count, chunk.size()});
    data.insert(data.end(), chunk.begin(), chunk.end());
  }
  const auto table_offset = static_cast<int64_t>(data_offset + data.size());
  if (!offset_at_end) store(data.data(), table_offset);
  const Bytes table = encode_table(entries, variable_chunks);
  data.insert(data.end(), table.begin(), table.end());
  if (offset_at_end) append(data, table_offset);
  return data;
}

}  // namespace surfcast::laz::testing
