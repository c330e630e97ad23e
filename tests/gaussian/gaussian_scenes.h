#pragma once

#include <filesystem>
#include <memory>

#include "model/model_file.h"
#include "reference/gaussian_model.h"
#include "render/renderer.h"

namespace surfcast::testing {

/// The model with the numbers that a file of single precision holds.
reference::GaussianModel in_single_precision(reference::GaussianModel model);

/// Writes a 3DGS PLY file, or one of 2DGS with two scales.
std::filesystem::path write_ply(const std::filesystem::path& path, const reference::GaussianModel& model,
                                bool flat = false);

using ModelPointer = std::shared_ptr<const model::ModelFile>;

/// Builds a file and opens the model. `memory`: of the build, bytes.
ModelPointer build_and_open(const std::filesystem::path& input, const std::filesystem::path& target,
                            std::optional<uint64_t> memory = {});

picture::Frame draw(render::Renderer& renderer, const ModelPointer& model, const picture::PictureRequest& request);

}  // namespace surfcast::testing
