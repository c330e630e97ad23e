#pragma once

#include <filesystem>

#include "base/result.h"

namespace surfcast {

/// The folder lib/surfcast beside the program's folder, in the build tree and where it is installed.
std::filesystem::path module_folder();

/// Loads a module of the project from module_folder(), and returns the address of a function that it exports. Modules
/// stay loaded. They keep libraries with many dependencies away from the start of programs. The error names the module.
Result<void*> load_function(const char* module, const char* function);

}  // namespace surfcast
