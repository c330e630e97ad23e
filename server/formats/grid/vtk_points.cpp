#include "grid/vtk_points.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/ascii_text.h"
#include "grid/header_text.h"
#include "grid/vtk_legacy_file.h"
#include "grid/vtk_point_set.h"
#include "grid/vtk_xml_tree.h"
#include "scan/column_roles.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

using scan::ScalarType;

constexpr size_t kDecodedAtOnce = size_t{1} << 20;  // bytes

/// The numbers of a piece that make some columns: in the file, or decoded.
struct LoadedNumbers {
  const std::byte* first = nullptr;
  bool swapped = false;
};

struct LoadedPiece {
  uint64_t points = 0;
  std::vector<LoadedNumbers> arrays;  ///< positions first
};

/// What is the same in all pieces of an array.
struct ArrayShape {
  ScalarType type = ScalarType::kFloat32;
  uint64_t components = 1;
};

/// Points of pieces, in slices of bounded size.
class VtkPointRows : public scan::RowSource {
 public:
  VtkPointRows(stream::FilePtr file, scan::RowTraits traits, std::vector<scan::ColumnInfo> columns,
               std::vector<ArrayShape> shapes)
      : file_(std::move(file)), traits_(std::move(traits)), columns_(std::move(columns)), shapes_(std::move(shapes)) {}

  void add(LoadedPiece piece) {
    for (uint64_t first = 0; first < piece.points; first += scan::kPieceRows)
      slices_.push_back({pieces_.size(), first});
    pieces_.push_back(std::move(piece));
  }
  /// Keeps decoded numbers.
  const std::byte* keep(std::vector<std::byte> numbers) {
    held_ += numbers.size();
    return decoded_.emplace_back(std::move(numbers)).data();
  }

  [[nodiscard]] const scan::RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<scan::ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return slices_.size(); }
  [[nodiscard]] uint64_t held_bytes() const override { return held_; }

  [[nodiscard]] Result<scan::PointTable> read(size_t slice) const override {
    file_->release_pages();  // of the slices before
    const auto& [number, first] = slices_[slice];
    const LoadedPiece& piece = pieces_[number];
    scan::PointTable table;
    table.rows = std::min(scan::kPieceRows, piece.points - first);
    for (size_t i = 0; i < shapes_.size(); ++i) {
      const size_t width = size_of(shapes_[i].type);
      const size_t stride = shapes_[i].components * width;
      const std::byte* at = piece.arrays[i].first + first * stride;
      for (uint64_t component = 0; component < shapes_[i].components; ++component, at += width) {
        table.columns.push_back({shapes_[i].type, at, stride, piece.arrays[i].swapped});
      }
    }
    return table;
  }

 private:
  struct Slice {
    size_t piece = 0;
    uint64_t first = 0;
  };

  stream::FilePtr file_;
  scan::RowTraits traits_;
  std::vector<scan::ColumnInfo> columns_;
  std::vector<ArrayShape> shapes_;
  std::vector<LoadedPiece> pieces_;
  std::vector<Slice> slices_;
  std::vector<std::vector<std::byte>> decoded_;
  uint64_t held_ = 0;
};

// ---- the arrays that all pieces have

bool is_same(const PointArray& a, const PointArray& b) {
  return a.facts.name == b.facts.name && a.facts.components == b.facts.components && a.numbers.type == b.numbers.type;
}

/// The array of a piece that goes on with that of the first, which is at `index` there. Names may be repeated.
const PointArray* same_array(const PointArray& wanted, size_t index, const PointPiece& piece) {
  if (index < piece.arrays.size() && is_same(piece.arrays[index], wanted)) return &piece.arrays[index];
  const auto found =
      std::ranges::find_if(piece.arrays, [&](const PointArray& array) { return is_same(array, wanted); });
  return found == piece.arrays.end() ? nullptr : &*found;
}

/// Leaves in each piece the arrays that all of them have, in the same order.
void keep_common_arrays(VtkPointSet& set) {
  const std::vector<PointArray> wanted = set.pieces.front().arrays;
  std::vector<bool> common(wanted.size(), true);
  for (const PointPiece& piece : set.pieces) {
    for (size_t i = 0; i < wanted.size(); ++i) common[i] = common[i] && same_array(wanted[i], i, piece) != nullptr;
  }
  for (PointPiece& piece : set.pieces) {
    std::vector<PointArray> kept;
    for (size_t i = 0; i < wanted.size(); ++i) {
      if (common[i]) kept.push_back(*same_array(wanted[i], i, piece));
    }
    for (const PointArray& array : piece.arrays) {
      const bool is_kept = std::ranges::any_of(kept, [&](const PointArray& other) { return is_same(other, array); });
      if (!is_kept) set.left_out.insert(array.facts.name + ", which is not in all pieces");
    }
    piece.arrays = std::move(kept);
  }
}

Result<VtkPointSet> find_points(const stream::FilePtr& file) {
  const bool legacy = is_vtk_legacy_point_set(scan::as_text(file->bytes()));
  Result<VtkPointSet> set = legacy ? find_legacy_points(file) : find_xml_points(file);
  if (!set) return set;
  std::erase_if(set->pieces, [](const PointPiece& piece) { return piece.points == 0; });
  if (set->pieces.empty()) return fail(ErrorKind::kInvalidInput, "VTK: the data set has no points");
  for (const PointPiece& piece : set->pieces) {
    if (!piece.positions.file) return fail(ErrorKind::kInvalidInput, "VTK: points without coordinates");
    if (piece.positions.type != set->pieces.front().positions.type) {
      return fail(ErrorKind::kUnsupported, "VTK: coordinates of several types in one file");
    }
  }
  uint64_t columns = 3;
  for (const PointArray& array : set->pieces.front().arrays) {
    columns = stream::saturating(1, columns, array.facts.components);
  }
  if (Status status = scan::check_column_count(columns); !status) return fail(status);
  keep_common_arrays(*set);
  return set;
}

// ---- columns

bool is_named(const PointArray& array, std::initializer_list<std::string_view> names) {
  return std::ranges::find(names, to_lower(array.facts.name)) != names.end();
}

bool may_be_normals(const PointArray& array) {
  return array.facts.components == 3;
}

bool may_be_colors(const PointArray& array) {
  const bool stated = array.facts.role == VtkRole::kColors;  // of text they are fractions
  const uint64_t components = array.facts.components;
  return (components == 3 || components == 4) && (stated || array.numbers.type == ScalarType::kUint8);
}

/// Of the arrays that suit, the one that the file says is the one, else the one whose name says so.
template <typename Suits, typename Stated, typename Named>
const PointArray* choose(const std::vector<PointArray>& arrays, Suits&& suits, Stated&& stated, Named&& named) {
  const auto find = [&](auto&& chosen) {
    const auto at = std::ranges::find_if(arrays, [&](const PointArray& a) { return suits(a) && chosen(a); });
    return at == arrays.end() ? nullptr : &*at;
  };
  const PointArray* array = find(stated);
  return array != nullptr ? array : find(named);
}

const PointArray* normals_of(const std::vector<PointArray>& arrays) {
  return choose(
      arrays, may_be_normals, [](const PointArray& array) { return array.facts.role == VtkRole::kNormals; },
      [](const PointArray& array) { return is_named(array, {"normals"}); });
}

const PointArray* colors_of(const std::vector<PointArray>& arrays) {
  const auto stated = [](const PointArray& array) {
    return array.facts.role == VtkRole::kColors || array.facts.role == VtkRole::kScalars;
  };
  return choose(arrays, may_be_colors, stated, [](const PointArray& array) {
    return is_named(array, {"rgb", "rgba", "color", "colors"});
  });
}

std::vector<scan::ColumnInfo> columns_of(const PointPiece& piece) {
  std::vector<scan::ColumnInfo> columns;
  for (const char* axis : {"x", "y", "z"}) columns.push_back({axis, piece.positions.type, false});
  const PointArray* normals = normals_of(piece.arrays);
  const PointArray* colors = colors_of(piece.arrays);
  static constexpr std::array kNormals{"nx", "ny", "nz"};
  static constexpr std::array kChannels{"red", "green", "blue", "alpha"};
  for (const PointArray& array : piece.arrays) {
    const std::string name = array.facts.name.empty() ? "values" : array.facts.name;
    for (uint64_t i = 0; i < array.facts.components; ++i) {
      std::string column = array.facts.components == 1 ? name : name + "_" + std::to_string(i);
      if (&array == normals) column = kNormals.at(i);
      if (&array == colors) column = kChannels.at(i);
      columns.push_back({std::move(column), array.numbers.type, false});
    }
  }
  return columns;
}

std::vector<std::string> notes_of(const VtkPointSet& set) {
  constexpr size_t kNamed = 8;
  std::vector<std::string> notes;
  if (set.cells > 0)
    notes.push_back("cells are left out: the points of a VTK file are read, not its triangles or lines");
  std::string names;
  size_t count = 0;
  for (const std::string& array : set.left_out) {
    if (count++ < kNamed) names += (names.empty() ? "" : "; ") + scan::printable(array);
  }
  if (count > kNamed) names += "; and " + std::to_string(count - kNamed) + " more";
  if (count > 0) notes.push_back("arrays are left out: " + names);
  return notes;
}

// ---- numbers

tl::unexpected<Error> in_array(const Error& error, std::string_view name) {
  return fail(error.kind, "VTK: " + scan::printable(name) + ": " + error.message);
}

/// Reads numbers that are not in the file as they are. `left`: memory, which becomes less.
Result<std::vector<std::byte>> decode(const StoredNumbers& numbers, uint64_t& left) {
  const Result<stream::StreamPtr> stream = numbers.open();
  if (!stream) return fail(stream);
  const uint64_t bytes = numbers.bytes();
  if (Status status = check_holds(**stream, bytes); !status) return fail(status);
  if (Status status = scan::DecodingLimit{left}.check(bytes); !status) return fail(status);
  left -= bytes;
  std::vector<std::byte> decoded;
  decoded.reserve(bytes);
  // Part by part: a file may state more than it holds, and only what is written takes memory.
  while (decoded.size() < bytes) {
    const size_t before = decoded.size();
    decoded.resize(std::min<uint64_t>(bytes, before + kDecodedAtOnce));
    Status status = read_exactly(**stream, std::span(decoded).subspan(before));
    if (!status) return fail(status);
  }
  return decoded;
}

Result<LoadedNumbers> load_numbers(const StoredNumbers& numbers, std::string_view name, uint64_t& left,
                                   VtkPointRows& rows) {
  const Result<std::optional<uint64_t>> offset = numbers.in_file();
  if (!offset) return in_array(offset.error(), name);
  if (*offset) return LoadedNumbers{numbers.file->bytes().data() + **offset, numbers.swapped()};
  Result<std::vector<std::byte>> decoded = decode(numbers, left);
  if (!decoded) return in_array(decoded.error(), name);
  return LoadedNumbers{rows.keep(std::move(*decoded)), numbers.swapped()};
}

Status load_piece(const PointPiece& piece, uint64_t& left, VtkPointRows& rows) {
  LoadedPiece loaded{piece.points, {}};
  Result<LoadedNumbers> numbers = load_numbers(piece.positions, "coordinates", left, rows);
  if (!numbers) return fail(numbers);
  loaded.arrays.push_back(*numbers);
  for (const PointArray& array : piece.arrays) {
    numbers = load_numbers(array.numbers, array.facts.name, left, rows);
    if (!numbers) return fail(numbers);
    loaded.arrays.push_back(*numbers);
  }
  rows.add(std::move(loaded));
  return {};
}

}  // namespace

bool is_vtk_point_set(const stream::FilePtr& file) {
  static constexpr std::array<std::string_view, 3> kTypes{"PolyData", "UnstructuredGrid", "StructuredGrid"};
  const std::string_view text = scan::as_text(file->bytes());
  return is_vtk_legacy_point_set(text) || std::ranges::find(kTypes, vtk_xml_type(text)) != kTypes.end();
}

Status check_vtk_points(const stream::FilePtr& file) {
  return find_points(file).map([](const VtkPointSet&) {});
}

Result<std::unique_ptr<scan::RowSource>> vtk_point_rows(const stream::FilePtr& file, const scan::DecodingLimit& limit) {
  const Result<VtkPointSet> set = find_points(file);
  if (!set) return fail(set);
  const PointPiece& first = set->pieces.front();
  std::vector<ArrayShape> shapes{{first.positions.type, 3}};
  for (const PointArray& array : first.arrays) shapes.push_back({array.numbers.type, array.facts.components});
  scan::RowTraits traits;
  traits.notes = notes_of(*set);
  auto rows = std::make_unique<VtkPointRows>(file, std::move(traits), columns_of(first), std::move(shapes));
  uint64_t left = limit.max_bytes;
  for (const PointPiece& piece : set->pieces) {
    if (Status status = load_piece(piece, left, *rows); !status) return fail(status);
  }
  return rows;
}

}  // namespace surfcast::grid
