// A library to preload (LD_PRELOAD) that stops a program at one of its calls that change files, so that a test can stop
// it in every state that its files go through. Moments are counted from 1: before a call, after it, before the next.
//   SURFCAST_STOP_AT      the moment; without it none
//   SURFCAST_STOP_SIGNAL  number of the signal that the calling thread gets then
//   SURFCAST_MOMENTS      a file that gets the count of all moments when the program ends by itself

#include <atomic>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/types.h>

namespace {

std::atomic<long> moments{0};

long number_of(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? 0 : std::strtol(text, nullptr, 10);
}

void moment() {
  static const long stop_at = number_of("SURFCAST_STOP_AT");
  static const int signal = static_cast<int>(number_of("SURFCAST_STOP_SIGNAL"));
  if (++moments == stop_at) std::raise(signal);
}

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// The call of that name between two moments.
template <typename Function, typename... Arguments>
auto between_moments(const char* name, Arguments... arguments) {
  moment();
  const auto result = next<Function>(name)(arguments...);
  moment();
  return result;
}

struct Report {
  ~Report() {
    const char* path = std::getenv("SURFCAST_MOMENTS");
    if (path == nullptr) return;
    std::FILE* file = std::fopen(path, "w");
    if (file == nullptr) return;
    std::fprintf(file, "%ld\n", moments.load());
    std::fclose(file);
  }
} report;

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  std::va_list rest;
  va_start(rest, flags);
  const bool makes = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  const mode_t mode = makes ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  using Open = int(const char*, int, ...);
  return makes ? between_moments<Open>("open", path, flags, mode) : next<Open>("open")(path, flags);
}

ssize_t pwrite(int file, const void* bytes, size_t count, off_t offset) {
  return between_moments<ssize_t(int, const void*, size_t, off_t)>("pwrite", file, bytes, count, offset);
}

int fsync(int file) {
  return between_moments<int(int)>("fsync", file);
}

int fallocate(int file, int mode, off_t offset, off_t length) {
  return between_moments<int(int, int, off_t, off_t)>("fallocate", file, mode, offset, length);
}

int rename(const char* from, const char* to) noexcept {
  return between_moments<int(const char*, const char*)>("rename", from, to);
}

int unlink(const char* path) noexcept {
  return between_moments<int(const char*)>("unlink", path);
}

}  // extern "C"
