#include "base/load_module.h"

#include <string>

#include <dlfcn.h>

namespace surfcast {

std::filesystem::path module_folder() {
  std::error_code code;
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe", code).parent_path();
  return (programs / "../lib/surfcast").lexically_normal();
}

Result<void*> load_function(const char* module, const char* function) {
  const std::string path = (module_folder() / module).string();
  void* loaded = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* address = loaded != nullptr ? dlsym(loaded, function) : nullptr;
  if (address == nullptr) return fail(ErrorKind::kInternal, "cannot load " + path + ": " + dlerror());
  return address;
}

}  // namespace surfcast
