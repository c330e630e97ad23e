#include "base/load_module.h"

#include <filesystem>
#include <string>

#include <dlfcn.h>

namespace surfcast {

Result<void*> load_function(const char* module, const char* function) {
  std::error_code code;
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe", code).parent_path();
  const std::string path = (programs / "../lib/surfcast" / module).lexically_normal().string();
  void* loaded = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* address = loaded != nullptr ? dlsym(loaded, function) : nullptr;
  if (address == nullptr) return fail(ErrorKind::kInternal, "cannot load " + path + ": " + dlerror());
  return address;
}

}  // namespace surfcast
