#include "model/column.h"

#include <algorithm>
#include <numeric>

#include "base/contract.h"
#include "model/byte_stream.h"
#include "model/draco_table.h"

namespace surfcast {
namespace {

uint8_t bytes_for(uint64_t largest) {
  if (largest == 0) return 0;
  if (largest <= 0xff) return 1;
  if (largest <= 0xffff) return 2;
  return largest <= 0xffffffff ? 4 : 8;
}

bool valid(const ColumnPacking& packing) {
  constexpr uint8_t kAllowed[] = {0, 1, 2, 4, 8};
  return std::find(std::begin(kAllowed), std::end(kAllowed), packing.bytes) != std::end(kAllowed);
}

/// The integers that Draco stores for a column: one table column, or two halves for 64 bits.
void append_stored(const Column& column, const ColumnPacking& packing, std::vector<TableColumn>& table) {
  if (packing.bytes == 0) return;
  TableColumn low{std::min<uint8_t>(packing.bytes, 4), {}};
  TableColumn high{4, {}};
  for (const uint64_t value : column) {
    const uint64_t stored = (value - packing.base) / packing.stride;
    low.values.push_back(static_cast<uint32_t>(stored));
    if (packing.bytes == 8) high.values.push_back(static_cast<uint32_t>(stored >> 32));
  }
  table.push_back(std::move(low));
  if (packing.bytes == 8) table.push_back(std::move(high));
}

/// Undoes `append_stored`; `next` counts the table columns that are used up.
Column restore(const ColumnPacking& packing, const std::vector<TableColumn>& table, size_t& next, uint32_t rows) {
  Column column(rows, packing.base);
  if (packing.bytes == 0) return column;
  const TableColumn& low = table[next++];
  for (size_t i = 0; i < rows; ++i) column[i] += packing.stride * low.values[i];
  if (packing.bytes == 8) {
    const TableColumn& high = table[next++];
    for (size_t i = 0; i < rows; ++i) column[i] += packing.stride * (uint64_t{high.values[i]} << 32);
  }
  return column;
}

}  // namespace

ColumnPacking choose_packing(const Column& column) {
  if (column.empty()) return {};
  const auto [lowest, highest] = std::minmax_element(column.begin(), column.end());
  ColumnPacking packing{*lowest, 1, 0};
  uint64_t divisor = 0;
  for (const uint64_t value : column) {
    divisor = std::gcd(divisor, value - packing.base);
    if (divisor == 1) break;
  }
  packing.stride = std::max<uint64_t>(divisor, 1);
  packing.bytes = bytes_for((*highest - packing.base) / packing.stride);
  return packing;
}

std::vector<std::byte> encode_columns(std::span<const Column> columns) {
  ByteWriter writer;
  std::vector<TableColumn> table;
  for (const Column& column : columns) {
    const ColumnPacking packing = choose_packing(column);
    writer.put_varint(packing.base);
    writer.put_varint(packing.stride);
    writer.put(packing.bytes);
    append_stored(column, packing, table);
  }
  if (!table.empty()) writer.put_bytes(encode_table(table));
  return std::move(writer).take();
}

Result<std::vector<Column>> decode_columns(std::span<const std::byte> bytes, size_t count, uint32_t rows) {
  ByteReader reader(bytes);
  std::vector<ColumnPacking> packings(count);
  std::vector<uint8_t> widths;
  for (ColumnPacking& packing : packings) {
    packing = {reader.get_varint(), reader.get_varint(), reader.get<uint8_t>()};
    if (!reader.ok() || !valid(packing)) return fail(ErrorKind::kInvalidInput, "wrong column packing");
    if (packing.bytes > 0) widths.push_back(std::min<uint8_t>(packing.bytes, 4));
    if (packing.bytes == 8) widths.push_back(4);
  }
  std::vector<TableColumn> table;
  if (!widths.empty()) {
    auto decoded = decode_table(reader.rest(), widths, rows);
    if (!decoded) return fail(std::move(decoded.error()));
    table = std::move(*decoded);
  }
  std::vector<Column> columns;
  size_t next = 0;
  for (const ColumnPacking& packing : packings) columns.push_back(restore(packing, table, next, rows));
  return columns;
}

}  // namespace surfcast
