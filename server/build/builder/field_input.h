#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "builder/grid_input.h"
#include "scattered/field_options.h"

namespace surfcast::builder {

/// What became of the samples of a scattered field.
struct InputField {
  std::string input;     ///< file name without its folders
  uint64_t samples = 0;  ///< that are in the field
  uint64_t skipped = 0;  ///< see scattered::Samples
  uint64_t widened = 0;  ///< kernels that the lattice does not resolve
  double step = 0;       ///< of the lattice, world units
};

/// True if the file can be read as a table of points, within so many bytes of memory, and has the column of values.
[[nodiscard]] bool holds_field(const std::filesystem::path& path, const scattered::FieldOptions& options,
                               uint64_t memory);

/// Evaluates scattered samples on a regular lattice, which waits in a temporary file beside the target, and is read
/// like a grid. `memory`: bytes that the samples may take. `sample`: most samples of the lattice, for a preview. Adds
/// to `report`. Every error names the file.
Result<GridInput> open_field(const std::filesystem::path& path, const scattered::FieldOptions& options,
                             const std::filesystem::path& target, uint64_t memory, std::optional<uint64_t> sample,
                             std::vector<InputField>& report);

}  // namespace surfcast::builder
