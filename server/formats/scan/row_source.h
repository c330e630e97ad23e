#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/point_table.h"
#include "surfel/grid.h"

namespace surfcast::scan {

/// Rows of one piece: enough to keep a core busy, few enough to hold one piece per core in memory.
inline constexpr uint64_t kPieceRows = uint64_t{1} << 18;

/// Properties of a file beside its rows.
struct RowTraits {
  std::optional<surfel::Grid> grid;  ///< the lattice of all positions
  std::optional<glm::dvec3> sensor;  ///< scanner position
  bool z_up = true;
  bool may_be_graphics = false;        ///< z-up only if the points look like a survey (up_axis.h); else y-up
  bool from_text = false;              ///< scalars get the smallest type that holds all their values
  bool counted = false;                ///< a PTS file
  uint64_t announced = 0;              ///< number of rows that the file states before the first row
  std::optional<double> surface_step;  ///< see ScanSchema
  bool exact_radii = false;            ///< see ScanSchema
  bool two_sided = false;              ///< see ScanSchema
  std::string crs;                     ///< see ScanSchema
  std::vector<std::string> notes;      ///< see ScanSchema
  bool sampled = false;  ///< these are a part of the rows, so that radii stated for all of them are too small
};

/// Limits the memory of formats that can only be decoded as a whole.
struct DecodingLimit {
  uint64_t max_bytes = UINT64_MAX;

  [[nodiscard]] Status check(uint64_t bytes) const;
};

/// An error if a file states more rows than it holds.
[[nodiscard]] Status check_announced(uint64_t rows, uint64_t announced);

/// The rows of a file in pieces. Pieces can be read in any order and from any thread. All pieces have the same columns,
/// and at least one piece has a row.
class RowSource {
 public:
  RowSource() = default;
  RowSource(const RowSource&) = delete;
  RowSource& operator=(const RowSource&) = delete;
  virtual ~RowSource() = default;

  [[nodiscard]] virtual const RowTraits& traits() const = 0;
  /// Names and types. If all names are empty, the first three columns are x, y and z, and the others are guessed.
  [[nodiscard]] virtual const std::vector<ColumnInfo>& columns() const = 0;
  [[nodiscard]] virtual size_t pieces() const = 0;
  [[nodiscard]] virtual Result<PointTable> read(size_t piece) const = 0;
  /// Memory of decoded rows for the lifetime of this object, bytes.
  [[nodiscard]] virtual uint64_t held_bytes() const { return 0; }
};

}  // namespace surfcast::scan
