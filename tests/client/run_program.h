#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace surfcast::client {

struct ProgramOutcome {
  int code = -1;
  std::string output;  ///< standard output
};

/// The exit code of a program that has ended, or 128 and the signal that ended it.
inline int exit_code(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Runs a line of the shell to its end.
inline ProgramOutcome run_program(const std::string& line) {
  ProgramOutcome outcome;
  FILE* pipe = ::popen(line.c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer{};
  while (const size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    outcome.output.append(buffer.data(), count);
  }
  outcome.code = exit_code(::pclose(pipe));
  return outcome;
}

/// Starts a program and leaves it running; the first argument is its path.
inline pid_t start_program(std::vector<std::string> arguments) {
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  // The sockets of a server in this process would live on in the program.
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  pid_t process = -1;
  ::posix_spawn(&process, pointers[0], &actions, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  return process;
}

/// Waits for the end of a program that was started.
inline int wait_for_program(pid_t process) {
  int status = 0;
  ::waitpid(process, &status, 0);
  return exit_code(status);
}

}  // namespace surfcast::client
