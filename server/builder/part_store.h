#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "builder/build_inputs.h"
#include "builder/spool_file.h"
#include "scan/make_surfels.h"
#include "scan/scan_schema.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::builder {

/// Points of a part, its own before those of its halo, each in the order of the input.
struct PartPoints {
  surfel::SurfelCloud cloud;
  size_t own = 0;
  std::vector<size_t> inputs;  ///< of each of the cloud's sources: the number of the input
};

/// What was found out about the points of a part, for each in the order in which they are loaded.
struct PartFindings {
  std::vector<glm::vec3> normals;
  std::vector<float> radii;
  std::vector<uint32_t> trees;
  std::vector<uint8_t> kept;  ///< 0 for duplicates, which have no other findings
};

/// A name and a lattice for each input.
struct InputName {
  std::string name;
  std::optional<surfel::Grid> grid;
};

/// Rows of a piece of the input that belong to a part.
struct PartRows {
  uint32_t part = 0;
  bool own = true;
  std::vector<uint32_t> rows;
};

/// A piece of the input, sorted out by parts and packed.
struct PackedPiece {
  struct Run {
    uint32_t part = 0;
    bool own = true;
    uint64_t offset = 0;  ///< in `bytes`
    uint64_t rows = 0;
  };
  size_t source = 0;
  std::vector<Run> runs;
  std::vector<std::byte> bytes;
};

PackedPiece pack_piece(const InputPiece& piece, std::span<const PartRows> parts);

/// Keeps the points of all parts on disk while others are worked on.
class PartStore {
 public:
  PartStore(SpoolFile file, const scan::ScanSchema& schema, std::vector<InputName> inputs, size_t parts);

  /// One thread at a time; the order of the calls is the order of the points.
  Status add(const PackedPiece& piece);
  [[nodiscard]] uint64_t points(size_t part) const;  ///< halo included
  /// Any thread.
  [[nodiscard]] Result<PartPoints> load(size_t part) const;

  /// Keeps the findings of a part. One thread at a time.
  Status keep_findings(size_t part, const PartFindings& findings);
  /// Any thread.
  [[nodiscard]] Result<PartFindings> load_findings(size_t part) const;
  /// Gives the room of a part that is done with back. Any thread.
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
    uint64_t findings = 0;  ///< where they begin
  };

  SpoolFile file_;
  scan::ScanSchema schema_;
  std::vector<InputName> inputs_;
  uint64_t row_bytes_;
  std::vector<Stored> parts_;
};

}  // namespace surfcast::builder
