#include "base/json_text.h"

#include <nlohmann/json.hpp>

namespace surfcast {
namespace {

template <typename Json>
std::string text_of(const Json& document, int indent) {
  return document.dump(indent, ' ', /*ensure_ascii=*/false, Json::error_handler_t::replace);
}

}  // namespace

nlohmann::json parse_json_text(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
}

nlohmann::ordered_json parse_ordered_json_text(std::string_view text) {
  return nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
}

std::string json_text(const nlohmann::json& document, int indent) {
  return text_of(document, indent);
}

std::string json_text(const nlohmann::ordered_json& document, int indent) {
  return text_of(document, indent);
}

}  // namespace surfcast
