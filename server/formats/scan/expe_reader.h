#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Reads an Expe point set (Pointshop3D), binary: a text header, then records of position, radius, normal and colour in
/// the order in which the header names them. Floats of 4 bytes, colours of 4 (red, green, blue, alpha). Other
/// properties are skipped by their stated size. The text variant is refused by name.
Result<std::unique_ptr<RowSource>> expe_rows(std::span<const std::byte> bytes);

}  // namespace surfcast::scan
