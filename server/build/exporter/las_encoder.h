#pragma once

#include <memory>

#include "exporter/point_encoder.h"

namespace surfcast::exporter {

/// LAS, or LAZ whose chunk table is found from the end of the file, so that nothing is written twice. The schema has
/// the lattice that coordinates are to be on, if there is one.
Result<std::unique_ptr<PointEncoder>> make_las_encoder(const scan::ScanSchema& schema, const PointFacts& facts,
                                                       const EncoderOptions& options, bool compressed);

}  // namespace surfcast::exporter
