#include "protocol/film.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <spdlog/fmt/fmt.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/ascii_text.h"
#include "base/child_process.h"

namespace surfcast::protocol {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEncoder = "ffmpeg";

tl::unexpected<Error> system_error(const std::string& what, int code) {
  return fail(ErrorKind::kIo, what + ": " + std::strerror(code));
}

/// Pictures come from standard input. Sides are even, which both codecs need, by a repeated column or row. sRGB becomes
/// BT.709, the only colours that all players show alike.
std::vector<std::string> encoder_arguments(const fs::path& target, const fs::path& temporary,
                                           double frames_per_second) {
  std::vector<std::string> arguments{
      kEncoder,
      "-loglevel",
      "error",
      "-nostdin",
      "-y",
      "-f",
      "image2pipe",
      "-c:v",
      "png",
      "-framerate",
      fmt::format("{}", frames_per_second),
      "-i",
      "pipe:0",
      "-vf",
      "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
      "-colorspace",
      "bt709",
      "-color_primaries",
      "bt709",
      "-color_trc",
      "bt709"};
  const std::vector<std::string> codec =
      lower_extension(target) == ".webm"
          ? std::vector<std::string>{"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1", "-f", "webm"}
          : std::vector<std::string>{"-c:v", "libx264", "-crf", "18", "-movflags", "+faststart", "-f", "mp4"};
  arguments.insert(arguments.end(), codec.begin(), codec.end());
  arguments.push_back(temporary.string());
  return arguments;
}

Result<pid_t> start(std::vector<std::string> arguments, const Descriptor& input, const Descriptor& messages) {
  const std::vector<char*> pointers = pointers_to(arguments);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, input.get(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, messages.get(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, messages.get(), STDERR_FILENO);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  pid_t process = -1;
  const int code = ::posix_spawnp(&process, kEncoder, &actions, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (code == ENOENT) return fail(ErrorKind::kUnsupported, "a film needs the program ffmpeg, which is not installed");
  if (code != 0) return system_error("cannot start ffmpeg", code);
  return process;
}

/// Flushes a file that another process has written.
Status flush(const fs::path& file) {
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!descriptor || ::fsync(descriptor.get()) != 0) return system_error(file.string(), errno);
  return {};
}

}  // namespace

bool is_film(const fs::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".mp4" || extension == ".webm";
}

Result<FilmWriter> FilmWriter::create(const fs::path& target, double frames_per_second) {
  // A pair of sockets: writing to one whose other end is closed raises no signal.
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return system_error("cannot make a pair of sockets", errno);
  }
  Descriptor ours(ends[0]);
  const Descriptor its(ends[1]);
  Descriptor messages(::memfd_create("ffmpeg-messages", MFD_CLOEXEC));
  if (!messages) return system_error("cannot set memory aside", errno);
  fs::path temporary = target;
  temporary += ".tmp" + std::to_string(::getpid());
  const Result<pid_t> encoder = start(encoder_arguments(target, temporary, frames_per_second), its, messages);
  if (!encoder) return fail(encoder);
  return FilmWriter(target, std::move(temporary), *encoder, std::move(ours), std::move(messages));
}

FilmWriter::FilmWriter(fs::path target, fs::path temporary, pid_t encoder, Descriptor input, Descriptor messages)
    : target_(std::move(target)),
      temporary_(std::move(temporary)),
      unfinished_(temporary_),
      encoder_(encoder),
      input_(std::move(input)),
      messages_(std::move(messages)) {}

FilmWriter::FilmWriter(FilmWriter&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      unfinished_(std::move(other.unfinished_)),
      encoder_(std::exchange(other.encoder_, -1)),
      input_(std::move(other.input_)),
      messages_(std::move(other.messages_)) {}

FilmWriter::~FilmWriter() {
  if (encoder_ >= 0) {
    ::kill(encoder_, SIGKILL);
    wait();
  }
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

int FilmWriter::wait() {
  int status = 0;
  while (::waitpid(encoder_, &status, 0) < 0 && errno == EINTR) continue;
  encoder_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string FilmWriter::complaint() const {
  std::array<char, 512> text{};
  const ssize_t count = ::pread(messages_.get(), text.data(), text.size(), 0);
  const std::string_view said(text.data(), count > 0 ? static_cast<size_t>(count) : 0);
  return std::string(said.substr(0, said.find('\n')));
}

Status FilmWriter::failed() const {
  const std::string said = complaint();
  return fail(ErrorKind::kIo, target_.string() + ": ffmpeg has ended" + (said.empty() ? "" : ": " + said));
}

Status FilmWriter::append(std::string_view png) {
  while (!png.empty()) {
    const ssize_t sent = ::send(input_.get(), png.data(), png.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) {
      wait();
      return failed();
    }
    png.remove_prefix(static_cast<size_t>(sent));
  }
  return {};
}

Status FilmWriter::finish() {
  input_ = Descriptor();
  if (wait() != 0) return failed();
  if (Status flushed = flush(temporary_); !flushed) return flushed;
  std::error_code code;
  fs::rename(temporary_, target_, code);
  if (code) return fail(ErrorKind::kIo, target_.string() + ": " + code.message());
  temporary_.clear();
  return {};
}

}  // namespace surfcast::protocol
