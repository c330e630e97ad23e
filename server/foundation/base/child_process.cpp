#include "base/child_process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace surfcast {
namespace {

constexpr int kPollMilliseconds = 50;

tl::unexpected<Error> system_error(const std::string& what, int code) {
  return fail(ErrorKind::kIo, what + ": " + std::strerror(code));
}

/// A running program and the end of the pipe that it writes to.
struct Child {
  pid_t process = -1;
  int output = -1;
};

Result<Child> start(const std::vector<std::string>& arguments) {
  std::vector<std::string> texts = arguments;
  const std::vector<char*> pointers = pointers_to(texts);
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return system_error("cannot make a pipe", errno);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, pipe[1], STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, pipe[1], STDERR_FILENO);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);  // sockets would live on in the program
  Child child{-1, pipe[0]};
  const int code = ::posix_spawn(&child.process, pointers[0], &actions, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(pipe[1]);
  if (code == 0) return child;
  ::close(pipe[0]);
  return system_error("cannot start " + arguments[0], code);
}

/// Cuts what arrives into lines.
class Lines {
 public:
  explicit Lines(const std::function<void(std::string_view)>& line) : line_(line) {}
  ~Lines() {
    if (!rest_.empty()) line_(rest_);
  }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  void add(std::string_view text) {
    rest_ += text;
    size_t begin = 0;
    for (size_t end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n', begin)) {
      line_(std::string_view(rest_).substr(begin, end - begin));
      begin = end + 1;
    }
    rest_.erase(0, begin);
  }

 private:
  const std::function<void(std::string_view)>& line_;
  std::string rest_;
};

/// Reads until the program has closed its output. True if it was told to end.
bool follow(const Child& child, Lines& lines, const Preemption& preemption) {
  bool told = false;
  std::array<char, 4096> buffer{};
  for (;;) {
    if (!told && preemption.cancelled()) told = ::kill(child.process, SIGTERM) == 0;
    pollfd ready{child.output, POLLIN, 0};
    if (::poll(&ready, 1, kPollMilliseconds) <= 0) continue;
    const ssize_t count = ::read(child.output, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return told;
    lines.add({buffer.data(), static_cast<size_t>(count)});
  }
}

}  // namespace

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

Result<int> run_child(const std::vector<std::string>& arguments, const std::function<void(std::string_view)>& line,
                      const Preemption& preemption) {
  const Result<Child> child = start(arguments);
  if (!child) return fail(child);
  bool told = false;
  {
    Lines lines(line);
    told = follow(*child, lines, preemption);
  }
  ::close(child->output);
  int status = 0;
  while (::waitpid(child->process, &status, 0) < 0 && errno == EINTR) continue;
  if (told) return fail(ErrorKind::kCancelled, "the program was stopped");
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace surfcast
