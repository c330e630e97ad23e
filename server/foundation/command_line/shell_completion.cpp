#include "command_line/shell_completion.h"

#include <algorithm>
#include <vector>

#include "base/ascii_text.h"

namespace surfcast::command_line {
namespace {

/// Text in single quotes, for all three shells.
std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::vector<std::string> flag_names(const CommandSummary& command) {
  std::vector<std::string> names;
  for (const OptionSummary& option : command.options) {
    if (!option.positional) names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

/// The name of the completion function.
std::string function_name(std::string name) {
  std::ranges::replace(name, '-', '_');
  return "_" + name;
}

/// The completions after a flag that takes a value; file names if any value is allowed.
std::string bash_values(const CommandSummary& command) {
  std::string text;
  std::vector<std::string> any_value;
  for (const OptionSummary& option : command.options) {
    if (option.positional || option.value.empty()) continue;
    if (option.choices.empty()) {
      any_value.insert(any_value.end(), option.names.begin(), option.names.end());
    } else {
      const std::string words = in_quotes(joined(option.choices, " "));
      text += "        " + joined(option.names, "|") + ") words=" + words + " any=yes ;;\n";
    }
  }
  if (any_value.empty()) return text;
  return text + "        " + joined(any_value, "|") + ") return ;;\n";
}

std::string bash_command(const CommandSummary& command, const std::string& pattern, const std::string& program) {
  std::string text = "    " + pattern + ")\n";
  if (command.forwards) {  // the other program's script is in the same folder
    const std::string other = program + "-" + command.name;
    const std::string function = function_name(other);
    return text + "      declare -F " + function + " >/dev/null || . \"${BASH_SOURCE[0]%/*}/" + other +
           "\" 2>/dev/null || return\n      " + function + "\n      return ;;\n";
  }
  text += "      words=" + in_quotes(joined(flag_names(command), " ")) + "\n";
  return text + "      case $previous in\n" + bash_values(command) + "      esac ;;\n";
}

/// `any`: words are offered for any typed text, not only after a dash.
std::string bash_completion(const CommandSummary& program, const std::string& name) {
  const std::string function = function_name(name);
  std::string text = "# Completion of " + name + " for bash.\n" + function + "() {\n";
  text +=
      "  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} words= any=\n"
      "  COMPREPLY=()\n";
  if (program.commands.empty()) {
    text += "  case '' in\n" + bash_command(program, "*", name) + "  esac\n";
  } else {
    text += "  case $((COMP_CWORD > 1)) in\n    0) words=";
    std::vector<std::string> first = command_names(program);
    const std::vector<std::string> flags = flag_names(program);
    first.insert(first.end(), flags.begin(), flags.end());
    text += in_quotes(joined(first, " ")) + " any=yes ;;\n  esac\n  [ \"$any\" ] || case ${COMP_WORDS[1]} in\n";
    for (const CommandSummary& command : program.commands) text += bash_command(command, command.name, name);
    text += "  esac\n";
  }
  text += "  [[ $any || $word == -* ]] && COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n}\n";
  return text + "complete -o default -F " + function + " " + name + "\n";
}

/// Escapes text inside the [brackets] of _arguments.
std::string zsh_escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_value(const OptionSummary& option) {
  const std::string action = option.choices.empty() ? "_files" : "(" + joined(option.choices, " ") + ")";
  return ":" + zsh_escaped(option.positional ? option.names.front() : option.value) + ":" + action;
}

std::string zsh_arguments(const CommandSummary& command) {
  std::string text = "_arguments";
  for (const OptionSummary& option : command.options) {
    if (option.positional) {
      text += " " + in_quotes((option.several ? "*" : "") + zsh_value(option));
      continue;
    }
    const std::string value = option.value.empty() ? "" : zsh_value(option);
    const std::string meaning = "[" + zsh_escaped(option.help) + "]" + value;
    for (const std::string& name : option.names) {
      const std::string flag = (option.several ? "*" : "") + name;
      text += " \\\n        " + in_quotes(flag + meaning);
    }
  }
  return text;
}

std::string zsh_command(const CommandSummary& command, const std::string& name) {
  if (command.forwards) return "_dispatch " + name + "-" + command.name + " " + name + "-" + command.name;
  return zsh_arguments(command);
}

std::string zsh_completion(const CommandSummary& program, const std::string& name) {
  const std::string function = function_name(name);
  std::string text = "#compdef " + name + "\n" + function + "() {\n";
  if (program.commands.empty()) return text + "  " + zsh_arguments(program) + "\n}\n" + function + " \"$@\"\n";
  text += "  if (( CURRENT == 2 )); then\n    local -a commands=(\n";
  for (const CommandSummary& command : program.commands) {
    text += "      " + in_quotes(command.name + ":" + command.description) + "\n";
  }
  text += "    )\n    _describe command commands\n    compadd -- " + joined(flag_names(program), " ") +
          "\n    return\n  fi\n  shift words\n  (( CURRENT-- ))\n  case $words[1] in\n";
  for (const CommandSummary& command : program.commands) {
    text += "    " + command.name + ")\n      " + zsh_command(command, name) + " ;;\n";
  }
  return text + "  esac\n}\n" + function + " \"$@\"\n";
}

std::string fish_option(const OptionSummary& option, const std::string& begin) {
  std::string text = begin;
  for (const std::string& name : option.names) {
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (!option.value.empty()) text += " -r";
  if (!option.choices.empty()) text += " -f -a " + in_quotes(joined(option.choices, " "));
  return text + " -d " + in_quotes(option.help) + "\n";
}

std::string fish_completion(const CommandSummary& program, const std::string& name) {
  std::string text = "# Completion of " + name + " for fish.\n";
  const std::string begin = "complete -c " + name;
  const std::string first = program.commands.empty() ? "" : " -n __fish_use_subcommand";
  for (const OptionSummary& option : program.options) {
    if (!option.positional) text += fish_option(option, begin + first);
  }
  for (const CommandSummary& command : program.commands) {
    text += begin + " -n __fish_use_subcommand -f -a " + command.name + " -d " + in_quotes(command.description) + "\n";
    const std::string inside = begin + " -n " + in_quotes("__fish_seen_subcommand_from " + command.name);
    for (const OptionSummary& option : command.options) {
      if (!option.positional) text += fish_option(option, inside);
    }
  }
  return text;
}

}  // namespace

std::optional<Shell> parse_shell(std::string_view name) {
  if (name == "bash") return Shell::kBash;
  if (name == "zsh") return Shell::kZsh;
  if (name == "fish") return Shell::kFish;
  return std::nullopt;
}

std::string shell_completion(const CommandSummary& program, const std::string& name, Shell shell) {
  switch (shell) {
    case Shell::kZsh:
      return zsh_completion(program, name);
    case Shell::kFish:
      return fish_completion(program, name);
    case Shell::kBash:
      break;
  }
  return bash_completion(program, name);
}

}  // namespace surfcast::command_line
