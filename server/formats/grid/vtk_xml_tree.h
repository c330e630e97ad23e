#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::grid {

using Attributes = std::map<std::string, std::string, std::less<>>;

/// The attribute, or an empty text.
[[nodiscard]] std::string_view attribute(const Attributes& attributes, std::string_view name);

/// The elements of a piece that have arrays for its points or cells.
enum class XmlSection { kPoints, kPointData, kCellData };

struct XmlArray {
  Attributes attributes;
  XmlSection section = XmlSection::kPointData;
  size_t piece = 0;
  uint64_t text_begin = 0;  ///< of its text in the file, for arrays that are not appended
  uint64_t text_end = 0;
};

struct XmlPiece {
  Attributes attributes;
  Attributes point_data;
  Attributes cell_data;
};

/// The elements of a VTK file.
struct XmlFile {
  Attributes file;      ///< of VTKFile
  Attributes data_set;  ///< of the element that has the type of the file as its name: ImageData, for example
  std::vector<XmlPiece> pieces;
  std::vector<XmlArray> arrays;  ///< of the sections above, in the order of the file
  std::optional<Attributes> appended;
  uint64_t appended_begin = 0;  ///< behind the tag AppendedData and its underscore
  uint64_t appended_end = 0;    ///< of base64 text, or of the file
  bool appended_base64 = false;
};

/// Parses the elements of the file up to appended data, which need not be XML. Document types are refused, and so are
/// appended data that are neither raw nor base64.
Result<XmlFile> parse_vtk_xml_tree(std::string_view text);

/// The type of data set that the first bytes of a file state; empty if they are not those of VTK's XML.
[[nodiscard]] std::string vtk_xml_type(std::string_view text);

}  // namespace surfcast::grid
