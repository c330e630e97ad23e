#include "cmd/program_builder.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "base/child_process.h"
#include "base/json_text.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/scratch_folder.h"
#include "cmd/input_flags.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFailurePrefix = "surfcastd: ";

class ProgramBuilder : public ScanBuilder {
 public:
  ProgramBuilder(ScanCacheConfig cache, size_t threads) : cache_(std::move(cache)), threads_(threads) {}

  Result<CacheSlot> find(const fs::path& scan, const std::atomic<bool>& cancelled) override {
    return find_cache_slot(scan, cache_, cancelled);
  }

  Result<ScanPreview> preview(const fs::path& scan, uint64_t points, const BuildWatch& watch) override {
    const Result<fs::path> folder = ready_cache_folder(cache_);
    if (!folder) return fail(folder);
    const Result<ScratchFolder> scratch = ScratchFolder::create(*folder, kPreviewFolder);
    if (!scratch) return fail(scratch);
    const fs::path file = scratch->path() / "preview.surf";
    const fs::path report = scratch->path() / "report.json";
    const Status built = run(scan, file, {"--sample", std::to_string(points), "--report", report.string()}, watch);
    if (!built) return fail(built);
    return model::ModelFile::open(file).map([&](model::ModelFile model) {
      return ScanPreview{std::make_shared<const model::ModelFile>(std::move(model)), points_in(report)};
    });
  }

  Result<CachedModel> build(const fs::path& scan, const fs::path& target, const BuildWatch& watch) override {
    if (Status built = run(scan, target, {}, watch); !built) return fail(built);
    return use_built_model(target, cache_);
  }

 private:
  Status run(const fs::path& scan, const fs::path& target, const std::vector<std::string>& more,
             const BuildWatch& watch) const {
    std::error_code code;
    const fs::path program = fs::read_symlink("/proc/self/exe", code);
    if (code) return fail(ErrorKind::kIo, "cannot find the program itself: " + code.message());
    std::vector<std::string> arguments{program.string(), "build",    "--background", "--progress",
                                       "json",           "--output", target.string()};
    arguments.insert(arguments.end(), {"--radii", name_of(cache_.radii)});
    const std::vector<std::string> meshes = arguments_of(cache_.meshes);
    arguments.insert(arguments.end(), meshes.begin(), meshes.end());
    if (threads_ > 0) arguments.insert(arguments.end(), {"--threads", std::to_string(threads_)});
    if (cache_.build_memory) arguments.insert(arguments.end(), {"--memory", std::to_string(*cache_.build_memory)});
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), {"--", scan.string()});
    BuildOutput output(watch);
    const Result<int> ended = run_child(
        arguments, [&](std::string_view line) { output.take(line); }, Preemption(watch.cancelled));
    if (!ended) return fail(ended);
    if (*ended == 0) return {};
    if (!output.problem().empty()) return fail(ErrorKind::kInvalidInput, output.problem());
    return fail(ErrorKind::kInternal, fmt::format("{}: building a model of it ended with {}", scan.string(), *ended));
  }

  /// The number of points of the scan that a report states; 0 if there is none.
  static uint64_t points_in(const fs::path& report) {
    const Result<MappedFile> file = MappedFile::open(report);
    if (!file) return 0;
    const auto* text = reinterpret_cast<const char*>(file->bytes().data());
    const nlohmann::json json = parse_json_text({text, file->bytes().size()});
    return json.is_object() ? json.value("points_in_scans", uint64_t{0}) : 0;
  }

  const ScanCacheConfig cache_;
  const size_t threads_;
};

}  // namespace

void BuildOutput::take(std::string_view line) {
  if (line.starts_with(kFailurePrefix)) {
    problem_ = line.substr(kFailurePrefix.size());
    return;
  }
  const nlohmann::json json = parse_json_text(line);
  if (json.is_object() && json.contains("done")) {
    watch_.progress(json.value("done", 0.0), json.value("seconds_left", 0.0));
  } else if (line.find("warn") != std::string_view::npos) {
    spdlog::warn("build: {}", line);
  }
}

std::unique_ptr<ScanBuilder> make_program_builder(const ScanCacheConfig& cache, size_t threads) {
  return std::make_unique<ProgramBuilder>(cache, threads);
}

}  // namespace surfcast::cmd
