#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::worker {

/// What a GL driver reads: system libraries, its own settings, what the kernel says of devices, and the paths that the
/// environment names for drivers and libraries.
std::vector<std::string> driver_paths();

/// From here on this process, and the threads that it will start, can open nothing but devices, and for reading these
/// files and folders. Nothing can be created, changed or removed but in the folders of `writable`. Open descriptors are
/// not affected. Call it before the first thread is started. kUnsupported where the kernel has no Landlock.
Status restrict_files(const std::vector<std::string>& readable, const std::vector<std::string>& writable = {});

/// From here on all threads of this process can reach no network, start no process, run no program, and neither signal
/// nor trace other processes. kUnsupported where the kernel has no seccomp filters.
Status restrict_calls();

}  // namespace surfcast::worker
