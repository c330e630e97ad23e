#include "builder/model_properties.h"

#include <algorithm>

#include "builder/cloud_columns.h"

namespace surfcast::builder {

std::vector<InputRadii> radii_of(std::span<const scan::ScanSchema> inputs,
                                 std::span<const estimation::RadiusDecision> decisions) {
  std::vector<InputRadii> radii;
  for (size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].radii) radii.push_back({inputs[i].name, decisions[i]});
  }
  return radii;
}

std::vector<std::string> unused_radii(estimation::RadiusPolicy policy, std::span<const InputRadii> radii) {
  std::vector<std::string> lines;
  if (policy == estimation::RadiusPolicy::kEstimate) return lines;
  for (const auto& [input, decision] : radii) {
    if (decision.outcome == estimation::RadiusOutcome::kEstimated)
      lines.push_back(input + ": " + estimation::describe(decision));
  }
  return lines;
}

surfel::SurfelCloud common_cloud(const BuildInputs& inputs, bool oriented) {
  surfel::SurfelCloud cloud = empty_cloud(inputs.schema(), 0);
  cloud.oriented = oriented;
  for (const scan::ScanSchema& input : inputs.schemas()) {
    cloud.sources.push_back({input.name, 0, 0, input.grid});
  }
  return cloud;
}

bool is_even(const BuildInputs& inputs, estimation::RadiusPolicy policy) {
  return policy != estimation::RadiusPolicy::kEstimate &&
         std::all_of(inputs.schemas().begin(), inputs.schemas().end(),
                     [](const scan::ScanSchema& input) { return input.exact_radii; });
}

}  // namespace surfcast::builder
