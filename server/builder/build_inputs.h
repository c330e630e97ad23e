#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "geometry/box.h"
#include "scan/scan_schema.h"
#include "scan/scan_stream.h"
#include "scan/surfel_report.h"

namespace surfcast::builder {

/// Points of one input, cleaned, under the schema of the cloud.
struct InputPiece {
  size_t source = 0;
  scan::ScanPoints points;
};

/// All inputs of a build, as one stream of points of one schema.
class BuildInputs {
 public:
  /// Opens all inputs, which reads each of them once, holding no more decoded than `max_bytes`. `z_up` overrides what
  /// they say about the vertical axis.
  static Result<BuildInputs> open(std::span<const std::filesystem::path> paths, std::optional<bool> z_up,
                                  uint64_t max_bytes, const std::function<void(double)>& progress);

  [[nodiscard]] const scan::ScanSchema& schema() const { return schema_; }
  [[nodiscard]] const std::vector<scan::ScanStream>& streams() const { return streams_; }
  [[nodiscard]] uint64_t size() const;         ///< points, unusable ones included
  [[nodiscard]] geometry::Box bounds() const;  ///< of the usable positions
  [[nodiscard]] uint64_t held_bytes() const;   ///< of memory, for inputs that are decoded whole
  [[nodiscard]] size_t pieces() const { return pieces_.size(); }
  [[nodiscard]] std::vector<std::string> notes() const;

  /// Reads a piece; counts in `report` what it drops. Any thread.
  [[nodiscard]] Result<InputPiece> read(size_t piece, scan::SurfelReport& report) const;

 private:
  struct PieceOfInput {
    size_t source = 0;
    size_t piece = 0;
  };

  std::vector<scan::ScanStream> streams_;
  std::vector<PieceOfInput> pieces_;
  scan::ScanSchema schema_;
};

}  // namespace surfcast::builder
