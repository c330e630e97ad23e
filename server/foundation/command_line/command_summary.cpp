#include "command_line/command_summary.h"

#include <algorithm>
#include <string_view>

#include "base/ascii_text.h"

namespace surfcast::command_line {
namespace {

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    parts.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// CLI11 appends the validators of an option to the name of its type: "TEXT:{y,z}", "INT:POSITIVE".
std::vector<std::string> choices_of(std::string_view type) {
  const size_t open = type.find(":{");
  const size_t close = type.find('}');
  if (open != std::string_view::npos && close != std::string_view::npos) {
    return split(type.substr(open + 2, close - open - 2), ',');
  }
  const bool listed = type.find('|') != std::string_view::npos && type.find(':') == std::string_view::npos;
  return listed ? split(type, '|') : std::vector<std::string>{};
}

std::string value_of(const std::string& type, const std::vector<std::string>& choices) {
  return choices.empty() ? type.substr(0, type.find(':')) : joined(choices, "|");
}

OptionSummary summarize_option(const CLI::Option& option) {
  OptionSummary summary;
  for (const std::string& name : option.get_snames()) summary.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) summary.names.push_back("--" + name);
  summary.positional = summary.names.empty();
  if (summary.positional) summary.names.push_back(option.get_name(true));
  summary.help = option.get_description();
  summary.variable = option.get_envname();
  summary.required = option.get_required();
  summary.several = option.get_items_expected_max() > 1;
  if (option.get_items_expected_max() == 0) return summary;
  summary.choices = choices_of(option.get_type_name());
  summary.value = value_of(option.get_type_name(), summary.choices);
  return summary;
}

}  // namespace

CommandSummary summarize_command(const CLI::App& app) {
  CommandSummary summary{app.get_name(), app.get_description(), {}, {}, app.get_prefix_command()};
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) summary.options.push_back(summarize_option(*option));
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    summary.commands.push_back(summarize_command(*command));
  }
  std::ranges::sort(summary.commands, {}, &CommandSummary::name);
  return summary;
}

std::vector<std::string> command_names(const CommandSummary& program) {
  std::vector<std::string> names;
  for (const CommandSummary& command : program.commands) names.push_back(command.name);
  return names;
}

}  // namespace surfcast::command_line
