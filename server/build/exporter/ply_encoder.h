#pragma once

#include <cstdint>
#include <memory>

#include "exporter/point_encoder.h"

namespace surfcast::exporter {

/// Binary PLY with `count` vertices: positions as doubles, all attributes in their types. Integers of 64 bits, which
/// PLY lacks, become doubles.
std::unique_ptr<PointEncoder> make_ply_encoder(scan::ScanSchema schema, uint64_t count);

}  // namespace surfcast::exporter
