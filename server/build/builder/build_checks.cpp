#include "builder/build_checks.h"

#include <algorithm>
#include <string>
#include <system_error>

#include <unistd.h>

namespace surfcast::builder {

Status check_target(const std::filesystem::path& target, std::span<const std::filesystem::path> inputs) {
  const std::filesystem::path folder = target.parent_path().empty() ? "." : target.parent_path();
  std::error_code ignored;  // if a file does not exist, reading it reports the error
  if (!std::filesystem::is_directory(folder, ignored)) {
    return fail(ErrorKind::kIo, target.string() + ": no such folder: " + folder.string());
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    return fail(ErrorKind::kIo, target.string() + ": cannot write into the folder " + folder.string());
  }
  for (const std::filesystem::path& input : inputs) {
    if (std::filesystem::equivalent(input, target, ignored)) {
      return fail(ErrorKind::kInvalidInput, target.string() + ": is an input too and would be overwritten");
    }
  }
  return {};
}

Status check_bounds(const geometry::Box& bounds, const std::filesystem::path& subject) {
  // Far beyond any scan, and small enough for box sizes and their squares to stay finite.
  constexpr double kLimit = 1e150;
  if (bounds.empty()) {
    return fail(ErrorKind::kInvalidInput, subject.string() + ": no usable point is left of the input");
  }
  const glm::dvec3 farthest = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
  if (std::max({farthest.x, farthest.y, farthest.z}) < kLimit) return {};
  return fail(ErrorKind::kInvalidInput, subject.string() + ": a position of the input is too far away to be stored");
}

}  // namespace surfcast::builder
