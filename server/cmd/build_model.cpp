#include "cmd/build_model.h"

#include <utility>
#include <vector>

#include "base/stopwatch.h"
#include "model/write_model.h"
#include "scan/read_scan.h"
#include "surfel/normalization_weights.h"

namespace surfcast {
namespace {

/// What would spoil the target is found now, not after a long build.
Status check_target(const std::filesystem::path& target, std::span<const std::filesystem::path> inputs) {
  const std::filesystem::path folder = target.parent_path();
  std::error_code ignored;  // of files that do not exist; reading them says so
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
    return fail(ErrorKind::kIo, target.string() + ": no such folder: " + folder.string());
  }
  for (const std::filesystem::path& input : inputs) {
    if (std::filesystem::equivalent(input, target, ignored)) {
      return fail(ErrorKind::kInvalidInput, target.string() + ": is an input too and would be overwritten");
    }
  }
  return {};
}

Result<std::vector<ScanPoints>> read_scans(std::span<const std::filesystem::path> inputs, const BuildOptions& options,
                                           const BuildProgress& progress) {
  std::vector<ScanPoints> scans;
  for (const std::filesystem::path& input : inputs) {
    progress("reading", static_cast<double>(scans.size()) / static_cast<double>(inputs.size()));
    Result<ScanPoints> scan = read_scan(input);
    if (!scan) return fail(std::move(scan.error()));
    scan->z_up = options.z_up.value_or(scan->z_up);
    scans.push_back(std::move(*scan));
  }
  return scans;
}

}  // namespace

Result<BuildReport> build_model(std::span<const std::filesystem::path> inputs, const std::filesystem::path& target,
                                const BuildOptions& options, const BuildProgress& progress) {
  const Stopwatch stopwatch;
  if (Status status = check_target(target, inputs); !status) return fail(std::move(status.error()));
  Result<std::vector<ScanPoints>> scans = read_scans(inputs, options, progress);
  if (!scans) return fail(std::move(scans.error()));

  BuildReport report;
  progress("making surfels", 0);
  Result<SurfelCloud> cloud = make_surfels(std::move(*scans), report.scan);
  if (!cloud) return fail(std::move(cloud.error()));
  progress("weighing", 0);
  cloud->weights = normalization_weights(*cloud);

  const auto writing = [&progress](double part) { progress("writing", part); };
  const Result<WriteReport> written = write_model(*cloud, target, {options.precision, writing});
  if (!written) return fail(written.error());
  report.surfels = written->surfels;
  report.blocks = written->blocks;
  report.bytes = written->bytes;
  report.seconds = stopwatch.seconds();
  report.peak_memory = peak_resident_bytes();
  return report;
}

}  // namespace surfcast
