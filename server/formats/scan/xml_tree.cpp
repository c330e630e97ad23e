#include "scan/xml_tree.h"

#include <algorithm>
#include <limits>
#include <memory>

#include <expat.h>

namespace surfcast::scan {
namespace {

constexpr size_t kDeepestElement = 64;

struct TreeBuilder {
  XML_Parser parser = nullptr;
  XmlNode document;  ///< its only child is the root
  std::vector<XmlNode*> open{&document};
  const char* fault = nullptr;

  void stop(const char* what) {
    fault = what;
    XML_StopParser(parser, XML_FALSE);
  }
};

void XMLCALL start_element(void* data, const XML_Char* name, const XML_Char** attributes) {
  auto& builder = *static_cast<TreeBuilder*>(data);
  if (builder.open.size() > kDeepestElement) return builder.stop("its elements are nested too deeply");
  // The parents of an element get no other child before it is closed, so that pointers to them stay valid.
  XmlNode& node = builder.open.back()->children.emplace_back();
  node.name = name;
  for (; *attributes != nullptr; attributes += 2) node.attributes.emplace_back(attributes[0], attributes[1]);
  builder.open.push_back(&node);
}

void XMLCALL end_element(void* data, const XML_Char* /*name*/) {
  static_cast<TreeBuilder*>(data)->open.pop_back();
}

void XMLCALL add_text(void* data, const XML_Char* text, int length) {
  static_cast<TreeBuilder*>(data)->open.back()->text.append(text, static_cast<size_t>(length));
}

void XMLCALL refuse_entity(void* data, const XML_Char* /*name*/, int /*parameter*/, const XML_Char* /*value*/,
                           int /*length*/, const XML_Char* /*base*/, const XML_Char* /*system*/,
                           const XML_Char* /*public*/, const XML_Char* /*notation*/) {
  static_cast<TreeBuilder*>(data)->stop("it declares entities");
}

}  // namespace

const XmlNode* XmlNode::child(std::string_view wanted) const {
  const auto found =
      std::find_if(children.begin(), children.end(), [wanted](const XmlNode& node) { return node.name == wanted; });
  return found == children.end() ? nullptr : &*found;
}

const std::string* XmlNode::attribute(std::string_view wanted) const {
  const auto found =
      std::find_if(attributes.begin(), attributes.end(), [wanted](const auto& entry) { return entry.first == wanted; });
  return found == attributes.end() ? nullptr : &found->second;
}

Result<XmlNode> parse_xml(std::string_view text) {
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr), XML_ParserFree);
  if (!parser) return fail(ErrorKind::kUnavailable, "no memory for XML");
  if (text.size() > static_cast<size_t>(std::numeric_limits<int>::max())) {
    return fail(ErrorKind::kLimit, "has more than 2 GiB of XML");
  }
  TreeBuilder builder;
  builder.parser = parser.get();
  XML_SetUserData(parser.get(), &builder);
  XML_SetElementHandler(parser.get(), start_element, end_element);
  XML_SetCharacterDataHandler(parser.get(), add_text);
  XML_SetEntityDeclHandler(parser.get(), refuse_entity);
  if (XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), 1) != XML_STATUS_OK) {
    const char* fault = builder.fault != nullptr ? builder.fault : XML_ErrorString(XML_GetErrorCode(parser.get()));
    return fail(ErrorKind::kInvalidInput,
                "XML is damaged in line " + std::to_string(XML_GetCurrentLineNumber(parser.get())) + ": " + fault);
  }
  return std::move(builder.document.children.front());
}

}  // namespace surfcast::scan
