#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "builder/build_inputs.h"
#include "builder/input_files.h"
#include "builder/mesh_input.h"
#include "builder/place_inputs.h"
#include "estimation/stated_radii.h"
#include "grid/grid_header.h"
#include "scan/selection.h"
#include "scattered/field_options.h"
#include "simplify/simplify.h"

namespace surfcast::builder {

struct BuildOptions {
  std::optional<double> precision;      ///< largest position error, world units; none: 1/256 of each radius
  std::optional<bool> z_up;             ///< vertical axis z (true) or y; none: as each scan's format or points suggest
  std::optional<uint64_t> memory;       ///< limit of resident memory, bytes; none: a quarter of the machine's memory
  std::optional<uint64_t> part_points;  ///< largest number of points of a part; none: as the memory allows
  std::optional<size_t> parts{};        ///< parts that scans are divided into; none: as the memory allows
  estimation::RadiusPolicy radii = estimation::RadiusPolicy::kAuto;
  std::optional<uint64_t> sample{};  ///< points of each scan, spread over it, that a preview is made of; none: all
  std::optional<simplify::ErrorBound> simplify{};  ///< of the surfaces of scans; none: every point is kept
  scan::Selection selection{};                     ///< points of scans that are read, where `open` does not read them
  MeshOptions meshes{};
  SystemOptions systems{};          ///< where scans and meshes lie on the earth
  OpenInput open{};                 ///< how scans and grids are read as points; none: grids become volumes
  std::optional<InputKind> kind{};  ///< of all inputs, whatever their content; none: as it says
  std::optional<scattered::FieldOptions> field{};   ///< scans with its column of values become volumes
  std::optional<grid::TensorOrder> tensor_order{};  ///< of six components that nothing says the order of
};

}  // namespace surfcast::builder
