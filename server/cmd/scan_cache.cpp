#include "cmd/scan_cache.h"

#include <array>
#include <cstdlib>
#include <string>
#include <system_error>

#include <spdlog/fmt/fmt.h>

#include "base/hash.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "builder/build_model.h"
#include "model/model_file.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

/// Another release may build better models of the same scan, so its version is part of the key.
std::string key_of(std::span<const std::byte> content) {
  return fmt::format("{}-{}.surf", SURFCAST_VERSION, hash_name(content));
}

Status build_into(const fs::path& scan, const fs::path& target) {
  spdlog::info("{}: building a model of it", scan.string());
  const std::array inputs{scan};
  const Result<builder::BuildReport> report =
      builder::build_model(inputs, target, {}, [](const builder::BuildStep&) {});
  if (!report) return fail(report.error());
  for (const std::string& note : report->scan.notes) spdlog::warn("{}", note);
  spdlog::info("{}: {} surfels in {:.1f} s", scan.string(), report->surfels, report->seconds);
  return {};
}

}  // namespace

Result<fs::path> default_cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/') {
    return fs::path(cache) / "surfcast";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
    return fs::path(home) / ".cache" / "surfcast";
  }
  return fail(ErrorKind::kIo, "there is no folder for built models: set XDG_CACHE_HOME or HOME, or give --cache");
}

Result<fs::path> model_of_scan(const fs::path& scan, const fs::path& cache) {
  const Result<MappedFile> content = MappedFile::open(scan);
  if (!content) return fail(content.error());
  const fs::path target = cache / key_of(content->bytes());
  if (model::ModelFile::open(target)) return target;
  std::error_code code;
  fs::create_directories(cache, code);
  if (code) return fail(ErrorKind::kIo, cache.string() + ": cannot make the folder: " + code.message());
  if (Status status = build_into(scan, target); !status) return fail(status.error());
  return target;
}

}  // namespace surfcast::cmd
