#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "base/spool_file.h"
#include "exporter/record_places.h"
#include "exporter/record_spool.h"

namespace surfcast::exporter {

/// A cell of an octree whose points are in memory together.
struct RecordPart {
  ldc::OctreeKey key;
  uint64_t first = 0;  ///< the least Morton code of the cell
  uint64_t count = 0;  ///< of its points
};

/// How large parts may be.
struct PartLimits {
  uint64_t points = 0;  ///< cells with more are divided, unless all their points have one Morton code
  int depth = 0;        ///< of cells that are not divided in any case
};

/// Point records by cells of an octree: the largest cells that the limits allow. Records that the spool has on disk are
/// brought together in a temporary file beside the target; those in memory stay there as one part.
class RecordParts {
 public:
  /// `places` outlives the parts.
  RecordParts(const RecordPlaces& places, const PartLimits& limits) : places_(places), limits_(limits) {}

  /// Takes all records of the spool.
  Status divide(RecordSpool& spool, const std::filesystem::path& target);
  /// In the order of their codes.
  [[nodiscard]] const std::vector<RecordPart>& parts() const { return parts_; }
  /// The records of a part, once.
  Result<std::vector<std::byte>> take(size_t part);

 private:
  /// The points of a cell.
  struct CellCount;
  struct Extent {
    uint64_t offset = 0;
    size_t size = 0;
  };

  [[nodiscard]] bool is_divided(const CellCount& cell) const;
  Result<std::vector<CellCount>> count_cells(RecordSpool& spool, int depth,
                                             const std::function<bool(uint64_t)>& wanted) const;
  Result<std::vector<CellCount>> count_points(RecordSpool& spool) const;
  Status refine(RecordSpool& spool, std::vector<CellCount>& cells, int depth, int finer_depth) const;
  void choose(std::span<const CellCount> cells, const ldc::OctreeKey& key, uint64_t first);
  [[nodiscard]] size_t part_of(uint64_t code) const;
  Status distribute(std::span<const std::byte> records);

  const RecordPlaces& places_;
  PartLimits limits_;
  std::vector<RecordPart> parts_;
  std::vector<std::byte> resident_;           ///< all records, if they are in memory
  std::optional<SpoolFile> file_;             ///< or else the records by parts
  std::vector<std::vector<Extent>> extents_;  ///< of the parts in the file
};

}  // namespace surfcast::exporter
