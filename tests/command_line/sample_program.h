#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

namespace surfcast::command_line {

/// A program with one of each kind of thing: commands, a switch, choices, a variable, positionals, a hidden flag.
inline std::unique_ptr<CLI::App> sample_program() {
  auto app = std::make_unique<CLI::App>("Stacks hay", "stack");
  app->add_flag("--secret")->group("");
  CLI::App* make = app->add_subcommand("make", "Make a stack");
  make->add_option_function<std::string>(
          "BALE", [](const std::string&) {}, "Bales to stack")
      ->required()
      ->expected(1, 1000);
  make->add_option_function<std::string>(
          "--shape", [](const std::string&) {}, "Which shape it's of")
      ->check(CLI::IsMember({"cone", "cube"}));
  make->add_option_function<std::string>(
          "--output", [](const std::string&) {}, "The stack's file")
      ->envname("STACK_OUTPUT")
      ->type_name("FILE")
      ->required();
  make->add_flag_callback(
      "--dry", [] {}, "Hay that is dry [and warm]");
  CLI::App* look = app->add_subcommand("look", "Look at a stack");
  look->set_help_flag();
  look->prefix_command();
  return app;
}

}  // namespace surfcast::command_line
