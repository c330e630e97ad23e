#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "ellipsoid/ellipsoids.h"
#include "grid/grid_header.h"
#include "model/ellipsoid_source.h"
#include "scan/row_source.h"

namespace surfcast::ellipsoid {

/// How a file is read as ellipsoids.
struct InputOptions {
  std::optional<grid::TensorOrder> order{};  ///< of components whose order the file does not state
  std::optional<uint64_t> sample{};          ///< about as many samples, spread over the file, alone: a preview
  bool asked = false;                        ///< a table of semi-axes without rotations counts, too
  scan::DecodingLimit limit{};
};

/// The ellipsoids of a tensor field or a table, from the first sample to the last. Errors name the file.
class EllipsoidInput {
 public:
  EllipsoidInput() = default;
  EllipsoidInput(const EllipsoidInput&) = delete;
  EllipsoidInput& operator=(const EllipsoidInput&) = delete;
  virtual ~EllipsoidInput() = default;

  /// What the file states of all: name, grid, units, columns. No counts, ranges or scale.
  [[nodiscard]] virtual const model::EllipsoidSource& facts() const = 0;
  /// Samples that are read, and samples of the file.
  [[nodiscard]] virtual uint64_t samples() const = 0;
  [[nodiscard]] virtual uint64_t samples_of_file() const { return samples(); }
  [[nodiscard]] virtual bool z_up() const { return true; }
  [[nodiscard]] virtual bool has_colors() const { return false; }
  /// Memory of what is decoded as a whole, bytes.
  [[nodiscard]] virtual uint64_t held_bytes() const { return 0; }
  /// The files beside the input's own that hold the samples.
  [[nodiscard]] virtual std::vector<std::filesystem::path> data_files() const { return {}; }

  /// The ellipsoids of the next samples, of which there are some. Those that cannot be drawn are left out and counted.
  /// Ellipsoids::samples has a meaning on a grid alone. The result depends on the file alone.
  virtual Result<Ellipsoids> read(model::EllipsoidCounts& counts) = 0;
  [[nodiscard]] virtual bool at_end() const = 0;
  /// Begins again.
  virtual Status rewind() = 0;
};

using InputPtr = std::unique_ptr<EllipsoidInput>;

/// True if a file holds tensors, or is a table of ellipsoids, by its content.
[[nodiscard]] bool holds_ellipsoids(const std::filesystem::path& path, const InputOptions& options = {});

/// True for a legacy VTK file whose data set has points of its own.
[[nodiscard]] bool is_vtk_point_set(const std::filesystem::path& path);

/// Opens a tensor field (NRRD, VTK, NIfTI, MRtrix), tensors at points (legacy VTK), or a table (PLY, text).
Result<InputPtr> open_ellipsoids(const std::filesystem::path& path, const InputOptions& options = {});

}  // namespace surfcast::ellipsoid
