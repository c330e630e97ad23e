#include "scan/ply_reader.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scan/ply_header.h"
#include "scan/point_table.h"
#include "scan/text_tokens.h"
#include "scan/up_axis.h"

namespace surfcast {
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

/// One typed vector for each property that is not a list.
std::vector<ScalarValues> empty_columns(const PlyElement& element) {
  std::vector<ScalarValues> columns;
  for (const PlyProperty& property : element.properties) columns.push_back(empty_values(property.type));
  return columns;
}

PointTable table_of(const PlyElement& element, std::vector<ScalarValues> columns) {
  PointTable table;
  table.rows = element.count;
  table.storage.reserve(columns.size());
  for (size_t i = 0; i < columns.size(); ++i) {
    if (!element.properties[i].list_count) add_column(table, element.properties[i].name, std::move(columns[i]));
  }
  return table;
}

/// Walks the data of binary elements, whose bytes are `rest`.
class BinaryWalk {
 public:
  BinaryWalk(std::span<const std::byte> rest, bool swapped) : rest_(rest), swapped_(swapped) {}

  /// Passes over the element; fails when the file ends within it.
  Status skip(const PlyElement& element) {
    if (!has_lists(element)) return take_records(element).map([](auto) {});
    return walk_rows(element, nullptr);
  }

  Result<PointTable> read(const PlyElement& element) {
    if (has_lists(element)) {
      std::vector<ScalarValues> columns = empty_columns(element);
      if (Status status = walk_rows(element, &columns); !status) return fail(status.error());
      return table_of(element, std::move(columns));
    }
    const Result<const std::byte*> records = take_records(element);
    if (!records) return fail(records.error());
    PointTable table;
    table.rows = element.count;
    size_t offset = 0;
    for (const PlyProperty& property : element.properties) {
      table.columns.push_back({property.name, property.type, *records + offset, record_size(element), swapped_});
      offset += size_of(property.type);
    }
    return table;
  }

 private:
  Result<const std::byte*> take_records(const PlyElement& element) {
    const size_t size = record_size(element);
    if (size > 0 && element.count > rest_.size() / size) return truncated(element);
    const std::byte* first = rest_.data();
    rest_ = rest_.subspan(size * element.count);
    return first;
  }

  /// For elements with lists, whose rows differ in size. Every row has at least the byte of a list's count, so the
  /// end of the file bounds the walk whatever the header says.
  Status walk_rows(const PlyElement& element, std::vector<ScalarValues>* columns) {
    for (uint64_t row = 0; row < element.count; ++row) {
      for (size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        const bool whole =
            property.list_count ? skip_list(property) : read_value(property.type, columns ? &(*columns)[i] : nullptr);
        if (!whole) return truncated(element);
      }
    }
    return {};
  }

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

  bool read_value(ScalarType type, ScalarValues* into) {
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

/// Walks the data of ascii elements word by word.
class AsciiWalk {
 public:
  explicit AsciiWalk(std::string_view text) : tokens_(text) {}

  Status skip(const PlyElement& element) { return walk_rows(element, nullptr); }

  Result<PointTable> read(const PlyElement& element) {
    std::vector<ScalarValues> columns = empty_columns(element);
    if (Status status = walk_rows(element, &columns); !status) return fail(status.error());
    return table_of(element, std::move(columns));
  }

 private:
  Status walk_rows(const PlyElement& element, std::vector<ScalarValues>* columns) {
    if (element.properties.empty()) return {};
    for (uint64_t row = 0; row < element.count; ++row) {
      for (size_t i = 0; i < element.properties.size(); ++i) {
        if (element.properties[i].list_count ? !skip_list() : !read_value(columns ? &(*columns)[i] : nullptr)) {
          return bad_word(element);
        }
      }
    }
    return {};
  }

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

  bool read_value(ScalarValues* into) {
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

template <typename Walk>
Result<PointTable> read_vertices(const PlyHeader& header, Walk walk) {
  std::optional<PointTable> vertices;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex" && !vertices) {
      Result<PointTable> table = walk.read(element);
      if (!table) return table;
      vertices = std::move(*table);
    } else if (Status status = walk.skip(element); !status) {
      return fail(status.error());
    }
  }
  return std::move(*vertices);
}

Status check_vertices(const PlyHeader& header) {
  const auto vertex = std::find_if(header.elements.begin(), header.elements.end(),
                                   [](const PlyElement& e) { return e.name == "vertex"; });
  if (vertex == header.elements.end()) return fail(ErrorKind::kInvalidInput, "PLY file without vertex elements");
  for (const PlyProperty& property : vertex->properties) {
    if (property.name == "f_dc_0" || property.name == "packed_position") {
      return fail(ErrorKind::kUnsupported, "PLY file of 3D Gaussians, which is not supported");
    }
  }
  if (vertex->count == 0) return fail(ErrorKind::kInvalidInput, "has no points");
  return {};
}

bool has_faces(const PlyHeader& header) {
  return std::any_of(header.elements.begin(), header.elements.end(),
                     [](const PlyElement& e) { return e.name == "face" && e.count > 0; });
}

}  // namespace

Result<ScanPoints> read_ply(std::span<const std::byte> bytes) {
  const Result<PlyHeader> header = parse_ply_header(bytes);
  if (!header) return fail(header.error());
  if (Status status = check_vertices(*header); !status) return fail(status.error());
  const std::span<const std::byte> data = bytes.subspan(header->data_offset);
  const bool big = header->encoding == PlyEncoding::kBinaryBigEndian;
  const Result<PointTable> table =
      header->encoding == PlyEncoding::kAscii
          ? read_vertices(*header, AsciiWalk(as_text(data)))
          : read_vertices(*header, BinaryWalk(data, big != (std::endian::native == std::endian::big)));
  if (!table) return fail(table.error());
  Result<ScanPoints> points = points_from_table(*table);
  // Graphics write meshes, y-up; scanners write points, z-up.
  if (points) points->z_up = !has_faces(*header) || looks_like_survey(*points);
  return points;
}

}  // namespace surfcast
