#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "builder/append_plan.h"
#include "builder/build_inputs.h"
#include "builder/former_points.h"
#include "model/model_file.h"
#include "scan/scan_schema.h"

namespace surfcast::builder {

/// A model and what is added to it.
struct AppendInputs {
  const model::ModelFile& model;
  const BuildInputs& added;
  scan::ScanSchema schema;  ///< of all points, with the columns of former ones
  FormerModel former;
  GrownRoot root;
  NewPoints places;
};

bool is_leaf(const model::ModelFile& model, uint32_t block);
std::vector<uint32_t> leaves_of(const model::ModelFile& model);

/// Pieces of inputs that are worked on at a time.
size_t append_threads();

}  // namespace surfcast::builder
