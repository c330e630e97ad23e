#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "base/result.h"
#include "builder/build_inputs.h"
#include "model/model_file.h"
#include "scan/scan_schema.h"

namespace surfcast::builder {

// What can be added to which model. Errors name what does not fit.

/// That nothing can be added to, or from.
tl::unexpected<Error> refuse_append(const std::filesystem::path& subject, const std::string& why);

/// Only models of scans alone, as this program builds them.
Status check_grown_model(const model::ModelFile& model);
Status check_added_scans(std::span<const std::filesystem::path> inputs);
/// Scans have no attribute, colour or precision that the model lacks.
Status check_added_columns(const BuildInputs& inputs, std::span<const std::filesystem::path> paths,
                           const scan::ScanSchema& model);

}  // namespace surfcast::builder
