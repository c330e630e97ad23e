#pragma once

#include <memory>

#include "exporter/point_encoder.h"

namespace surfcast::exporter {

/// A text of numbers between commas (RFC 4180, but for lines that end as on Unix), with a line of names first. Every
/// number has as many digits as give it back exactly.
std::unique_ptr<PointEncoder> make_csv_encoder(scan::ScanSchema schema);

}  // namespace surfcast::exporter
