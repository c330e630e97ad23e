#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace surfcast::scan {

using Json = nlohmann::json;

/// Members of JSON from a file, whatever their types are. Everything that is not as wanted counts as missing.

/// The member; null JSON if there is none.
[[nodiscard]] const Json& member(const Json& json, const char* name);
/// The element; null JSON if there is none.
[[nodiscard]] const Json& element(const Json& json, uint64_t index);
/// A number that is an integer and not negative.
[[nodiscard]] std::optional<uint64_t> integer_of(const Json& json);
[[nodiscard]] std::optional<uint64_t> integer_of(const Json& json, const char* name);
[[nodiscard]] double number_of(const Json& json, const char* name, double otherwise);
[[nodiscard]] std::string text_of(const Json& json, const char* name);
[[nodiscard]] bool flag_of(const Json& json, const char* name);
/// `count` finite numbers; none if the member is anything else.
[[nodiscard]] std::optional<std::vector<double>> numbers_of(const Json& json, const char* name, size_t count);

}  // namespace surfcast::scan
