#include "grid/vtk_xml_tree.h"

#include <algorithm>
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

class TreeParser {
 public:
  /// `head_alone`: nothing behind the tag VTKFile is parsed.
  explicit TreeParser(std::string_view text, bool head_alone = false)
      : text_(text), head_alone_(head_alone), parser_(XML_ParserCreate(nullptr), XML_ParserFree) {
    SURFCAST_EXPECTS(parser_ != nullptr);
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const XML_Char* name, const XML_Char** attributes) {
          static_cast<TreeParser*>(self)->start(name, attributes);
        },
        [](void* self, const XML_Char* name) { static_cast<TreeParser*>(self)->end(name); });
    XML_SetStartDoctypeDeclHandler(parser_.get(), [](void* self, const XML_Char*, const XML_Char*, const XML_Char*,
                                                     int) { static_cast<TreeParser*>(self)->refuse_document_type(); });
  }

  Result<XmlFile> parse() {
    for (size_t at = 0; at < text_.size() && !stopped_; at += kPart) {
      const std::string_view part = text_.substr(at, kPart);
      const bool last = at + part.size() == text_.size();
      const XML_Status status = XML_Parse(parser_.get(), part.data(), static_cast<int>(part.size()), last ? 1 : 0);
      if (status != XML_STATUS_OK && !stopped_) return syntax_error();
    }
    if (has_document_type_) return fail(ErrorKind::kInvalidInput, "VTK: XML with a document type");
    if (file_.appended) {
      if (Status status = find_appended(); !status) return fail(status);
    }
    return std::move(file_);
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
      begin_file(std::move(attributes));
    else if (!file_.file.empty() && name == attribute(file_.file, "type"))
      file_.data_set = std::move(attributes);
    else if (name == "Piece")
      file_.pieces.push_back({std::move(attributes), {}, {}});
    else if (name == "AppendedData")
      end_at_appended(std::move(attributes));
    else if (!file_.pieces.empty())
      start_in_piece(name, std::move(attributes));
  }

  void begin_file(Attributes attributes) {
    file_.file = std::move(attributes);
    if (head_alone_) stop();
  }

  void start_in_piece(std::string_view name, Attributes attributes) {
    XmlPiece& piece = file_.pieces.back();
    if (name == "DataArray") {
      if (section_) begin_array(std::move(attributes));
    } else if (name == "Points") {
      section_ = XmlSection::kPoints;
    } else if (name == "PointData") {
      piece.point_data = std::move(attributes);
      section_ = XmlSection::kPointData;
    } else if (name == "CellData") {
      piece.cell_data = std::move(attributes);
      section_ = XmlSection::kCellData;
    }
  }

  void begin_array(Attributes attributes) {
    file_.arrays.push_back({std::move(attributes), *section_, file_.pieces.size() - 1, tag_end(), tag_end()});
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
    XmlArray& array = file_.arrays.back();
    if (has_text_) return;
    const std::string_view text = text_.substr(array.text_begin, tag_begin() - array.text_begin);
    has_text_ = !std::all_of(text.begin(), text.end(), scan::is_space);
    array.text_end = tag_begin();
  }

  void end(std::string_view name) {
    if (array_depth_ > 1 && --array_depth_ == 1 && !has_text_)
      file_.arrays.back().text_begin = tag_end();
    else if (array_depth_ == 1 && name == "DataArray")
      end_array();
    if (name == "PointData" || name == "CellData" || name == "Points") section_.reset();
  }

  /// The end of an empty element <DataArray/> is where it begins.
  void end_array() {
    XmlArray& array = file_.arrays.back();
    if (tag_begin() >= array.text_begin) take_text();
    array.text_end = std::max(array.text_begin, array.text_end);
    array_depth_ = 0;
  }

  void end_at_appended(Attributes attributes) {
    file_.appended = std::move(attributes);
    file_.appended_begin = tag_end();
    stop();
  }

  /// Appended data begin behind an underscore. Behind base64 text is the end tag.
  Status find_appended() {
    const std::string_view encoding = attribute(*file_.appended, "encoding");
    file_.appended_base64 = encoding == "base64";
    if (!file_.appended_base64 && encoding != "raw") {
      return fail(ErrorKind::kInvalidInput,
                  "VTK: encoding of appended data not supported: " + scan::printable(encoding));
    }
    const size_t underscore = text_.find_first_not_of(" \t\r\n", file_.appended_begin);
    if (underscore == std::string_view::npos || text_[underscore] != '_') {
      return fail(ErrorKind::kInvalidInput, "VTK: appended data that do not begin with an underscore");
    }
    file_.appended_begin = underscore + 1;
    file_.appended_end = file_.appended_base64 ? text_.find('<', underscore) : text_.size();
    file_.appended_end = std::min(file_.appended_end, text_.size());
    return {};
  }

  std::string_view text_;
  bool head_alone_;
  ParserPtr parser_;
  XmlFile file_;
  bool stopped_ = false;
  bool has_document_type_ = false;
  std::optional<XmlSection> section_;
  bool has_text_ = false;
  int array_depth_ = 0;
};

}  // namespace

std::string_view attribute(const Attributes& attributes, std::string_view name) {
  const auto at = attributes.find(name);
  return at == attributes.end() ? std::string_view() : std::string_view(at->second);
}

Result<XmlFile> parse_vtk_xml_tree(std::string_view text) {
  return TreeParser(text).parse();
}

std::string vtk_xml_type(std::string_view text) {
  const std::string_view head = text.substr(0, 4096);
  if (head.find("<VTKFile") == std::string_view::npos) return {};
  const Result<XmlFile> file = TreeParser(head, true).parse();
  return file ? std::string(attribute(file->file, "type")) : std::string();
}

}  // namespace surfcast::grid
