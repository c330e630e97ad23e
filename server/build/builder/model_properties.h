#pragma once

#include <span>
#include <string>
#include <vector>

#include "builder/build_inputs.h"
#include "builder/build_report.h"
#include "estimation/stated_radii.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::builder {

/// What became of the radii of the inputs that state some.
std::vector<InputRadii> radii_of(std::span<const scan::ScanSchema> inputs,
                                 std::span<const estimation::RadiusDecision> decisions);

/// One line for each input whose radii are not used although they should be.
std::vector<std::string> unused_radii(estimation::RadiusPolicy policy, std::span<const InputRadii> radii);

/// A cloud without surfels that has the common properties of all clouds of the model.
surfel::SurfelCloud common_cloud(const BuildInputs& inputs, bool oriented);

/// True if all inputs are samples of meshes as sample_mesh makes them, and keep their radii.
bool is_even(const BuildInputs& inputs, estimation::RadiusPolicy policy);

}  // namespace surfcast::builder
