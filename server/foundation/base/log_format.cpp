#include "base/log_format.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>

#include <spdlog/formatter.h>
#include <spdlog/spdlog.h>

namespace surfcast {
namespace {

constexpr uint32_t kReplacement = 0xfffd;

/// The first character of `text`, which is taken off it (Unicode 15, table
/// 3-7).
uint32_t take_character(std::string_view& text) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  const uint8_t first = byte(0);
  const size_t length = first < 0x80                    ? 1
                        : first >= 0xc2 && first < 0xe0 ? 2
                        : first >= 0xe0 && first < 0xf0 ? 3
                        : first >= 0xf0 && first < 0xf5 ? 4
                                                        : 0;
  uint32_t character = length == 1 ? first : first & (0xff >> (length + 1));
  bool valid = length > 0 && length <= text.size();
  for (size_t i = 1; valid && i < length; ++i) {
    valid = (byte(i) & 0xc0) == 0x80;
    character = character << 6 | (byte(i) & 0x3f);
  }
  constexpr std::array<uint32_t, 5> kMin{0, 0, 0x80, 0x800, 0x10000};
  valid = valid && character >= kMin[length] && character < 0x110000 && (character < 0xd800 || character > 0xdfff);
  text.remove_prefix(valid ? length : 1);
  return valid ? character : kReplacement;
}

void append_unit(std::string& text, uint32_t unit) {
  std::array<char, 8> escaped{};
  std::snprintf(escaped.data(), escaped.size(), "\\u%04x", unit);
  text += escaped.data();
}

void append_escaped(std::string& text, uint32_t character) {
  if (character == '"' || character == '\\') {
    text += '\\';
    text += static_cast<char>(character);
  } else if (character >= 0x20 && character < 0x7f) {
    text += static_cast<char>(character);
  } else if (character < 0x10000) {
    append_unit(text, character);
  } else {  // a surrogate pair: RFC 8259, 7
    append_unit(text, 0xd800 + ((character - 0x10000) >> 10));
    append_unit(text, 0xdc00 + ((character - 0x10000) & 0x3ff));
  }
}

class JsonFormatter : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    const auto level = spdlog::level::to_string_view(message.level);
    const std::string text = "{\"time\":\"" + utc_text(message.time) + "\",\"level\":\"" +
                             std::string(level.data(), level.size()) + "\",\"message\":\"" +
                             json_escaped({message.payload.data(), message.payload.size()}) + "\"}\n";
    line.append(text.data(), text.data() + text.size());
  }
  [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonFormatter>(); }
};

}  // namespace

std::string utc_text(std::chrono::system_clock::time_point time) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count() % 1000;
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 40> text{};
  const size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::snprintf(text.data() + length, text.size() - length, ".%03dZ", static_cast<int>(ms));
  return text.data();
}

void set_log_format(LogFormat format) {
  if (format == LogFormat::kJson) spdlog::set_formatter(std::make_unique<JsonFormatter>());
}

std::string json_escaped(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  while (!text.empty()) append_escaped(escaped, take_character(text));
  return escaped;
}

}  // namespace surfcast
