#include "grid/nrrd_text.h"

#include <optional>

#include "base/ascii_text.h"
#include "grid/header_text.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

std::string field_name(std::string_view text) {
  std::string name;
  for (const char c : to_lower(text)) {
    if (!scan::is_space(c)) name += c;
  }
  if (name == "centerings") name = "centers";
  return name;
}

}  // namespace

// Lines after "data file: LIST" are names of files.
Result<NrrdText> split_nrrd(std::string_view text) {
  HeaderLines lines(text);
  lines.next();  // "NRRD000N"
  NrrdText header;
  bool list = false;
  std::optional<std::string_view> line = lines.next();
  for (; line && !line->empty(); line = lines.next()) {
    if (list) {
      header.files.emplace_back(trimmed(*line));
      continue;
    }
    const size_t colon = line->find(':');
    if (line->starts_with('#') || line->substr(colon == std::string_view::npos ? 0 : colon).starts_with(":=")) continue;
    if (colon == std::string_view::npos) return bad_header(kNrrd, "line not understood", *line);
    const std::string name = field_name(line->substr(0, colon));
    header.fields[name] = trimmed(line->substr(colon + 1));
    list = name == "datafile" && header.fields[name].starts_with("LIST");
  }
  header.attached = !header.fields.contains("datafile");
  header.data_offset = lines.offset();
  if (header.attached && !line) return fail(ErrorKind::kInvalidInput, "truncated: NRRD header without an end");
  return header;
}

std::string_view field(const NrrdFields& fields, std::string_view name) {
  const auto at = fields.find(name);
  return at == fields.end() ? std::string_view() : std::string_view(at->second);
}

}  // namespace surfcast::grid
