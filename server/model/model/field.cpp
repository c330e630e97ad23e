#include "model/field.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "model/byte_stream.h"
#include "model/draco_table.h"

namespace surfcast::model {
namespace {

constexpr int kMaxWidth = 8;    ///< bytes of a stored integer
constexpr int kPieceBytes = 2;  ///< of a piece; the last one may be smaller

int width_of(uint64_t largest) {
  return (static_cast<int>(std::bit_width(largest)) + 7) / 8;
}

/// Bytes of piece number `piece` of integers of this width.
uint8_t piece_bytes(int width, int piece) {
  return static_cast<uint8_t>(std::min(kPieceBytes, width - piece * kPieceBytes));
}

int piece_count(int width) {
  return (width + kPieceBytes - 1) / kPieceBytes;
}

TableAttribute make_piece(const Field& field, const std::vector<ColumnPacking>& packings, int width, int piece) {
  TableAttribute attribute{{piece_bytes(width, piece), static_cast<uint8_t>(field.size())}, {}};
  const size_t rows = field.front().size();
  attribute.values.resize(rows * field.size());
  const auto store = [&](size_t c, const auto& divide) {
    for (size_t i = 0; i < rows; ++i) {
      const uint64_t stored = divide(field[c][i] - packings[c].base);
      attribute.values[i * field.size() + c] = static_cast<uint16_t>(stored >> (8 * kPieceBytes * piece));
    }
  };
  for (size_t c = 0; c < field.size(); ++c) {
    const uint64_t stride = packings[c].stride;
    if (stride == 1) store(c, [](uint64_t difference) { return difference; });
    if (stride != 1) store(c, [stride](uint64_t difference) { return difference / stride; });
  }
  return attribute;
}

void add_piece(const TableAttribute& attribute, const std::vector<ColumnPacking>& packings, int piece, Field& field) {
  for (size_t c = 0; c < field.size(); ++c) {
    for (size_t i = 0; i < field[c].size(); ++i) {
      const uint64_t stored = uint64_t{attribute.values[i * field.size() + c]} << (8 * kPieceBytes * piece);
      field[c][i] += packings[c].stride * stored;
    }
  }
}

/// The header of one field, which precedes the Draco data.
struct FieldHead {
  int width = 0;
  std::vector<ColumnPacking> packings;
};

Result<FieldHead> read_head(ByteReader& reader, size_t columns) {
  FieldHead head;
  head.width = reader.get<uint8_t>();
  for (size_t c = 0; c < columns; ++c) {
    const uint64_t base = reader.get_varint();
    head.packings.push_back({base, reader.get_varint(), 0});
  }
  if (!reader.ok() || head.width > kMaxWidth) return fail(ErrorKind::kInvalidInput, "wrong packing of a column");
  return head;
}

FieldHead make_head(const Field& field) {
  FieldHead head;
  for (const Column& column : field) {
    head.packings.push_back(choose_packing(column));
    head.width = std::max(head.width, width_of(head.packings.back().largest));
  }
  return head;
}

Field constant_field(const FieldHead& head, uint32_t rows) {
  Field field;
  for (const ColumnPacking& packing : head.packings) field.emplace_back(rows, packing.base);
  return field;
}

}  // namespace

ColumnPacking choose_packing(const Column& column) {
  if (column.empty()) return {};
  const auto [lowest, highest] = std::minmax_element(column.begin(), column.end());
  uint64_t divisor = 0;
  for (const uint64_t value : column) {
    divisor = std::gcd(divisor, value - *lowest);
    if (divisor == 1) break;
  }
  divisor = std::max<uint64_t>(divisor, 1);
  return {*lowest, divisor, (*highest - *lowest) / divisor};
}

std::vector<std::byte> encode_fields(std::span<const Field> fields) {
  ByteWriter writer;
  std::vector<TableAttribute> table;
  for (const Field& field : fields) {
    const FieldHead head = make_head(field);
    writer.put(static_cast<uint8_t>(head.width));
    for (const ColumnPacking& packing : head.packings) {
      writer.put_varint(packing.base);
      writer.put_varint(packing.stride);
    }
    for (int piece = 0; piece < piece_count(head.width); ++piece) {
      table.push_back(make_piece(field, head.packings, head.width, piece));
    }
  }
  if (!table.empty()) writer.put_bytes(encode_table(table));
  return std::move(writer).take();
}

Result<std::vector<Field>> decode_fields(std::span<const std::byte> bytes, std::span<const size_t> columns,
                                         uint32_t rows, size_t wanted) {
  ByteReader reader(bytes);
  std::vector<FieldHead> heads;
  std::vector<TableType> types;
  size_t wanted_pieces = 0;
  for (const size_t count : columns) {
    Result<FieldHead> head = read_head(reader, count);
    if (!head) return fail(head);
    for (int piece = 0; piece < piece_count(head->width); ++piece) {
      types.push_back({piece_bytes(head->width, piece), static_cast<uint8_t>(count)});
    }
    if (heads.size() < wanted) wanted_pieces = types.size();
    heads.push_back(std::move(*head));
  }
  std::vector<TableAttribute> table;
  if (!types.empty()) {
    auto decoded = decode_table(reader.rest(), types, rows, wanted_pieces);
    if (!decoded) return fail(decoded);
    table = std::move(*decoded);
  }
  std::vector<Field> fields;
  size_t next = 0;
  heads.resize(std::min(wanted, heads.size()));
  for (const FieldHead& head : heads) {
    Field field = constant_field(head, rows);
    for (int piece = 0; piece < piece_count(head.width); ++piece) add_piece(table[next++], head.packings, piece, field);
    fields.push_back(std::move(field));
  }
  return fields;
}

}  // namespace surfcast::model
