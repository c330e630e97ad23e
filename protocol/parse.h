#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace surfcast::protocol {

// Numbers as people write them, read strictly: the whole text or nothing. No leading or trailing blanks, no NaN, no
// infinity, whatever the locale.

std::optional<double> parse_double(std::string_view text);
std::optional<uint32_t> parse_unsigned(std::string_view text);

/// "a,b,c" as exactly `count` numbers.
std::optional<std::vector<double>> parse_doubles(std::string_view text, size_t count);
std::optional<std::vector<uint32_t>> parse_unsigneds(std::string_view text, size_t count);

}  // namespace surfcast::protocol
