#include "worker/worker_environment.h"

#include <algorithm>
#include <array>

namespace surfcast::worker {
namespace {

constexpr std::array<std::string_view, 17> kNames{
    "PATH",         "HOME",         "LANG",      "LANGUAGE",         "TZ",
    "TMPDIR",       "TERM",         "DISPLAY",   "WAYLAND_DISPLAY",  "USER",
    "PROJ_DATA",    "PROJ_LIB",     "DRI_PRIME", "MALLOC_ARENA_MAX", "ASAN_OPTIONS",
    "TSAN_OPTIONS", "UBSAN_OPTIONS"};

/// Loader, locale, desktop folders; GL, EGL and Vulkan with their drivers (Mesa, NVIDIA, AMD, Intel).
constexpr std::array<std::string_view, 29> kPrefixes{"LD_",
                                                     "LC_",
                                                     "XDG_",
                                                     "LIBGL_",
                                                     "MESA_",
                                                     "GALLIUM_",
                                                     "LP_",
                                                     "DRAW_",
                                                     "ST_",
                                                     "GBM_",
                                                     "EGL_",
                                                     "__EGL_",
                                                     "__GL",
                                                     "GL_",
                                                     "VK_",
                                                     "ZINK_",
                                                     "NIR_",
                                                     "LLVM_",
                                                     "DRI_",
                                                     "LIBVA_",
                                                     "NVIDIA_",
                                                     "CUDA_",
                                                     "NV_",
                                                     "__NV_",
                                                     "AMD_",
                                                     "RADV_",
                                                     "INTEL_",
                                                     "ANV_",
                                                     "SURFCAST_WORKER_"};

std::string_view name_of(std::string_view variable) {
  return variable.substr(0, variable.find('='));
}

}  // namespace

bool is_for_worker(std::string_view name) {
  const auto begins = [&](std::string_view prefix) { return name.starts_with(prefix); };
  return std::ranges::find(kNames, name) != kNames.end() || std::ranges::any_of(kPrefixes, begins);
}

std::vector<std::string> worker_environment(const std::vector<std::string>& inherited,
                                            const std::vector<std::string>& added) {
  std::vector<std::string> variables;
  std::ranges::copy_if(inherited, std::back_inserter(variables),
                       [](const std::string& variable) { return is_for_worker(name_of(variable)); });
  for (const std::string& variable : added) {
    const auto same = [&](const std::string& other) { return name_of(other) == name_of(variable); };
    if (std::ranges::none_of(variables, same)) variables.push_back(variable);
  }
  return variables;
}

}  // namespace surfcast::worker
