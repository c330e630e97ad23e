#pragma once

#include <string>
#include <vector>

#include "model/model_file.h"
#include "surfcast.pb.h"

namespace surfcast::cmd {

/// A line for each option of a picture that has no effect on a model, because the model has nothing that it is about.
[[nodiscard]] std::vector<std::string> unused_options(const wire::DrawPicture& request, const model::ModelInfo& info);

}  // namespace surfcast::cmd
