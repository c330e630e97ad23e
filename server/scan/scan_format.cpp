#include "scan/scan_format.h"

#include <optional>
#include <string_view>

#include "scan/text_tokens.h"

namespace surfcast {
namespace {

/// A word at the start of the file, followed by the end of its line.
bool first_line_is(std::string_view text, std::string_view word) {
  return text.starts_with(word) && text.size() > word.size() && is_space(text[word.size()]);
}

std::optional<ScanFormat> by_content(std::string_view text) {
  if (first_line_is(text, "ply")) return ScanFormat::kPly;
  if (text.starts_with("LASF")) return ScanFormat::kLas;
  return std::nullopt;
}

}  // namespace

Result<ScanFormat> scan_format_of(std::span<const std::byte> bytes, const std::filesystem::path&) {
  if (bytes.empty()) return fail(ErrorKind::kInvalidInput, "the file is empty");
  if (const auto format = by_content(as_text(bytes))) return *format;
  return fail(ErrorKind::kUnsupported, "not a scan of a supported format");
}

}  // namespace surfcast
