#pragma once

#include <span>

#include "grid/stored_grid.h"

namespace surfcast::grid {

/// True for the first 348 or more bytes of a NIfTI file, unpacked.
[[nodiscard]] bool looks_like_nifti(std::span<const std::byte> head);
/// The same for a file compressed by gzip.
[[nodiscard]] bool looks_like_packed_nifti(const stream::FilePtr& file);

/// NIfTI-1 and -2 in either byte order, packed by gzip or not; also pairs of .hdr and .img. The world is
/// right-anterior-superior where a transform is stated; sform goes before qform.
///
/// Written by hand and not with libniftiio: that library reads all samples at once into memory of the size that the
/// header states, and reports errors on stderr. The headers are two fixed records.
Result<StoredGrid> parse_nifti(const GridFile& file);

}  // namespace surfcast::grid
