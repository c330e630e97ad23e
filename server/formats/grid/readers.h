#pragma once

#include <span>

#include "grid/stored_grid.h"

namespace surfcast::grid {

/// True if text begins like a MetaImage header: a line "Key = Value" with a key of the format.
[[nodiscard]] bool looks_like_meta_image(std::string_view text);

/// MetaImage, with its samples in the same file (.mha) or beside it (.mhd): raw, zlib or text; one file, a list or a
/// pattern (https://itk.org/Wiki/ITK/MetaIO/Documentation).
Result<StoredGrid> parse_meta_image(const GridFile& file);

/// True for the first bytes of an image of MRtrix3, packed by gzip or not.
[[nodiscard]] bool looks_like_mrtrix(const stream::FilePtr& file);

/// MRtrix3: .mif, .mif.gz, and .mih with its data file. Axes in any order; i is the axis that is stored fastest. Six
/// images along the fourth axis are tensors xx yy zz xy xz yz in the axes of the world, which is
/// right-anterior-superior.
Result<StoredGrid> parse_mrtrix(const GridFile& file);

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

/// NRRD, versions 1 to 5, header and samples in one file or not (https://teem.sourceforge.net/nrrd/format.html). Not
/// read: hexadecimal data, blocks, and components that do not lie next to each other.
Result<StoredGrid> parse_nrrd(const GridFile& file);

/// Structured points of VTK's legacy format, text or binary (big endian): scalars and tensors, of points or cells.
Result<StoredGrid> parse_vtk_legacy(const GridFile& file);

/// ImageData of VTK's XML format (.vti) in one piece: numbers as text, base64 or appended, as they are or compressed by
/// zlib. The elements are parsed by expat as far as the numbers; these are read from the file, not through the parser.
Result<StoredGrid> parse_vtk_xml(const GridFile& file);

}  // namespace surfcast::grid
