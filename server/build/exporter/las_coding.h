#pragma once

#include "exporter/las_counts.h"
#include "laz/chunk_encoders.h"

namespace surfcast::exporter {

/// How the records of LAZ are coded.
inline laz::Coding coding_of(const LasHead& head) {
  return {*laz::record_layout(head.point_format, head.record_length), head.chunk_size};
}

}  // namespace surfcast::exporter
