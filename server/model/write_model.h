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
  std::function<void(double)> progress{};  ///< called with the part that is done, in [0, 1], from any one thread
};

/// Writes a cloud with weights as a model file, on all threads; the bytes do not depend on their number. The target
/// appears when it is whole. Fails on an empty cloud, on values that no model holds (a radius or weight that is not
/// positive and finite, coordinates beyond 1e150), and when the target cannot be written.
Result<WriteReport> write_model(const surfel::SurfelCloud& cloud, const std::filesystem::path& target,
                                const WriteOptions& options);

}  // namespace surfcast::model
