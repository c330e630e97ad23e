#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/spool_file.h"
#include "builder/build_inputs.h"
#include "estimation/make_surfels.h"
#include "scan/scan_schema.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::builder {

/// The points of a part: own points before those of its halo, both in input order.
struct PartPoints {
  surfel::SurfelCloud cloud;
  size_t own = 0;
  std::vector<size_t> inputs;  ///< for each source of the cloud, the index of the input
};

/// Results for the points of a part, in the order of its sorted points.
struct PartFindings {
  std::vector<uint32_t> order;  ///< the numbers of the sorted points before they were sorted (see spatial_order.h)
  std::vector<glm::vec3> normals;
  std::vector<float> radii;  ///< estimated ones
  std::vector<uint32_t> trees;
  std::vector<estimation::PointKind> kinds;
  std::vector<uint8_t> kept;  ///< 0 for duplicates, whose other entries are unused
};

/// The name and the lattice of an input.
struct InputName {
  std::string name;
  std::optional<surfel::Grid> grid;
};

/// The rows of an input piece that belong to a part.
struct PartRows {
  uint32_t part = 0;
  bool own = true;
  std::vector<uint32_t> rows;
};

/// An input piece, sorted by parts and packed.
struct PackedPiece {
  struct Run {
    uint32_t part = 0;
    bool own = true;
    uint64_t offset = 0;  ///< index in `bytes`
    uint64_t rows = 0;
  };
  size_t source = 0;
  std::vector<Run> runs;
  std::vector<std::byte> bytes;
};

PackedPiece pack_piece(const InputPiece& piece, std::span<const PartRows> parts);

/// Stores the points of all parts on disk.
class PartStore {
 public:
  PartStore(SpoolFile file, const scan::ScanSchema& schema, std::vector<InputName> inputs, size_t parts);

  /// Must be called by one thread at a time. The order of the calls is the order of the points.
  Status add(const PackedPiece& piece);
  [[nodiscard]] uint64_t points(size_t part) const;  ///< including the halo
  /// Thread-safe.
  [[nodiscard]] Result<PartPoints> load(size_t part) const;

  /// Stores the findings of a part. Must be called by one thread at a time.
  Status keep_findings(size_t part, const PartFindings& findings);
  /// Thread-safe.
  [[nodiscard]] Result<PartFindings> load_findings(size_t part) const;
  /// Releases the disk space of a part that is no longer needed. Thread-safe.
  void release(size_t part) const;

 private:
  struct Extent {
    size_t source = 0;
    bool own = true;
    uint64_t offset = 0;
    uint64_t rows = 0;
  };
  struct Stored {
    std::vector<Extent> extents;
    uint64_t findings = 0;  ///< offset in the file
  };

  SpoolFile file_;
  scan::ScanSchema schema_;
  std::vector<InputName> inputs_;
  uint64_t row_bytes_;
  std::vector<Stored> parts_;
};

}  // namespace surfcast::builder
