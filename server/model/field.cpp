#include "model/field.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>

#include "model/byte_stream.h"
#include "model/draco_table.h"

namespace surfcast {
namespace {

constexpr int kMaxWidth = 8;    ///< bytes of a stored integer
constexpr int kPieceBytes = 2;  ///< of each piece but the last
/// Added to the width of a field whose stored integers are those of an earlier one, whose number follows.
constexpr uint8_t kRepeatFlag = 0x80;

int width_of(uint64_t largest) {
  return (static_cast<int>(std::bit_width(largest)) + 7) / 8;
}

/// Bytes of piece `piece` of integers of that width.
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
  for (size_t c = 0; c < field.size(); ++c) {
    for (size_t i = 0; i < rows; ++i) {
      const uint64_t stored = (field[c][i] - packings[c].base) / packings[c].stride;
      attribute.values[i * field.size() + c] = static_cast<uint16_t>(stored >> (8 * kPieceBytes * piece));
    }
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

/// What precedes the Draco data of one field.
struct FieldHead {
  int width = 0;
  std::optional<size_t> repeats;  ///< an earlier field with the same stored integers
  std::vector<ColumnPacking> packings;

  /// Pieces of its own in the Draco data.
  [[nodiscard]] int pieces() const { return repeats ? 0 : piece_count(width); }
};

/// The head of the field that comes after those of `before`.
Result<FieldHead> read_head(ByteReader& reader, size_t columns, std::span<const FieldHead> before) {
  FieldHead head;
  const auto width = reader.get<uint8_t>();
  head.width = width & ~kRepeatFlag;
  if ((width & kRepeatFlag) != 0) {
    head.repeats = reader.get<uint8_t>();
    const bool possible = *head.repeats < before.size() && before[*head.repeats].packings.size() == columns &&
                          before[*head.repeats].width == head.width && !before[*head.repeats].repeats;
    if (!possible) return fail(ErrorKind::kInvalidInput, "a column repeats a wrong one");
  }
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

bool same_stored(const Column& a, const ColumnPacking& pa, const Column& b, const ColumnPacking& pb) {
  if (pa.largest != pb.largest) return false;
  for (size_t i = 0; i < a.size(); ++i) {
    if ((a[i] - pa.base) / pa.stride != (b[i] - pb.base) / pb.stride) return false;
  }
  return true;
}

/// The first field with the stored integers of the last one (scanners and converters store brightness twice); none
/// for constants, which take no space.
std::optional<size_t> find_repeated(std::span<const Field> fields, std::span<const FieldHead> heads) {
  const size_t last = heads.size() - 1;
  if (heads[last].width == 0) return std::nullopt;
  for (size_t i = 0; i < std::min<size_t>(last, 256); ++i) {
    if (heads[i].repeats || fields[i].size() != fields[last].size()) continue;
    bool same = true;
    for (size_t c = 0; c < fields[i].size() && same; ++c) {
      same = same_stored(fields[i][c], heads[i].packings[c], fields[last][c], heads[last].packings[c]);
    }
    if (same) return i;
  }
  return std::nullopt;
}

void write_head(const FieldHead& head, ByteWriter& writer) {
  writer.put(static_cast<uint8_t>(head.width | (head.repeats ? kRepeatFlag : 0)));
  if (head.repeats) writer.put(static_cast<uint8_t>(*head.repeats));
  for (const ColumnPacking& packing : head.packings) {
    writer.put_varint(packing.base);
    writer.put_varint(packing.stride);
  }
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
  std::vector<FieldHead> heads;
  for (const Field& field : fields) {
    FieldHead& head = heads.emplace_back(make_head(field));
    head.repeats = find_repeated(fields, heads);
    write_head(head, writer);
    for (int piece = 0; piece < head.pieces(); ++piece) {
      table.push_back(make_piece(field, head.packings, head.width, piece));
    }
  }
  if (!table.empty()) writer.put_bytes(encode_table(table));
  return std::move(writer).take();
}

Result<std::vector<Field>> decode_fields(std::span<const std::byte> bytes, std::span<const size_t> columns,
                                         uint32_t rows) {
  ByteReader reader(bytes);
  std::vector<FieldHead> heads;
  std::vector<TableType> types;
  for (const size_t count : columns) {
    Result<FieldHead> head = read_head(reader, count, heads);
    if (!head) return fail(std::move(head.error()));
    for (int piece = 0; piece < head->pieces(); ++piece) {
      types.push_back({piece_bytes(head->width, piece), static_cast<uint8_t>(count)});
    }
    heads.push_back(std::move(*head));
  }
  std::vector<TableAttribute> table;
  if (!types.empty()) {
    auto decoded = decode_table(reader.rest(), types, rows);
    if (!decoded) return fail(std::move(decoded.error()));
    table = std::move(*decoded);
  }
  std::vector<Field> fields;
  std::vector<size_t> first_pieces;
  size_t next = 0;
  for (const FieldHead& head : heads) {
    first_pieces.push_back(head.repeats ? first_pieces[*head.repeats] : next);
    next += static_cast<size_t>(head.pieces());
    Field field = constant_field(head, rows);
    for (int piece = 0; piece < piece_count(head.width); ++piece) {
      add_piece(table[first_pieces.back() + static_cast<size_t>(piece)], head.packings, piece, field);
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

}  // namespace surfcast
