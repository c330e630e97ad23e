#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/scan_stream.h"
#include "scattered/field_options.h"
#include "scattered/kernel_sample.h"

namespace surfcast::scattered {

/// The samples of a field, in the order of the file.
struct Samples {
  std::vector<KernelSample> kernels;
  Profile profile = Profile::kSpline;
  uint64_t skipped = 0;  ///< points without a finite place, value and weight, or without a size above 0
};

/// True if the scan has the column of values.
[[nodiscard]] bool has_field(const scan::ScanSchema& schema, const FieldOptions& options);

/// What states the sizes of a scan's kernels: the first of the columns smoothing_length, hsml, h, radius, sigma, and of
/// cov_xx to cov_zz, that it has; otherwise the spacing. Names are compared without case, underscores and spaces.
[[nodiscard]] KernelSizes usual_sizes(const scan::ScanSchema& schema);

/// Memory of a sample while it is read and evaluated, bytes.
inline constexpr uint64_t kBytesPerSample = 320;

/// Reads all samples of a scan. Fails, naming the file, if a column is missing, if there is no usable sample, or if the
/// samples do not fit into `max_bytes`.
Result<Samples> read_samples(const scan::ScanStream& scan, const std::filesystem::path& path,
                             const FieldOptions& options, uint64_t max_bytes);

}  // namespace surfcast::scattered
