#include "command_line/manual_page.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace surfcast::command_line {
namespace {

/// Escapes text for troff. Dashes stay ASCII dashes, which can be searched for, and no line starts with a request.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      const bool begins_line = result.empty() || result.back() == '\n';
      if (begins_line && (c == '.' || c == '\'')) result += "\\&";
      result += c;
    }
  }
  return result;
}

std::string bold(std::string_view text) {
  return "\\fB" + escaped(text) + "\\fR";
}

std::string italic(std::string_view text) {
  return "\\fI" + escaped(text) + "\\fR";
}

std::string capitals(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// The first line of a description; the rest are details.
std::string headline(const std::string& description) {
  return description.substr(0, description.find('\n'));
}

/// Text with its line breaks preserved.
std::string paragraph(std::string_view text) {
  std::string lines;
  for (const char c : escaped(text)) lines += c == '\n' ? std::string("\n.br\n") : std::string(1, c);
  return ".PP\n" + lines + "\n";
}

/// Adds the full stop that descriptions such as "Make a model" leave out.
std::string sentence(const std::string& text) {
  const bool ended = text.empty() || text.back() == '.';
  return ended ? text : text + ".";
}

std::string positional_usage(const OptionSummary& option) {
  const std::string text = italic(option.names.front()) + (option.several ? " ..." : "");
  return option.required ? text : "[" + text + "]";
}

std::string usage(const CommandSummary& command, const std::string& words) {
  std::string text = ".PP\n" + bold(words);
  if (command.forwards) return text + " " + italic("ARGUMENT") + " ...\n";
  text += " [" + italic("OPTION") + " ...]";
  for (const OptionSummary& option : command.options) {
    if (option.positional) text += " " + positional_usage(option);
  }
  return text + "\n";
}

std::string option_entry(const OptionSummary& option) {
  std::string head;
  for (const std::string& name : option.names) {
    head += (head.empty() ? "" : ", ") + (option.positional ? italic(name) : bold(name));
  }
  if (!option.positional && !option.value.empty()) head += " " + italic(option.value);
  std::string text = ".TP\n" + head + "\n" + escaped(sentence(option.help)) + "\n";
  if (!option.positional && option.required) text += "Must be given.\n";
  if (!option.positional && option.several) text += "May be given several times.\n";
  if (!option.variable.empty()) text += "Variable: " + bold(option.variable) + ".\n";
  return text;
}

std::string option_entries(const CommandSummary& command) {
  std::string text;
  for (const OptionSummary& option : command.options) text += option_entry(option);
  return text;
}

std::string command_section(const CommandSummary& command, const std::string& program) {
  return ".SS " + escaped(command.name) + "\n" + usage(command, program + " " + command.name) +
         paragraph(sentence(headline(command.description))) + option_entries(command);
}

bool has_variables(const CommandSummary& program) {
  return std::ranges::any_of(program.options, [](const OptionSummary& option) { return !option.variable.empty(); }) ||
         std::ranges::any_of(program.commands, has_variables);
}

std::string common_sections(const CommandSummary& program) {
  std::string text;
  if (has_variables(program)) {
    text += ".SH ENVIRONMENT\n" +
            escaped("A flag with a variable can also be given by that variable; the flag wins over it.") + "\n";
  }
  return text + ".SH EXIT STATUS\n.TP\n0\nDone.\n.TP\n1\nFailed; one line on standard error says why.\n.TP\n2\n" +
         "The command line is wrong.\n";
}

}  // namespace

std::string manual_page(const CommandSummary& program, const std::string& name, const std::string& version,
                        const std::vector<ManualSection>& sections) {
  std::string text = ".TH " + capitals(name) + " 1 \"\" \"Surfcast " + version + "\" \"User Commands\"\n.SH NAME\n";
  text += escaped(name) + " \\- " + escaped(headline(program.description)) + "\n.SH SYNOPSIS\n";
  if (program.commands.empty()) text += usage(program, program.name);
  for (const CommandSummary& command : program.commands) text += usage(command, program.name + " " + command.name);
  text += ".SH OPTIONS\n" + option_entries(program);
  if (!program.commands.empty()) text += ".SH COMMANDS\n";
  for (const CommandSummary& command : program.commands) text += command_section(command, program.name);
  text += common_sections(program);
  for (const ManualSection& section : sections) {
    text += ".SH " + escaped(section.title) + "\n";
    for (const std::string& words : section.paragraphs) text += paragraph(words);
  }
  return text;
}

}  // namespace surfcast::command_line
