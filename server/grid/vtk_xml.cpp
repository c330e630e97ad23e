#include "grid/vtk_xml.h"

#include <bit>
#include <utility>
#include <vector>

#include "grid/header_text.h"
#include "grid/number_text.h"
#include "grid/vtk_arrays.h"
#include "grid/vtk_block_stream.h"
#include "grid/vtk_xml_tree.h"
#include "scan/text_tokens.h"
#include "stream/base64_stream.h"

namespace surfcast::grid {
namespace {

using stream::StreamPtr;

constexpr std::string_view kFormat = "VTK";

/// Extents of an image: the first and the last index along each axis.
struct Extent {
  std::array<int64_t, 3> first{};
  std::array<int64_t, 3> last{};

  bool operator==(const Extent&) const = default;
};

Result<Extent> parse_extent(std::string_view text) {
  Extent extent;
  const std::vector<std::string_view> words = words_of(text);
  for (size_t i = 0; i < 6 && words.size() == 6; ++i) {
    const auto index = scan::parse_number<int32_t>(words[i]);
    if (!index) return bad_header(kFormat, "not an extent", text);
    (i % 2 == 0 ? extent.first : extent.last)[i / 2] = *index;
  }
  if (words.size() != 6) return bad_header(kFormat, "not an extent", text);
  for (size_t axis = 0; axis < 3; ++axis) {
    if (extent.last[axis] < extent.first[axis]) return bad_header(kFormat, "an extent without samples", text);
  }
  return extent;
}

Result<std::vector<double>> parse_numbers(std::string_view text, std::vector<double> fallback) {
  if (text.empty()) return fallback;
  auto numbers = numbers_of(text);
  if (!numbers || numbers->size() != fallback.size()) return bad_header(kFormat, "wrong numbers", text);
  return std::move(*numbers);
}

/// The world position of index (0, 0, 0) is the origin; "Direction" is a matrix row by row whose columns are the axes.
Result<glm::dmat4x3> parse_affine(const Attributes& image) {
  const auto origin = parse_numbers(attribute(image, "Origin"), {0, 0, 0});
  const auto spacing = parse_numbers(attribute(image, "Spacing"), {1, 1, 1});
  const auto direction = parse_numbers(attribute(image, "Direction"), {1, 0, 0, 0, 1, 0, 0, 0, 1});
  for (const auto* part : {&origin, &spacing, &direction}) {
    if (!*part) return fail(part->error());
  }
  glm::dmat3 axes(1.0);
  for (int column = 0; column < 3; ++column) {
    const auto at = static_cast<size_t>(column);
    axes[column] = {(*direction)[at], (*direction)[at + 3], (*direction)[at + 6]};
  }
  return affine(axes, {(*spacing)[0], (*spacing)[1], (*spacing)[2]}, {(*origin)[0], (*origin)[1], (*origin)[2]});
}

Result<ScalarType> parse_type(std::string_view text) {
  static constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"Int8", ScalarType::kInt8},       {"UInt8", ScalarType::kUint8},   {"Int16", ScalarType::kInt16},
      {"UInt16", ScalarType::kUint16},   {"Int32", ScalarType::kInt32},   {"UInt32", ScalarType::kUint32},
      {"Int64", ScalarType::kInt64},     {"UInt64", ScalarType::kUint64}, {"Float32", ScalarType::kFloat32},
      {"Float64", ScalarType::kFloat64},
  };
  for (const auto& [known, type] : kTypes) {
    if (known == text) return type;
  }
  return bad_header(kFormat, "type of numbers not supported", text);
}

/// The extent of the one piece.
Result<Extent> find_extent(const XmlImage& image) {
  if (attribute(image.file, "type") != "ImageData") {
    return fail(ErrorKind::kUnsupported, "VTK: not a regular grid: " + scan::printable(attribute(image.file, "type")));
  }
  if (image.pieces.size() != 1) {
    return fail(ErrorKind::kUnsupported,
                "VTK: an image in " + std::to_string(image.pieces.size()) + " pieces; one is read");
  }
  Result<Extent> extent = parse_extent(attribute(image.pieces[0], "Extent"));
  const Result<Extent> whole = parse_extent(attribute(image.image, "WholeExtent"));
  if (!extent || !whole) return fail(extent ? whole.error() : extent.error());
  if (!(*extent == *whole)) return fail(ErrorKind::kUnsupported, "VTK: the piece is a part of the image");
  return extent;
}

std::vector<VtkArray> facts_of(const XmlImage& image) {
  std::vector<VtkArray> facts;
  for (const XmlArray& array : image.arrays) {
    const Attributes& data = array.of_cells ? image.cell_data : image.point_data;
    VtkArray fact;
    fact.name = attribute(array.attributes, "Name");
    fact.of_cells = array.of_cells;
    fact.preferred =
        !fact.name.empty() && (fact.name == attribute(data, "Scalars") || fact.name == attribute(data, "Tensors"));
    const std::string_view components = attribute(array.attributes, "NumberOfComponents");
    fact.components = components.empty() ? 1 : scan::parse_number<uint64_t>(components).value_or(0);
    facts.push_back(std::move(fact));
  }
  return facts;
}

Result<GridHeader> describe(const XmlImage& image, const VtkArray& facts, const XmlArray& array) {
  const Result<Extent> extent = find_extent(image);
  if (!extent) return fail(extent.error());
  Result<glm::dmat4x3> of_points = parse_affine(image.image);
  if (!of_points) return fail(std::move(of_points.error()));
  const Result<ScalarType> type = parse_type(attribute(array.attributes, "type"));
  if (!type) return fail(type.error());
  GridHeader header;
  header.format = kFormat;
  header.name = scan::printable(facts.name);
  header.type = *type;
  header.kind = kind_of(facts).value_or(SampleKind::kScalar);
  std::array<uint64_t, 3> points{};
  for (size_t axis = 0; axis < 3; ++axis) {
    points[axis] = static_cast<uint64_t>(extent->last[axis] - extent->first[axis]) + 1;
    (*of_points)[3] += (*of_points)[static_cast<int>(axis)] * static_cast<double>(extent->first[axis]);
  }
  place_samples(points, *of_points, facts.of_cells, header);
  if (Status status = check_header(header); !status) return fail(std::move(status.error()));
  return header;
}

Result<VtkBlockCoding> parse_coding(const XmlImage& image) {
  VtkBlockCoding coding;
  const std::string_view compressor = attribute(image.file, "compressor");
  coding.compressed = !compressor.empty();
  if (coding.compressed && compressor != "vtkZLibDataCompressor") {
    return fail(ErrorKind::kUnsupported, "VTK: the compression is not supported: " + scan::printable(compressor));
  }
  const std::string_view width = attribute(image.file, "header_type");
  coding.wide = width == "UInt64";
  if (!width.empty() && width != "UInt64" && width != "UInt32") return bad_header(kFormat, "type of headers", width);
  const bool big = attribute(image.file, "byte_order") == "BigEndian";
  coding.swapped = big != (std::endian::native == std::endian::big);
  return coding;
}

/// Where an array is in the file, and how its text or bytes are coded.
struct Place {
  stream::FilePtr file;
  uint64_t begin = 0;
  uint64_t size = 0;
  bool text = false;
  bool base64 = false;
  VtkBlockCoding coding;
  ScalarType type = ScalarType::kUint8;
  uint64_t values = 0;

  [[nodiscard]] Result<StreamPtr> open() const {
    StreamPtr stream = std::make_unique<stream::MappedStream>(file, begin, size);
    if (text) return std::make_unique<NumberText>(std::move(stream), type, values);
    if (base64) stream = std::make_unique<stream::Base64Stream>(std::move(stream));
    return VtkBlockStream::open(std::move(stream), coding);
  }
};

/// Appended data begin behind an underscore; arrays state their offsets from there.
Status find_appended(const XmlImage& image, const XmlArray& array, std::string_view text, Place& place) {
  if (!image.appended) return fail(ErrorKind::kInvalidInput, "truncated: VTK file without its appended data");
  const std::string_view encoding = attribute(*image.appended, "encoding");
  if (encoding != "raw" && encoding != "base64") return bad_header(kFormat, "encoding not supported", encoding);
  const size_t underscore = text.find_first_not_of(" \t\r\n", image.appended_begin);
  if (underscore == std::string_view::npos || text[underscore] != '_') {
    return fail(ErrorKind::kInvalidInput, "VTK: appended data that do not begin with an underscore");
  }
  const auto offset = scan::parse_number<uint64_t>(attribute(array.attributes, "offset"));
  const uint64_t rest = text.size() - underscore - 1;
  if (!offset || *offset > rest) {
    return bad_header(kFormat, "an offset beyond the file", attribute(array.attributes, "offset"));
  }
  place.base64 = encoding == "base64";
  place.begin = underscore + 1 + *offset;
  place.size = rest - *offset;
  // Another array or the end tag follows base64 text.
  if (place.base64) {
    const size_t end =
        text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/= \t\r\n", place.begin);
    place.size = std::min(end, text.size()) - place.begin;
  }
  return {};
}

Result<Place> find_place(const XmlImage& image, const XmlArray& array, const GridFile& file) {
  Place place;
  place.file = file.file;
  const Result<VtkBlockCoding> coding = parse_coding(image);
  if (!coding) return fail(coding.error());
  place.coding = *coding;
  const std::string format = lower_case(attribute(array.attributes, "format"));
  if (format == "appended") {
    if (Status status = find_appended(image, array, file.text(), place); !status) {
      return fail(std::move(status.error()));
    }
    return place;
  }
  if (format != "ascii" && format != "binary") return bad_header(kFormat, "format of an array not supported", format);
  place.text = format == "ascii";
  place.base64 = !place.text;
  place.begin = array.text_begin;
  place.size = array.text_end - array.text_begin;
  return place;
}

}  // namespace

Result<StoredGrid> parse_vtk_xml(const GridFile& file) {
  const Result<XmlImage> image = parse_xml_image(file.text());
  if (!image) return fail(image.error());
  if (const Result<Extent> extent = find_extent(*image); !extent) return fail(extent.error());
  const std::vector<VtkArray> facts = facts_of(*image);
  const Result<size_t> chosen = choose_array(facts, file.array);
  if (!chosen) return fail(chosen.error());
  const XmlArray& array = image->arrays[*chosen];
  Result<GridHeader> header = describe(*image, facts[*chosen], array);
  if (!header) return fail(std::move(header.error()));
  Result<Place> place = find_place(*image, array, file);
  if (!place) return fail(std::move(place.error()));
  place->type = header->type;
  place->values = header->samples() * header->components();
  StoredGrid grid;
  grid.header = std::move(*header);
  grid.swapped = !place->text && place->coding.swapped;
  grid.open = [place = std::move(*place)] { return place.open(); };
  return grid;
}

}  // namespace surfcast::grid
