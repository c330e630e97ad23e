#include <utility>
#include <vector>

#include "grid/header_text.h"
#include "grid/readers.h"
#include "grid/vtk_arrays.h"
#include "grid/vtk_xml_arrays.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

Result<std::vector<double>> parse_numbers(std::string_view text, std::vector<double> fallback) {
  if (text.empty()) return fallback;
  auto numbers = numbers_of(text);
  if (!numbers || numbers->size() != fallback.size()) return bad_header(kVtk, "wrong numbers", text);
  return std::move(*numbers);
}

/// The world position of index (0, 0, 0) is the origin; "Direction" is a matrix row by row whose columns are the axes.
Result<glm::dmat4x3> parse_affine(const Attributes& image) {
  const auto origin = parse_numbers(attribute(image, "Origin"), {0, 0, 0});
  const auto spacing = parse_numbers(attribute(image, "Spacing"), {1, 1, 1});
  const auto direction = parse_numbers(attribute(image, "Direction"), {1, 0, 0, 0, 1, 0, 0, 0, 1});
  for (const auto* part : {&origin, &spacing, &direction}) {
    if (!*part) return fail(*part);
  }
  glm::dmat3 axes(1.0);
  for (int column = 0; column < 3; ++column) {
    const auto at = static_cast<size_t>(column);
    axes[column] = {(*direction)[at], (*direction)[at + 3], (*direction)[at + 6]};
  }
  return affine(axes, {(*spacing)[0], (*spacing)[1], (*spacing)[2]}, {(*origin)[0], (*origin)[1], (*origin)[2]});
}

/// The extent of the one piece.
Result<VtkExtent> find_extent(const XmlFile& image) {
  if (attribute(image.file, "type") != "ImageData") {
    return fail(ErrorKind::kUnsupported, "VTK: not a regular grid: " + scan::printable(attribute(image.file, "type")));
  }
  if (image.pieces.size() != 1) {
    return fail(ErrorKind::kUnsupported,
                "VTK: an image in " + std::to_string(image.pieces.size()) + " pieces; one is read");
  }
  Result<VtkExtent> extent = parse_vtk_extent(attribute(image.pieces[0].attributes, "Extent"));
  const Result<VtkExtent> whole = parse_vtk_extent(attribute(image.data_set, "WholeExtent"));
  if (!extent || !whole) return fail(extent ? whole.error() : extent.error());
  if (!(*extent == *whole)) return fail(ErrorKind::kUnsupported, "VTK: the piece is a part of the image");
  return extent;
}

Result<GridHeader> describe_vtk_xml(const XmlFile& image, const VtkArray& facts, const XmlArray& array) {
  const Result<VtkExtent> extent = find_extent(image);
  if (!extent) return fail(extent);
  Result<glm::dmat4x3> of_points = parse_affine(image.data_set);
  if (!of_points) return fail(of_points);
  const Result<ScalarType> type = xml_type_of(array);
  if (!type) return fail(type);
  GridHeader header;
  header.format = kVtk;
  header.name = scan::printable(facts.name);
  header.type = *type;
  header.kind = kind_of(facts).value_or(SampleKind::kScalar);
  for (size_t axis = 0; axis < 3; ++axis) {
    (*of_points)[3] += (*of_points)[static_cast<int>(axis)] * static_cast<double>(extent->first[axis]);
  }
  place_samples(extent->points(), *of_points, facts.of_cells, header);
  if (Status status = check_header(header); !status) return fail(status);
  return header;
}

}  // namespace

Result<StoredGrid> parse_vtk_xml(const GridFile& file) {
  const Result<XmlFile> image = parse_vtk_xml_tree(file.text());
  if (!image) return fail(image);
  if (const Result<VtkExtent> extent = find_extent(*image); !extent) return fail(extent);
  std::vector<VtkArray> facts;
  for (const XmlArray& array : image->arrays) facts.push_back(facts_of(*image, array));
  const Result<size_t> chosen = choose_array(facts, file.array);
  if (!chosen) return fail(chosen);
  const XmlArray& array = image->arrays[*chosen];
  Result<GridHeader> header = describe_vtk_xml(*image, facts[*chosen], array);
  if (!header) return fail(header);
  Result<StoredNumbers> numbers = find_numbers(*image, array, file.file, header->samples() * header->components());
  if (!numbers) return fail(numbers);
  StoredGrid grid;
  grid.header = std::move(*header);
  grid.swapped = numbers->swapped();
  grid.open = [numbers = std::move(*numbers)] { return numbers.open(); };
  return grid;
}

}  // namespace surfcast::grid
