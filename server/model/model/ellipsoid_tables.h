#pragma once

#include "base/result.h"
#include "model/byte_stream.h"
#include "model/format.h"

namespace surfcast::model {

/// The table of the sources of ellipsoids, the last one of a directory (docs/model-format.md).
void put_ellipsoid_sources(ByteWriter& writer, const Directory& directory);
/// Reads it. Fails on numbers that no source has.
Status get_ellipsoid_sources(ByteReader& reader, Directory& directory);

}  // namespace surfcast::model
