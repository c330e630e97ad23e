#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"

namespace surfcast::scan {

/// An element of an XML document.
struct XmlNode {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string text;  ///< all text directly within it
  std::vector<XmlNode> children;

  /// The first child of that name; none without.
  [[nodiscard]] const XmlNode* child(std::string_view name) const;
  /// The value of an attribute; none without.
  [[nodiscard]] const std::string* attribute(std::string_view name) const;
};

/// Parses a document into its root element. Fails for text that is not well formed, has entities of its own, or has
/// elements nested more than 64 deep.
Result<XmlNode> parse_xml(std::string_view text);

}  // namespace surfcast::scan
