#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::grid {

/// The lines of a header, without their ends (LF or CR LF).
class HeaderLines {
 public:
  explicit HeaderLines(std::string_view text, size_t from = 0) : text_(text), at_(from) {}
  /// The next line; none at the end. A last line without an end counts.
  std::optional<std::string_view> next();
  /// Of the first byte after the last line returned.
  [[nodiscard]] size_t offset() const { return at_; }

 private:
  std::string_view text_;
  size_t at_;
};

[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text);

/// All words as numbers; none if one is not a number. "nan" is a number.
[[nodiscard]] std::optional<std::vector<double>> numbers_of(std::string_view text);
/// The same for numbers of at least zero.
[[nodiscard]] std::optional<std::vector<uint64_t>> counts_of(std::string_view text);

/// kInvalidInput: "FORMAT header: WHAT: TEXT", the text shortened.
[[nodiscard]] tl::unexpected<Error> bad_header(std::string_view format, std::string_view what, std::string_view text);

}  // namespace surfcast::grid
