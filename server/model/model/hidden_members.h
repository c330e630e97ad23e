#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "model/model_file.h"

namespace surfcast::model {

/// For each member of a joined model whether it is among these names; empty if none is. Other names say nothing.
std::vector<bool> hidden_members(const ModelFile& model, std::span<const std::string> names);

/// The topmost blocks that stand for no hidden member, ascending: together they have all surfels of the others.
std::vector<uint32_t> shown_roots(const ModelFile& model, const std::vector<bool>& hidden_members);

}  // namespace surfcast::model
