#include "grid/vtk_xml_tree.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include <expat.h>

#include "base/contract.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

using ParserPtr = std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)>;

/// Parts of the file that are given to expat, bytes.
constexpr size_t kPart = size_t{1} << 20;

class ImageParser {
 public:
  explicit ImageParser(std::string_view text) : text_(text), parser_(XML_ParserCreate(nullptr), XML_ParserFree) {
    SURFCAST_EXPECTS(parser_ != nullptr);
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const XML_Char* name, const XML_Char** attributes) {
          static_cast<ImageParser*>(self)->start(name, attributes);
        },
        [](void* self, const XML_Char* name) { static_cast<ImageParser*>(self)->end(name); });
    XML_SetStartDoctypeDeclHandler(parser_.get(), [](void* self, const XML_Char*, const XML_Char*, const XML_Char*,
                                                     int) { static_cast<ImageParser*>(self)->refuse_document_type(); });
  }

  Result<XmlImage> parse() {
    for (size_t at = 0; at < text_.size() && !stopped_; at += kPart) {
      const std::string_view part = text_.substr(at, kPart);
      const bool last = at + part.size() == text_.size();
      const XML_Status status = XML_Parse(parser_.get(), part.data(), static_cast<int>(part.size()), last ? 1 : 0);
      if (status != XML_STATUS_OK && !stopped_) return syntax_error();
    }
    if (has_document_type_) return fail(ErrorKind::kInvalidInput, "VTK: XML with a document type");
    return std::move(image_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> syntax_error() const {
    return fail(ErrorKind::kInvalidInput, std::string("damaged XML: ") +
                                              XML_ErrorString(XML_GetErrorCode(parser_.get())) + " in line " +
                                              std::to_string(XML_GetCurrentLineNumber(parser_.get())));
  }

  void stop() {
    stopped_ = true;
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  void refuse_document_type() {
    has_document_type_ = true;
    stop();
  }

  [[nodiscard]] uint64_t tag_begin() const { return static_cast<uint64_t>(XML_GetCurrentByteIndex(parser_.get())); }
  [[nodiscard]] uint64_t tag_end() const {
    return tag_begin() + static_cast<uint64_t>(XML_GetCurrentByteCount(parser_.get()));
  }

  void start(std::string_view name, const XML_Char** list) {
    if (array_depth_ > 0) return enter_child();
    Attributes attributes;
    for (; *list != nullptr; list += 2) attributes[list[0]] = list[1];
    if (name == "VTKFile")
      image_.file = std::move(attributes);
    else if (name == "ImageData")
      image_.image = std::move(attributes);
    else if (name == "Piece")
      image_.pieces.push_back(std::move(attributes));
    else if (name == "PointData")
      begin_data(image_.point_data, std::move(attributes), false);
    else if (name == "CellData")
      begin_data(image_.cell_data, std::move(attributes), true);
    else if (name == "DataArray" && in_data_)
      begin_array(std::move(attributes));
    else if (name == "AppendedData")
      end_at_appended(std::move(attributes));
  }

  void begin_data(Attributes& into, Attributes attributes, bool of_cells) {
    into = std::move(attributes);
    in_data_ = true;
    of_cells_ = of_cells;
  }

  void begin_array(Attributes attributes) {
    image_.arrays.push_back({std::move(attributes), of_cells_, tag_end(), tag_end()});
    array_depth_ = 1;
    has_text_ = false;
  }

  /// An array may have children (InformationKey) before or behind its text.
  void enter_child() {
    if (array_depth_ == 1) take_text();
    ++array_depth_;
  }

  /// Takes the text since the last tag as that of the array, unless it is blank or the text was found before.
  void take_text() {
    XmlArray& array = image_.arrays.back();
    if (has_text_) return;
    const std::string_view text = text_.substr(array.text_begin, tag_begin() - array.text_begin);
    has_text_ = !std::all_of(text.begin(), text.end(), scan::is_space);
    array.text_end = tag_begin();
  }

  void end(std::string_view name) {
    if (array_depth_ > 1 && --array_depth_ == 1 && !has_text_)
      image_.arrays.back().text_begin = tag_end();
    else if (array_depth_ == 1 && name == "DataArray")
      end_array();
    if (name == "PointData" || name == "CellData") in_data_ = false;
  }

  /// The end of an empty element <DataArray/> is where it begins.
  void end_array() {
    XmlArray& array = image_.arrays.back();
    if (tag_begin() >= array.text_begin) take_text();
    array.text_end = std::max(array.text_begin, array.text_end);
    array_depth_ = 0;
  }

  void end_at_appended(Attributes attributes) {
    image_.appended = std::move(attributes);
    image_.appended_begin = tag_end();
    stop();
  }

  std::string_view text_;
  ParserPtr parser_;
  XmlImage image_;
  bool stopped_ = false;
  bool has_document_type_ = false;
  bool in_data_ = false;
  bool of_cells_ = false;
  bool has_text_ = false;
  int array_depth_ = 0;
};

}  // namespace

std::string_view attribute(const Attributes& attributes, std::string_view name) {
  const auto at = attributes.find(name);
  return at == attributes.end() ? std::string_view() : std::string_view(at->second);
}

Result<XmlImage> parse_xml_image(std::string_view text) {
  return ImageParser(text).parse();
}

}  // namespace surfcast::grid
