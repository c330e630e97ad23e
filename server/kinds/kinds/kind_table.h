#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "kinds/kind.h"
#include "model/model_file.h"

namespace surfcast::kinds {

/// The kinds that a program supports. The number of a kind is its index in the table.
using KindTable = std::span<const Kind* const>;

/// The kinds that every program supports.
KindTable built_in_kinds();

/// The number of each of ModelInfo::kinds. Fails on a kind that is not in the table; the error names it.
Result<std::vector<uint32_t>> find_kinds(const model::ModelFile& model, KindTable table);

}  // namespace surfcast::kinds
