#include <algorithm>
#include <bit>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scan/ply_header.h"
#include "scan/point_table.h"
#include "scan/readers.h"
#include "scan/sliced_rows.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

tl::unexpected<Error> truncated(const PlyElement& element) {
  return fail(ErrorKind::kInvalidInput, "truncated: the file ends within its " + std::to_string(element.count) + " " +
                                            printable(element.name) + " elements");
}

bool has_lists(const PlyElement& element) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [](const PlyProperty& p) { return p.list_count.has_value(); });
}

size_t record_size(const PlyElement& element) {
  size_t size = 0;
  for (const PlyProperty& property : element.properties) size += size_of(property.type);
  return size;
}

std::vector<ColumnInfo> columns_of(const PlyElement& element) {
  std::vector<ColumnInfo> columns;
  for (const PlyProperty& property : element.properties) {
    if (!property.list_count) columns.push_back({property.name, property.type, false});
  }
  return columns;
}

/// Reads rows of binary elements with lists, whose rows differ in size.
class BinaryWalk {
 public:
  BinaryWalk(std::span<const std::byte> rest, bool swapped) : rest_(rest), swapped_(swapped) {}

  /// Skips an element of fixed record size and returns its first record. Fails if the file ends within it.
  Result<const std::byte*> take_records(const PlyElement& element) {
    const size_t size = record_size(element);
    if (size > 0 && element.count > rest_.size() / size) return truncated(element);
    const std::byte* first = rest_.data();
    rest_ = rest_.subspan(size * element.count);
    return first;
  }

  /// Reads `rows` rows, into the columns if given. A row with lists has at least one byte for the length of a list, so
  /// the file size bounds the loop whatever the header states.
  Status walk_rows(const PlyElement& element, uint64_t rows, std::vector<surfel::ScalarValues>* columns) {
    for (uint64_t row = 0; row < rows; ++row) {
      size_t column = 0;
      for (const PlyProperty& property : element.properties) {
        const bool whole = property.list_count ? skip_list(property)
                                               : read_value(property.type, columns ? &(*columns)[column++] : nullptr);
        if (!whole) return truncated(element);
      }
    }
    return {};
  }

  Status skip(const PlyElement& element) {
    if (!has_lists(element)) return take_records(element).map([](auto) {});
    return walk_rows(element, element.count, nullptr);
  }

 private:
  bool skip_list(const PlyProperty& property) {
    if (rest_.size() < size_of(*property.list_count)) return false;
    const auto count = with_type(*property.list_count, [&](auto zero) {
      return static_cast<int64_t>(load<decltype(zero)>(rest_.data(), swapped_));
    });
    rest_ = rest_.subspan(size_of(*property.list_count));
    const size_t size = size_of(property.type);
    if (count < 0 || static_cast<uint64_t>(count) > rest_.size() / size) return false;
    rest_ = rest_.subspan(static_cast<size_t>(count) * size);
    return true;
  }

  bool read_value(ScalarType type, surfel::ScalarValues* into) {
    if (rest_.size() < size_of(type)) return false;
    if (into != nullptr) {
      std::visit(
          [&](auto& values) {
            values.push_back(load<typename std::decay_t<decltype(values)>::value_type>(rest_.data(), swapped_));
          },
          *into);
    }
    rest_ = rest_.subspan(size_of(type));
    return true;
  }

  std::span<const std::byte> rest_;
  bool swapped_;
};

/// Reads rows of ascii elements word by word.
class AsciiWalk {
 public:
  explicit AsciiWalk(std::string_view text) : tokens_(text) {}

  Status walk_rows(const PlyElement& element, uint64_t rows, std::vector<surfel::ScalarValues>* columns) {
    if (element.properties.empty()) return {};
    for (uint64_t row = 0; row < rows; ++row) {
      size_t column = 0;
      for (const PlyProperty& property : element.properties) {
        if (property.list_count ? !skip_list() : !read_value(columns ? &(*columns)[column++] : nullptr)) {
          return bad_word(element);
        }
      }
    }
    return {};
  }

  Status skip(const PlyElement& element) { return walk_rows(element, element.count, nullptr); }

 private:
  bool skip_list() {
    word_ = tokens_.next();
    const std::optional<uint64_t> count = parse_number<uint64_t>(word_);
    if (!count) return false;
    for (uint64_t i = 0; i < *count; ++i) {
      word_ = tokens_.next();
      if (word_.empty()) return false;
    }
    return true;
  }

  bool read_value(surfel::ScalarValues* into) {
    word_ = tokens_.next();
    return into == nullptr ? !word_.empty() : append_number(*into, word_);
  }

  [[nodiscard]] tl::unexpected<Error> bad_word(const PlyElement& element) const {
    if (word_.empty()) return truncated(element);
    return fail(ErrorKind::kInvalidInput,
                "not a number of the stated type in a " + printable(element.name) + " element: " + printable(word_));
  }

  Tokens tokens_;
  std::string_view word_;
};

/// Elements whose rows must be read sequentially. The starts of the pieces are found in a first pass.
template <typename Walk>
class WalkedRows : public RowSource {
 public:
  WalkedRows(RowTraits traits, PlyElement element, std::vector<Walk> starts)
      : traits_(std::move(traits)),
        element_(std::move(element)),
        columns_(columns_of(element_)),
        starts_(std::move(starts)) {}

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return starts_.size(); }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    Walk walk = starts_[piece];
    std::vector<surfel::ScalarValues> values;
    for (const ColumnInfo& column : columns_) values.push_back(empty_values(column.type));
    PointTable table;
    table.rows = std::min(kPieceRows, element_.count - piece * kPieceRows);
    if (Status status = walk.walk_rows(element_, table.rows, &values); !status) return fail(status);
    for (surfel::ScalarValues& column : values) add_column(table, std::move(column));
    return table;
  }

 private:
  RowTraits traits_;
  PlyElement element_;
  std::vector<ColumnInfo> columns_;
  std::vector<Walk> starts_;
};

/// Skips the elements before or after the wanted one.
template <typename Walk>
Status skip_all(std::span<const PlyElement> elements, Walk& walk) {
  for (const PlyElement& element : elements) {
    if (Status status = walk.skip(element); !status) return status;
  }
  return {};
}

template <typename Walk>
Result<std::vector<Walk>> find_starts(const PlyElement& element, Walk& walk) {
  std::vector<Walk> starts;
  for (uint64_t first = 0; first < element.count; first += kPieceRows) {
    starts.push_back(walk);
    Status status = walk.walk_rows(element, std::min(kPieceRows, element.count - first), nullptr);
    if (!status) return fail(status);
  }
  return starts;
}

PointTable table_in_place(const PlyElement& element, const std::byte* records, bool swapped) {
  PointTable table;
  table.rows = element.count;
  size_t offset = 0;
  for (const PlyProperty& property : element.properties) {
    table.columns.push_back({property.type, records + offset, record_size(element), swapped});
    offset += size_of(property.type);
  }
  return table;
}

using Rows = std::unique_ptr<RowSource>;

template <typename Walk>
Result<Rows> walked_rows(const PlyElement& element, const RowTraits& traits, Walk& walk) {
  Result<std::vector<Walk>> starts = find_starts(element, walk);
  if (!starts) return fail(starts);
  return std::make_unique<WalkedRows<Walk>>(traits, element, std::move(*starts));
}

Result<Rows> element_rows(const PlyElement& element, const RowTraits& traits, AsciiWalk& walk, bool /*swapped*/) {
  return walked_rows(element, traits, walk);
}

Result<Rows> element_rows(const PlyElement& element, const RowTraits& traits, BinaryWalk& walk, bool swapped) {
  if (has_lists(element)) return walked_rows(element, traits, walk);
  const Result<const std::byte*> records = walk.take_records(element);
  if (!records) return fail(records);
  return std::make_unique<SlicedRows>(traits, columns_of(element), table_in_place(element, *records, swapped));
}

template <typename Walk>
Result<Rows> rows_of(const PlyHeader& header, size_t wanted, const RowTraits& traits, Walk walk, bool swapped) {
  const std::span elements(header.elements);
  if (Status status = skip_all(elements.first(wanted), walk); !status) return fail(status);
  Result<Rows> rows = element_rows(elements[wanted], traits, walk, swapped);
  if (!rows) return rows;
  if (Status status = skip_all(elements.subspan(wanted + 1), walk); !status) return fail(status);
  return rows;
}

Result<Rows> rows_of(std::span<const std::byte> bytes, const PlyHeader& header, size_t wanted,
                     const RowTraits& traits) {
  const std::span<const std::byte> data = bytes.subspan(header.data_offset);
  if (header.encoding == PlyEncoding::kAscii) return rows_of(header, wanted, traits, AsciiWalk(as_text(data)), false);
  const bool big = header.encoding == PlyEncoding::kBinaryBigEndian;
  const bool swapped = big != (std::endian::native == std::endian::big);
  return rows_of(header, wanted, traits, BinaryWalk(data, swapped), swapped);
}

/// The index of the element; none if the file has no such element.
std::optional<size_t> find_element(const PlyHeader& header, std::string_view name) {
  const auto at = std::find_if(header.elements.begin(), header.elements.end(),
                               [name](const PlyElement& element) { return element.name == name; });
  if (at == header.elements.end()) return std::nullopt;
  return static_cast<size_t>(at - header.elements.begin());
}

tl::unexpected<Error> without(std::string_view element) {
  return fail(ErrorKind::kInvalidInput, "PLY file without " + std::string(element) + " elements");
}

Status check_vertices(const PlyElement& vertex) {
  for (const PlyProperty& property : vertex.properties) {
    if (property.name == "f_dc_0" || property.name == "packed_position") {
      return fail(ErrorKind::kUnsupported, "PLY file of 3D Gaussians, which is not supported");
    }
  }
  if (vertex.count == 0) return fail(ErrorKind::kInvalidInput, "has no points");
  return {};
}

bool has_faces(const PlyHeader& header) {
  return std::any_of(header.elements.begin(), header.elements.end(),
                     [](const PlyElement& e) { return e.name == "face" && e.count > 0; });
}

}  // namespace

Result<std::unique_ptr<RowSource>> ply_rows(std::span<const std::byte> bytes) {
  const Result<PlyHeader> header = parse_ply_header(bytes);
  if (!header) return fail(header);
  const std::optional<size_t> vertex = find_element(*header, "vertex");
  if (!vertex) return without("vertex");
  if (Status status = check_vertices(header->elements[*vertex]); !status) return fail(status);
  RowTraits traits;
  traits.may_be_graphics = has_faces(*header);  // meshes come from graphics, y-up; points come from scanners, z-up
  return rows_of(bytes, *header, *vertex, traits);
}

Result<std::unique_ptr<RowSource>> ply_element_rows(std::span<const std::byte> bytes, std::string_view element) {
  const Result<PlyHeader> header = parse_ply_header(bytes);
  if (!header) return fail(header);
  const std::optional<size_t> wanted = find_element(*header, element);
  if (!wanted) return without(element);
  return rows_of(bytes, *header, *wanted, {});
}

}  // namespace surfcast::scan
