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

struct XmlArray {
  Attributes attributes;
  bool of_cells = false;
  uint64_t text_begin = 0;  ///< of its text in the file, for arrays that are not appended
  uint64_t text_end = 0;
};

/// The elements of a VTK file with image data.
struct XmlImage {
  Attributes file;   ///< of VTKFile
  Attributes image;  ///< of ImageData
  std::vector<Attributes> pieces;
  Attributes point_data;
  Attributes cell_data;
  std::vector<XmlArray> arrays;
  std::optional<Attributes> appended;
  uint64_t appended_begin = 0;  ///< behind the tag AppendedData
};

/// Parses the elements of the file up to appended data, which need not be XML. Document types are refused.
Result<XmlImage> parse_xml_image(std::string_view text);

}  // namespace surfcast::grid
