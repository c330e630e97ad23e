#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::worker {

/// What a GL driver reads: system libraries, its own settings, what the kernel says of devices, and the paths that the
/// environment names for drivers and libraries.
std::vector<std::string> driver_paths();

/// What a process may open from now on.
struct OpenFiles {
  std::vector<std::string> readable;    ///< files and folders
  std::vector<std::string> writable{};  ///< folders in which it may also create, change and remove files
  bool devices = true;
};

/// From here on this process, and the threads that it will start, can open nothing else. Open descriptors are not
/// affected. Call it before the first thread is started. kUnsupported where the kernel has no Landlock.
Status restrict_files(const OpenFiles& files);

/// From here on all threads of this process can reach no network, start no process, run no program, and neither signal
/// nor trace other processes. kUnsupported where the kernel has no seccomp filters.
Status restrict_calls();

}  // namespace surfcast::worker
