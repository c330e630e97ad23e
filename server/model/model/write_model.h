#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "base/result.h"
#include "model/model_writer.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::model {

struct WriteOptions {
  std::optional<double> precision{};       ///< largest position error, world units; none: 1/256 of each radius
  std::function<void(double)> progress{};  ///< called with the finished fraction, in [0, 1], by one thread at a time
};

/// Writes a cloud with weights as a model file, on all threads. The bytes do not depend on the number of threads. The
/// target file appears only when it is complete. Fails on an empty cloud, on values that a model cannot hold (a radius
/// or weight that is not positive and finite, coordinates beyond 1e150), and if the target cannot be written.
Result<WriteReport> write_model(const surfel::SurfelCloud& cloud, const std::filesystem::path& target,
                                const WriteOptions& options);

}  // namespace surfcast::model
