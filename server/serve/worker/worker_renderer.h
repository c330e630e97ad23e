#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "base/log_format.h"
#include "render/renderer.h"
#include "service/model_renderer.h"
#include "worker/supervisor.h"

namespace surfcast::worker {

struct WorkerConfig {
  std::vector<std::string> command;      ///< starts a worker, see WorkerProcess::start
  std::vector<std::string> environment;  ///< "NAME=value" of variables that it gets where this process has none
  render::RendererConfig renderer;       ///< without its kinds and its guard, which are the worker's own
  LogFormat log_format = LogFormat::kText;
  bool sandbox = true;
  std::vector<std::string> readable;  ///< files and folders that the sandbox lets it read, beside those of drivers
  std::vector<std::string> writable;  ///< folders that the sandbox lets it change: caches of drivers
  size_t pixels = size_t{1} << 25;    ///< of the largest picture
  std::chrono::milliseconds silence{60'000};  ///< after which a worker that draws is taken for hung, and killed
};

/// A factory of renderers that draw in a child process. Models are files, opened here and passed on as descriptors.
/// When the process ends, it is started again, and what was being drawn is drawn again; a picture that ends two workers
/// fails, unless a block is to blame, which is then not loaded any more. `counts` outlives the renderers.
service::ModelRendererFactory worker_renderers(const WorkerConfig& config, WorkerCounts& counts);

}  // namespace surfcast::worker
