#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::cmd {

/// The GPUs that a server draws on.
struct GpuSelection {
  bool all = false;          ///< all hardware devices
  std::vector<int> numbers;  ///< of EGL devices; may have one several times; empty: the default device
};

/// `--gpu`. `use`: what is done with several, in its description.
void add_gpus_flag(CLI::App& command, GpuSelection& gpus, const std::string& use);

/// Device numbers as in render::RendererConfig::gpu, at least one. All hardware devices are found by the command `gpus`
/// in a process of its own, because drivers stay loaded; without any it is the default device.
Result<std::vector<int>> devices_of(const GpuSelection& gpus);

}  // namespace surfcast::cmd
