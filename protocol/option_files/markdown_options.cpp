#include "protocol/option_files/option_texts.h"

namespace surfcast::protocol {
namespace {

constexpr std::string_view kBegin = "<!-- The options, by `option_files document`. -->\n";
constexpr std::string_view kEnd = "<!-- End of the options. -->\n";

/// Bars end the cells of a table, in code, too.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

}  // namespace

std::string markdown_options() {
  std::string text = "| flag | field of the message | meaning |\n|---|---|---|\n";
  for (const PictureField& field : picture_fields()) {
    text.append("| `--").append(field.flag).append(" ").append(cell(field.form)).append("` | `");
    text.append(field.value.place).append("` | ").append(cell(field.help)).append(" |\n");
  }
  return text;
}

Result<std::string> with_options(const std::string& document) {
  const size_t begin = document.find(kBegin);
  const size_t end = document.find(kEnd, begin == std::string::npos ? 0 : begin);
  if (begin == std::string::npos || end == std::string::npos) {
    return fail(ErrorKind::kInvalidInput, "the lines that mark the place of the options are missing");
  }
  const size_t place = begin + kBegin.size();
  return document.substr(0, place) + "\n" + markdown_options() + "\n" + document.substr(end);
}

}  // namespace surfcast::protocol
