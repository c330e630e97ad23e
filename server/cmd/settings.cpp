#include "cmd/settings.h"

#include <charconv>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "builder/memory_budget.h"
#include "protocol/request_flags.h"

namespace surfcast::cmd {

Result<uint64_t> parse_size(const std::string& text, const SettingRange& range) {
  if (text == "0" && range.least == 0) return 0;  // which is no memory to build in
  const std::optional<uint64_t> bytes = builder::parse_memory_size(text);
  if (!bytes) return fail(ErrorKind::kInvalidInput, "not a size like 4G or 512M: " + text);
  if (*bytes < range.least) {
    return fail(ErrorKind::kInvalidInput, "must be at least " + size_text(range.least) + ": " + text);
  }
  if (*bytes > range.most) {
    return fail(ErrorKind::kInvalidInput, "must be at most " + size_text(range.most) + ": " + text);
  }
  return *bytes;
}

Result<uint64_t> parse_count(const std::string& text, const SettingRange& range) {
  uint64_t count = 0;
  const char* end = text.data() + text.size();
  const auto [rest, code] = std::from_chars(text.data(), end, count);
  if (code == std::errc() && rest == end && count >= range.least && count <= range.most) return count;
  return fail(ErrorKind::kInvalidInput,
              fmt::format("must be a whole number from {} to {}: {}", range.least, range.most, text));
}

Result<std::chrono::milliseconds> parse_seconds(const std::string& text) {
  constexpr double kMin = 0.001;
  constexpr double kMax = 864'000;
  double seconds = 0;
  const char* end = text.data() + text.size();
  const auto [rest, code] = std::from_chars(text.data(), end, seconds);
  if (code == std::errc() && rest == end && seconds >= kMin && seconds <= kMax) {
    return std::chrono::milliseconds(std::llround(seconds * 1e3));
  }
  return fail(ErrorKind::kInvalidInput, fmt::format("must be seconds from {} to {}: {}", kMin, kMax, text));
}

std::string size_text(uint64_t bytes) {
  constexpr double kStep = 1024;
  auto value = static_cast<double>(bytes);
  std::string unit;
  for (const char* larger : {"K", "M", "G"}) {
    if (value < kStep) break;
    value /= kStep;
    unit = larger;
  }
  return fmt::format("{:.{}f}{}", value, value == std::floor(value) ? 0 : 1, unit);
}

void add_setting(CLI::App& command, const Setting& setting) {
  const std::string other = setting.other_name.empty() ? std::string() : ",--" + setting.other_name;
  command.add_option_function<std::string>("--" + setting.name + other, setting.set, setting.help)
      ->type_name(setting.type)
      ->envname(protocol::environment_name(setting.name))
      ->check([check = setting.check](const std::string& text) {
        const Status status = check(text);
        return status ? std::string() : status.error().message;
      });
}

void add_size_setter(CLI::App& command, const std::string& name, const std::function<void(uint64_t)>& set,
                     const std::string& help, const SettingRange& range) {
  add_setting(command,
              {name, "SIZE", help,
               [range](const std::string& text) -> Status { return parse_size(text, range).map([](uint64_t) {}); },
               [set, range](const std::string& text) { set(*parse_size(text, range)); }});
}

void add_seconds(CLI::App& command, const std::string& name, std::chrono::milliseconds& target,
                 const std::string& help) {
  add_setting(command, {name, "SECONDS", help,
                        [](const std::string& text) -> Status {
                          return parse_seconds(text).map([](std::chrono::milliseconds) {});
                        },
                        [&target](const std::string& text) { target = *parse_seconds(text); }});
}

}  // namespace surfcast::cmd
