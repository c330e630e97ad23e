#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <string>
#include <vector>

#include "cmd/scan_builds.h"
#include "cmd/scan_cache.h"
#include "net/server_config.h"
#include "net/static_files.h"
#include "render/renderer.h"
#include "service/render_service.h"

namespace surfcast::cmd {

/// Processes that draw.
struct WorkerFlags {
  unsigned workers = 1;  ///< 0: this process draws
  bool no_sandbox = false;
  std::vector<std::string> readable;          ///< see worker::WorkerConfig
  std::chrono::milliseconds silence{60'000};  ///< likewise
  uint64_t query_bytes = uint64_t{8} << 30;   ///< worker::QueryWorkerConfig::memory
};

// Flags that set the limits of the programs, and their variables. docs/settings.md lists them all. Targets must outlive
// the parsing.

/// `--cache`, its size, and the memory and `--radii` of builds.
void add_cache_flags(CLI::App& command, ScanCacheConfig& cache);
/// Previews of scans, and the threads of builds.
void add_build_flags(CLI::App& command, PreviewRule& previews, size_t& threads);
/// `--annotations` and its limit.
void add_annotation_flags(CLI::App& command, net::AnnotationConfig& annotations);
/// `--uploads` and its limits.
void add_upload_flags(CLI::App& command, net::UploadConfig& uploads);
/// The memory of the renderer and its threads.
void add_renderer_flags(CLI::App& command, render::RendererConfig& renderer);
/// The processes that draw and decode.
void add_worker_flags(CLI::App& command, WorkerFlags& worker);
/// The size of a picture.
void add_picture_flags(CLI::App& command, service::ServiceLimits& limits);
/// What picks keep in memory.
void add_pick_cache_flag(CLI::App& command, service::PickLimits& limits);
/// All that only a server has: queues, threads, connections, views, messages, times, the viewer.
void add_server_flags(CLI::App& command, service::ServiceLimits& service, render::RendererConfig& renderer,
                      net::ServerConfig& server, net::SiteLimits& viewer);

}  // namespace surfcast::cmd
