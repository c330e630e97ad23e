#pragma once

#include <filesystem>
#include <span>

#include "base/result.h"
#include "geometry/box.h"

namespace surfcast::builder {

/// Finds errors of the target before the build, not after it.
Status check_target(const std::filesystem::path& target, std::span<const std::filesystem::path> inputs);

/// Fails if the positions are too far away to be stored, or if there are none. Errors name `subject`.
Status check_bounds(const geometry::Box& bounds, const std::filesystem::path& subject);

}  // namespace surfcast::builder
