#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "builder/place_inputs.h"
#include "cmd/build_progress.h"
#include "model/georeference.h"

namespace surfcast::cmd {

// Flags that commands which build models share. What they set must outlive the parsing.

/// `--precision`, `--up` and `--memory`.
struct ModelFlags {
  std::optional<double> precision;
  std::string up;      ///< "y" or "z"; empty: as the inputs say
  std::string memory;  ///< a size; empty: the default

  [[nodiscard]] std::optional<bool> z_up() const;
};
void add_model_flags(CLI::App& command, ModelFlags& flags);

/// `--crs`, `--override-crs` and `--to-crs`.
void add_system_flags(CLI::App& command, builder::SystemOptions& systems);

/// `--threads` and `--progress`.
struct RunFlags {
  size_t threads = 0;  ///< 0: one a core
  std::string progress = "auto";

  [[nodiscard]] ProgressStyle style() const;
  /// Points a second that a build works on, about.
  [[nodiscard]] double points_per_second() const;
};
void add_run_flags(CLI::App& command, RunFlags& flags);

/// Keeps memory that is freed for the arrays of the next stage: to return it and to get new pages costs a tenth of the
/// time of a build. The process ends with the build.
void keep_freed_memory();

/// The files of folders in place of the folders.
Status open_folders(std::vector<std::filesystem::path>& inputs);

/// The system of the model, and how inputs came into it.
std::string system_lines(const std::vector<builder::TransformedInput>& transformed,
                         const model::Georeference& georeference);

}  // namespace surfcast::cmd
