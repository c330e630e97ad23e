#include "cmd/build_flags.h"

#include <algorithm>
#include <limits>
#include <thread>

#include <malloc.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "builder/input_files.h"
#include "builder/memory_budget.h"
#include "cmd/georeference_text.h"

namespace surfcast::cmd {

std::optional<bool> ModelFlags::z_up() const {
  return up.empty() ? std::nullopt : std::optional(up == "z");
}

void add_model_flags(CLI::App& command, ModelFlags& flags) {
  command
      .add_option("--precision", flags.precision,
                  "Largest error of a stored position, in units of the scan (default: 1/256 of each radius)")
      ->check(CLI::PositiveNumber);
  command.add_option("--up", flags.up, "Vertical axis: y or z (default: derived from the scan)")
      ->check(CLI::IsMember({"y", "z"}));
  command
      .add_option("--memory", flags.memory,
                  "Memory limit of the build, like 4G or 512M (default: a quarter of the machine's memory)")
      ->check([](const std::string& text) {
        return builder::parse_memory_size(text) ? std::string() : "not a size like 4G or 512M: " + text;
      });
}

void add_system_flags(CLI::App& command, builder::SystemOptions& systems) {
  CLI::Option* assigned = command.add_option("--crs", systems.assigned,
                                             "Coordinate system of the inputs that state none, like EPSG:25832 or WKT");
  command.add_flag("--override-crs", systems.overrides_stated, "Take --crs for all inputs, whatever they state")
      ->needs(assigned);
  command.add_option("--to-crs", systems.target,
                     "Coordinate system that all inputs are brought into (default: that of the first input)");
}

ProgressStyle RunFlags::style() const {
  if (progress == "json") return ProgressStyle::kJson;
  return progress != "none" && ::isatty(STDERR_FILENO) == 1 ? ProgressStyle::kTerminal : ProgressStyle::kNone;
}

double RunFlags::points_per_second() const {
  // By the processor time of 10^7 points.
  constexpr double kPointsPerSecondAndCore = 250'000;
  const size_t cores = threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
  return kPointsPerSecondAndCore * static_cast<double>(cores);
}

void add_run_flags(CLI::App& command, RunFlags& flags) {
  command.add_option("--threads", flags.threads, "Threads of the build (default: one a core)")
      ->check(CLI::Range(1, 1024));
  command
      .add_option("--progress", flags.progress,
                  "On standard error: auto (a line on a terminal, the default), json (lines for programs), none")
      ->check(CLI::IsMember({"auto", "json", "none"}));
}

void keep_freed_memory() {
#ifdef __GLIBC__
  ::mallopt(M_MMAP_THRESHOLD, std::numeric_limits<int>::max());
  ::mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
}

Status open_folders(std::vector<std::filesystem::path>& inputs) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& input : inputs) {
    Result<std::vector<std::filesystem::path>> found = builder::inputs_at(input);
    if (!found) return fail(found);
    files.insert(files.end(), found->begin(), found->end());
  }
  inputs = std::move(files);
  return {};
}

std::string system_lines(const std::vector<builder::TransformedInput>& transformed,
                         const model::Georeference& georeference) {
  std::string lines;
  for (const builder::TransformedInput& input : transformed) {
    lines += fmt::format("{}: from {} to {} by {}, {}\n", input.input, input.from, input.to, input.operation,
                         input.accuracy ? fmt::format("accuracy {} m", *input.accuracy) : "accuracy unknown");
  }
  if (georeference.known()) lines += "coordinate system: " + name_of(georeference.system) + "\n";
  return lines;
}

}  // namespace surfcast::cmd
