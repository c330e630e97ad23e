#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace surfcast::access {

/// Between the names of models that are shown together.
inline constexpr char kJoin = '+';

/// The names of the models that "a+b+c" joins; none if this is the name of one model alone.
[[nodiscard]] std::vector<std::string> members_of(std::string_view name);

}  // namespace surfcast::access
