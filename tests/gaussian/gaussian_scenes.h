#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "model/model_file.h"
#include "reference/gaussian_model.h"
#include "render/renderer.h"

namespace surfcast::testing {

/// The model with the numbers that a file of single precision holds.
reference::GaussianModel in_single_precision(reference::GaussianModel model);

/// What a file holds, harmonics up to the third degree. Fails the test on a file that cannot be read.
reference::GaussianModel reference_model(const std::filesystem::path& path);

/// Writes a 3DGS PLY file, or one of 2DGS with two scales.
std::filesystem::path write_ply(const std::filesystem::path& path, const reference::GaussianModel& model,
                                bool flat = false);

/// Writes a model without harmonics as SPZ 2, whose numbers have few bits, and says that it was trained with
/// compensated opacities. reference_model() returns what the file holds.
std::filesystem::path write_antialiased_spz(const std::filesystem::path& path, const reference::GaussianModel& model);

using ModelPointer = std::shared_ptr<const model::ModelFile>;

/// Builds a file and opens the model. `memory`: of the build, bytes.
ModelPointer build_and_open(const std::filesystem::path& input, const std::filesystem::path& target,
                            std::optional<uint64_t> memory = {});

picture::Frame draw(render::Renderer& renderer, const ModelPointer& model, const picture::PictureRequest& request);

}  // namespace surfcast::testing
