#include "grid/vtk_xml_arrays.h"

#include <bit>
#include <string>
#include <utility>
#include <vector>

#include "base/ascii_text.h"
#include "grid/header_text.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

Result<VtkBlockCoding> parse_coding(const XmlFile& file) {
  VtkBlockCoding coding;
  const std::string_view compressor = attribute(file.file, "compressor");
  coding.compressed = !compressor.empty();
  if (coding.compressed && compressor != "vtkZLibDataCompressor") {
    return fail(ErrorKind::kUnsupported, "VTK: the compression is not supported: " + scan::printable(compressor));
  }
  const std::string_view width = attribute(file.file, "header_type");
  coding.wide = width == "UInt64";
  if (!width.empty() && width != "UInt64" && width != "UInt32") return bad_header(kVtk, "type of headers", width);
  const bool big = attribute(file.file, "byte_order") == "BigEndian";
  coding.swapped = big != (std::endian::native == std::endian::big);
  return coding;
}

Status find_appended(const XmlFile& file, const XmlArray& array, StoredNumbers& numbers) {
  if (!file.appended) return fail(ErrorKind::kInvalidInput, "truncated: VTK file without its appended data");
  const std::string_view text = attribute(array.attributes, "offset");
  const auto offset = scan::parse_number<uint64_t>(text);
  const uint64_t rest = file.appended_end - file.appended_begin;
  if (!offset || *offset > rest) return bad_header(kVtk, "an offset beyond the file", text);
  numbers.base64 = file.appended_base64;
  numbers.begin = file.appended_begin + *offset;
  numbers.size = rest - *offset;
  return {};
}

}  // namespace

std::array<uint64_t, 3> VtkExtent::points() const {
  std::array<uint64_t, 3> points{};
  for (size_t axis = 0; axis < 3; ++axis) points[axis] = static_cast<uint64_t>(last[axis] - first[axis]) + 1;
  return points;
}

Result<VtkExtent> parse_vtk_extent(std::string_view text) {
  VtkExtent extent;
  const std::vector<std::string_view> words = words_of(text);
  for (size_t i = 0; i < 6 && words.size() == 6; ++i) {
    const auto index = scan::parse_number<int32_t>(words[i]);
    if (!index) return bad_header(kVtk, "not an extent", text);
    (i % 2 == 0 ? extent.first : extent.last)[i / 2] = *index;
  }
  if (words.size() != 6) return bad_header(kVtk, "not an extent", text);
  for (size_t axis = 0; axis < 3; ++axis) {
    if (extent.last[axis] < extent.first[axis]) return bad_header(kVtk, "an extent without samples", text);
  }
  return extent;
}

VtkArray facts_of(const XmlFile& file, const XmlArray& array) {
  const XmlPiece& piece = file.pieces[array.piece];
  VtkArray facts;
  facts.name = attribute(array.attributes, "Name");
  facts.of_cells = array.section == XmlSection::kCellData;
  const Attributes& data = facts.of_cells ? piece.cell_data : piece.point_data;
  const auto is_active = [&](std::string_view role) {
    return !facts.name.empty() && facts.name == attribute(data, role);
  };
  if (is_active("Tensors")) facts.role = VtkRole::kTensors;
  if (is_active("Normals")) facts.role = VtkRole::kNormals;
  if (is_active("Scalars")) facts.role = VtkRole::kScalars;
  facts.preferred = is_active("Scalars") || is_active("Tensors");
  const std::string_view components = attribute(array.attributes, "NumberOfComponents");
  facts.components = components.empty() ? 1 : scan::parse_number<uint64_t>(components).value_or(0);
  return facts;
}

Result<scan::ScalarType> xml_type_of(const XmlArray& array) {
  using scan::ScalarType;
  const std::string_view text = attribute(array.attributes, "type");
  static constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"Int8", ScalarType::kInt8},       {"UInt8", ScalarType::kUint8},   {"Int16", ScalarType::kInt16},
      {"UInt16", ScalarType::kUint16},   {"Int32", ScalarType::kInt32},   {"UInt32", ScalarType::kUint32},
      {"Int64", ScalarType::kInt64},     {"UInt64", ScalarType::kUint64}, {"Float32", ScalarType::kFloat32},
      {"Float64", ScalarType::kFloat64},
  };
  for (const auto& [known, type] : kTypes) {
    if (known == text) return type;
  }
  return bad_header(kVtk, "type of numbers not supported", text);
}

Result<StoredNumbers> find_numbers(const XmlFile& file, const XmlArray& array, const stream::FilePtr& source,
                                   uint64_t values) {
  const Result<scan::ScalarType> type = xml_type_of(array);
  if (!type) return fail(type);
  StoredNumbers numbers;
  numbers.file = source;
  numbers.type = *type;
  numbers.values = values;
  numbers.begin = array.text_begin;
  numbers.size = array.text_end - array.text_begin;
  const std::string format = to_lower(attribute(array.attributes, "format"));
  numbers.text = format == "ascii";
  if (numbers.text) return numbers;  // the coding is that of bytes
  const Result<VtkBlockCoding> coding = parse_coding(file);
  if (!coding) return fail(coding);
  numbers.coding = *coding;
  if (format == "appended") {
    if (Status status = find_appended(file, array, numbers); !status) return fail(status);
    return numbers;
  }
  if (format != "binary") return bad_header(kVtk, "format of an array not supported", format);
  numbers.base64 = true;
  return numbers;
}

}  // namespace surfcast::grid
