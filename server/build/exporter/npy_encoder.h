#pragma once

#include <cstdint>
#include <memory>

#include "exporter/point_encoder.h"

namespace surfcast::exporter {

/// A file of NumPy (NEP 1, version 1.0) with a structured array of `count` rows: positions as doubles, all attributes
/// in their types.
std::unique_ptr<PointEncoder> make_npy_encoder(scan::ScanSchema schema, uint64_t count);

}  // namespace surfcast::exporter
