#include "grid/vtk_point_set.h"

#include <array>
#include <bit>
#include <string_view>
#include <utility>

#include "grid/header_text.h"
#include "grid/vtk_legacy_file.h"
#include "grid/vtk_xml_arrays.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

// ---- the legacy format

/// Numbers in the body of a legacy file: words, or big endian bytes without a header.
StoredNumbers legacy_numbers(const stream::FilePtr& file, bool binary, const VtkNumbers& numbers) {
  StoredNumbers stored;
  stored.file = file;
  stored.begin = numbers.offset;
  stored.size = file->bytes().size() - numbers.offset;
  stored.text = !binary;
  stored.headed = false;
  stored.coding.swapped = std::endian::native == std::endian::little;
  stored.type = numbers.type;
  stored.values = numbers.count;
  return stored;
}

// ---- the XML format

uint64_t count_of(const Attributes& attributes, std::string_view name) {
  return scan::parse_number<uint64_t>(attribute(attributes, name)).value_or(0);
}

uint64_t cells_of(const Attributes& piece) {
  uint64_t cells = 0;
  for (const char* kind : {"NumberOfCells", "NumberOfLines", "NumberOfStrips", "NumberOfPolys"}) {
    cells = stream::saturating(1, cells, count_of(piece, kind));
  }
  return cells;
}

/// A structured grid states the indices of its points.
Result<uint64_t> points_of_piece(const XmlFile& file, const Attributes& piece) {
  if (attribute(file.file, "type") != "StructuredGrid") {
    const std::string_view text = attribute(piece, "NumberOfPoints");
    const auto points = scan::parse_number<uint64_t>(text);
    if (!points) return bad_header("VTK", "no number of points in a piece", text);
    return *points;
  }
  const Result<VtkExtent> extent = parse_vtk_extent(attribute(piece, "Extent"));
  if (!extent) return fail(extent);
  const std::array<uint64_t, 3> points = extent->points();
  return stream::saturating(stream::saturating(points[0], points[1], 0), points[2], 0);
}

/// Puts an array into its piece. Those of other types than numbers are left out.
Status add_array(const XmlFile& file, const XmlArray& array, const stream::FilePtr& source, PointPiece& piece,
                 VtkPointSet& set) {
  VtkArray facts = facts_of(file, array);
  if (array.section == XmlSection::kPointData && !xml_type_of(array)) {
    set.left_out.insert(facts.name + " of type " + std::string(attribute(array.attributes, "type")));
    return {};
  }
  if (facts.components == 0) {
    return fail(ErrorKind::kInvalidInput, "VTK: the array " + scan::printable(facts.name) + " has no components");
  }
  const bool positions = array.section == XmlSection::kPoints;
  if (positions && facts.components != 3)
    return fail(ErrorKind::kInvalidInput, "VTK: points without three coordinates");
  const uint64_t values = stream::saturating(piece.points, facts.components, 0);
  Result<StoredNumbers> numbers = find_numbers(file, array, source, values);
  if (!numbers) {
    if (numbers.error().kind == ErrorKind::kUnsupported) return fail(numbers);  // the coding of all arrays
    return fail(numbers.error().kind, numbers.error().message + ", in the array " + scan::printable(facts.name));
  }
  if (positions) {
    piece.positions = std::move(*numbers);
  } else {
    piece.arrays.push_back({std::move(facts), std::move(*numbers)});
  }
  return {};
}

}  // namespace

Result<VtkPointSet> find_legacy_points(const stream::FilePtr& file) {
  const Result<LegacyFile> legacy = scan_vtk_legacy(scan::as_text(file->bytes()), kVtkPointSets);
  if (!legacy) return fail(legacy);
  VtkPointSet set;
  set.cells = legacy->cells;
  PointPiece piece;
  piece.points = legacy->points.count / 3;
  piece.positions = legacy_numbers(file, legacy->binary, legacy->points);
  for (const LegacyArray& array : legacy->arrays) {
    if (array.facts.of_cells) {
      set.left_out.insert(array.facts.name + " of the cells");
      continue;
    }
    if (array.tuples != piece.points) {
      return fail(ErrorKind::kInvalidInput, "VTK: the array " + scan::printable(array.facts.name) + " has " +
                                                std::to_string(array.tuples) + " values for " +
                                                std::to_string(piece.points) + " points");
    }
    piece.arrays.push_back({array.facts, legacy_numbers(file, legacy->binary, array.numbers)});
  }
  set.pieces.push_back(std::move(piece));
  return set;
}

Result<VtkPointSet> find_xml_points(const stream::FilePtr& file) {
  const Result<XmlFile> tree = parse_vtk_xml_tree(scan::as_text(file->bytes()));
  if (!tree) return fail(tree);
  VtkPointSet set;
  for (const XmlPiece& piece : tree->pieces) {
    const Result<uint64_t> points = points_of_piece(*tree, piece.attributes);
    if (!points) return fail(points);
    set.cells = stream::saturating(1, set.cells, cells_of(piece.attributes));
    set.pieces.push_back({*points, {}, {}});
  }
  for (const XmlArray& array : tree->arrays) {
    PointPiece& piece = set.pieces[array.piece];
    if (array.section == XmlSection::kCellData) {
      set.left_out.insert(facts_of(*tree, array).name + " of the cells");
    } else if (piece.points > 0) {  // writers leave the arrays of empty pieces empty
      if (Status status = add_array(*tree, array, file, piece, set); !status) return fail(status);
    }
  }
  return set;
}

}  // namespace surfcast::grid
