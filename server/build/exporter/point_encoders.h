#pragma once

#include <cstdint>
#include <memory>

#include "exporter/point_encoder.h"

namespace surfcast::exporter {

/// A text of numbers between commas (RFC 4180, but for lines that end as on Unix), with a line of names first. Every
/// number has as many digits as give it back exactly.
std::unique_ptr<PointEncoder> make_csv_encoder(scan::ScanSchema schema);

/// LAS, or LAZ whose chunk table is found from the end of the file, so that nothing is written twice. The schema has
/// the lattice that coordinates are to be on, if there is one.
Result<std::unique_ptr<PointEncoder>> make_las_encoder(const scan::ScanSchema& schema, const PointFacts& facts,
                                                       const EncoderOptions& options, bool compressed);

/// A file of NumPy (NEP 1, version 1.0) with a structured array of `count` rows: positions as doubles, all attributes
/// in their types.
std::unique_ptr<PointEncoder> make_npy_encoder(scan::ScanSchema schema, uint64_t count);

/// Binary PLY with `count` vertices: positions as doubles, all attributes in their types. Integers of 64 bits, which
/// PLY lacks, become doubles.
std::unique_ptr<PointEncoder> make_ply_encoder(scan::ScanSchema schema, uint64_t count);

}  // namespace surfcast::exporter
