#pragma once

#include <cstdint>
#include <vector>

#include "model/model_file.h"

namespace surfcast::pick {

/// For each block the number of its first item, if it is a leaf: the items of the leaves before it in the file. These
/// numbers name the surfels of a model file. A model that is built again may number them otherwise.
std::vector<uint64_t> leaf_numbers(const model::ModelFile& model);

}  // namespace surfcast::pick
