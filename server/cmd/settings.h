#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "base/result.h"

namespace surfcast::cmd {

/// Whole numbers that a setting may have.
struct SettingRange {
  uint64_t least = 1;
  uint64_t most = UINT64_MAX;
};

/// A size like "4G", in bytes within the range.
Result<uint64_t> parse_size(const std::string& text, const SettingRange& range);
Result<uint64_t> parse_count(const std::string& text, const SettingRange& range);
/// Seconds with or without a fraction, from a thousandth to ten days.
Result<std::chrono::milliseconds> parse_seconds(const std::string& text);
/// A size for people: "512M", "1.5G".
std::string size_text(uint64_t bytes);

/// A flag `--NAME` and its variable (environment_name). `set` gets text that `check` has nothing against.
struct Setting {
  std::string name;
  std::string type;  ///< of its value, in the help
  std::string help;  ///< what it limits, its default, and what more or less of it costs
  std::function<Status(const std::string&)> check;
  std::function<void(const std::string&)> set;
  std::string other_name{};  ///< of the flag, without a variable; empty: none
};
void add_setting(CLI::App& command, const Setting& setting);

/// A size that `set` receives in bytes.
void add_size_setter(CLI::App& command, const std::string& name, const std::function<void(uint64_t)>& set,
                     const std::string& help, const SettingRange& range = {});

/// Settings whose target keeps its value where they are not given, and must outlive the parsing.
template <typename Target>
void add_size(CLI::App& command, const std::string& name, Target& target, const std::string& help,
              const SettingRange& range = {}) {
  add_size_setter(
      command, name, [&target](uint64_t bytes) { target = static_cast<Target>(bytes); }, help, range);
}
template <typename Target>
void add_count(CLI::App& command, const std::string& name, Target& target, const std::string& help,
               const SettingRange& range = {1, 1'000'000}, const std::string& other_name = {}) {
  add_setting(command,
              {name, "NUMBER", help,
               [range](const std::string& text) -> Status { return parse_count(text, range).map([](uint64_t) {}); },
               [&target, range](const std::string& text) { target = static_cast<Target>(*parse_count(text, range)); },
               other_name});
}
void add_seconds(CLI::App& command, const std::string& name, std::chrono::milliseconds& target,
                 const std::string& help);

}  // namespace surfcast::cmd
