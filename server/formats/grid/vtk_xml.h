#pragma once

#include "grid/stored_grid.h"

namespace surfcast::grid {

/// ImageData of VTK's XML format (.vti) in one piece: numbers as text, base64 or appended, as they are or compressed by
/// zlib. The elements are parsed by expat as far as the numbers; these are read from the file, not through the parser.
Result<StoredGrid> parse_vtk_xml(const GridFile& file);

}  // namespace surfcast::grid
