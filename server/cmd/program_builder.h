#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "cmd/scan_builds.h"

namespace surfcast::cmd {

/// What `surfcastd build --progress json` says while it runs. Each line is progress, the reason of a failure, or a
/// message for the log.
class BuildOutput {
 public:
  explicit BuildOutput(const BuildWatch& watch) : watch_(watch) {}

  void take(std::string_view line);
  /// Why the build failed, without the name of the program; empty: nothing was said.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  const BuildWatch& watch_;
  std::string problem_;
};

/// Builds models with `surfcastd build --background`, a program of its own: its memory is its own, views have the
/// processors first, and a fault in it ends nothing else. `threads` 0: one a core. Previews have no name once they are
/// open, so that nothing is left of them.
std::unique_ptr<ScanBuilder> make_program_builder(const ScanCacheConfig& cache, size_t threads);

}  // namespace surfcast::cmd
