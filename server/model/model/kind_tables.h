#pragma once

#include <cstdint>

#include "base/result.h"
#include "model/byte_stream.h"
#include "model/format.h"

namespace surfcast::model {

/// The tables of volumes and bricks, the last ones of a directory (docs/model-format.md).
void put_volumes(ByteWriter& writer, const Directory& directory);
/// Reads them into a directory whose blocks and kinds have been read. Fails on volumes that are none, and on bricks
/// outside their volume.
Status get_volumes(ByteReader& reader, Directory& directory);

/// True if the block is the top level of its volume, or its parent is the brick that stands for it.
[[nodiscard]] bool is_within_pyramid(const Directory& directory, const BlockRecord& block);

/// The table of the sources of ellipsoids, the last one of a directory (docs/model-format.md).
void put_ellipsoid_sources(ByteWriter& writer, const Directory& directory);
/// Reads it. Fails on numbers that no source has.
Status get_ellipsoid_sources(ByteReader& reader, Directory& directory);

}  // namespace surfcast::model
