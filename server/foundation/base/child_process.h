#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/preemption.h"
#include "base/result.h"

namespace surfcast {

/// Arguments or variables as programs are given them, with a null pointer at the end. They point into `texts`.
std::vector<char*> pointers_to(std::vector<std::string>& texts);

/// Runs a program to its end and hands over what it writes to standard output and standard error, line by line. When
/// the work is cancelled, the program gets SIGTERM, and the error is kCancelled. `arguments` begin with the program's
/// path. Returns the exit code, or 128 and the signal that ended the program.
Result<int> run_child(const std::vector<std::string>& arguments, const std::function<void(std::string_view)>& line,
                      const Preemption& preemption);

}  // namespace surfcast
