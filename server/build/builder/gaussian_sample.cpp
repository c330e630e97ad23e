#include "builder/gaussian_sample.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/hash.h"
#include "gaussian/merge_gaussians.h"

namespace surfcast::builder {

GaussianSample::GaussianSample(uint64_t count, std::optional<uint64_t> wanted)
    : count_(count), wanted_(std::min(count, std::max<uint64_t>(wanted.value_or(count), 1))) {}

uint64_t GaussianSample::chosen_of(uint64_t group) const {
  const uint64_t first = first_of(group);
  return first + hash_of(std::as_bytes(std::span(&group, 1))) % (first_of(group + 1) - first);
}

void GaussianSample::thin(gaussian::Gaussians& run) {
  if (wanted_ == count_) return;
  const auto wider = static_cast<float>(std::sqrt(static_cast<double>(count_) / static_cast<double>(wanted_)));
  gaussian::Gaussians chosen;
  chosen.unusable = run.unusable;
  for (; group_ < wanted_ && chosen_of(group_) < passed_ + run.size(); ++group_) {
    if (chosen_of(group_) < passed_) continue;
    gaussian::append(run, chosen_of(group_) - passed_, chosen);
    chosen.scales.back() *= wider;
  }
  passed_ += run.size();
  run = std::move(chosen);
}

}  // namespace surfcast::builder
