#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "base/result.h"
#include "scan/point_table.h"
#include "surfel/grid.h"

namespace surfcast::scan {

/// Rows of one piece: enough to keep a core busy, few enough that every core can have one in memory.
inline constexpr uint64_t kPieceRows = uint64_t{1} << 18;

/// What a file says beside its rows, and how its format is to be understood.
struct RowTraits {
  std::optional<surfel::Grid> grid;  ///< the lattice of all positions
  std::optional<glm::dvec3> sensor;  ///< where the scanner stood
  bool z_up = true;
  bool may_be_graphics = false;  ///< z-up only if the points look like a survey (up_axis.h); else y-up
  bool from_text = false;        ///< scalars take the smallest type that holds them all
  bool counted = false;          ///< a PTS file
  uint64_t announced = 0;        ///< rows that it states before the first of them
};

/// A file of a format that can only be decoded whole must not take more memory for that than this.
struct DecodingLimit {
  uint64_t max_bytes = UINT64_MAX;

  [[nodiscard]] Status check(uint64_t bytes) const;
};

/// The rows of a file in pieces that are read in any order and from any thread. All pieces have the same columns, and
/// at least one of them a row.
class RowSource {
 public:
  RowSource() = default;
  RowSource(const RowSource&) = delete;
  RowSource& operator=(const RowSource&) = delete;
  virtual ~RowSource() = default;

  [[nodiscard]] virtual const RowTraits& traits() const = 0;
  /// Names and types; without names (all empty) the first three are x, y and z, the others are guessed.
  [[nodiscard]] virtual const std::vector<ColumnInfo>& columns() const = 0;
  [[nodiscard]] virtual size_t pieces() const = 0;
  [[nodiscard]] virtual Result<PointTable> read(size_t piece) const = 0;
  /// Memory that decoded rows take for as long as this lives.
  [[nodiscard]] virtual uint64_t held_bytes() const { return 0; }
};

}  // namespace surfcast::scan
