#include "grid/header_text.h"

#include <algorithm>

#include "base/ascii_text.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

template <typename T>
std::optional<std::vector<T>> parse_all(std::string_view text) {
  std::vector<T> values;
  scan::Tokens tokens(text);
  for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next()) {
    const std::optional<T> value = scan::parse_number<T>(word);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

}  // namespace

std::optional<std::string_view> HeaderLines::next() {
  if (at_ >= text_.size()) return std::nullopt;
  const size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view line = text_.substr(at_, end - at_);
  at_ = std::min(end + 1, text_.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  scan::Tokens tokens(text);
  for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next()) words.push_back(word);
  return words;
}

std::optional<std::vector<double>> numbers_of(std::string_view text) {
  return parse_all<double>(text);
}

std::optional<std::vector<uint64_t>> counts_of(std::string_view text) {
  return parse_all<uint64_t>(text);
}

tl::unexpected<Error> bad_header(std::string_view format, std::string_view what, std::string_view text) {
  return fail(ErrorKind::kInvalidInput,
              std::string(format) + " header: " + std::string(what) + ": " + scan::printable(trimmed(text)));
}

}  // namespace surfcast::grid
