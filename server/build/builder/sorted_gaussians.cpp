#include "builder/sorted_gaussians.h"

#include <cstring>
#include <utility>

#include "base/contract.h"

namespace surfcast::builder {
namespace {

/// A Gaussian in the spool; its coefficients follow.
struct GaussianRecord {
  glm::dvec3 position{0};
  glm::vec3 scale{0};
  glm::quat rotation{1, 0, 0, 0};
  float opacity = 0;
};

}  // namespace

GaussianSorter::GaussianSorter(std::filesystem::path target, const geometry::RootCube& root, int degree, uint64_t bytes)
    : root_(root),
      width_(3 * gaussian::harmonics_of(degree)),
      record_(sizeof(GaussianRecord) + width_ * sizeof(float)),
      records_(std::move(target), record_.size(), bytes) {}

Status GaussianSorter::add(const gaussian::Gaussians& gaussians) {
  SURFCAST_EXPECTS(gaussians.harmonics.size() == gaussians.size() * width_);
  for (size_t i = 0; i < gaussians.size(); ++i) {
    const GaussianRecord record{gaussians.positions[i], gaussians.scales[i], gaussians.rotations[i],
                                gaussians.opacities[i]};
    std::memcpy(record_.data(), &record, sizeof record);
    std::memcpy(record_.data() + sizeof record, gaussians.harmonics.data() + i * width_, width_ * sizeof(float));
    const uint64_t code = geometry::morton_code(root_, gaussians.positions[i]);
    if (Status status = records_.add(code, record_); !status) return status;
  }
  return {};
}

Result<gaussian::Gaussians> GaussianSorter::take(size_t count) {
  gaussian::Gaussians gaussians;
  gaussians.harmonics.resize(count * width_);
  const Status status = records_.take(count, [&](std::span<const std::byte> bytes) {
    GaussianRecord record;
    std::memcpy(&record, bytes.data(), sizeof record);
    std::memcpy(gaussians.harmonics.data() + gaussians.size() * width_, bytes.data() + sizeof record,
                width_ * sizeof(float));
    gaussians.positions.push_back(record.position);
    gaussians.scales.push_back(record.scale);
    gaussians.rotations.push_back(record.rotation);
    gaussians.opacities.push_back(record.opacity);
  });
  if (!status) return fail(status);
  return gaussians;
}

}  // namespace surfcast::builder
