#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "exporter/model_points.h"
#include "exporter/point_encoder.h"

namespace surfcast::service {

/// A request for the points of a region.
struct PointsJob {
  std::string model;
  exporter::ModelSelection selection;
  exporter::PointFormat format = exporter::PointFormat::kLas;
  uint64_t most = 0;        ///< more points than that are an error; 0: as many as PickLimits::region_points
  bool only_count = false;  ///< nothing is sent of them, so that there may be any number
};

/// Some bytes of a file of points.
struct PointPiece {
  std::vector<std::byte> bytes;  ///< may be empty
  bool last = false;
};

/// The points of a region as a file, which is made piece by piece as it is asked for. Holds a block or two and the
/// piece that is being made. Used by one thread at a time.
class PointStream {
 public:
  /// Once `cancelled` is true, counting and making pieces fail with kCancelled.
  static Result<std::unique_ptr<PointStream>> open(std::shared_ptr<const model::ModelFile> model, const PointsJob& job,
                                                   std::shared_ptr<const std::atomic<bool>> cancelled);

  /// Counts on for a turn; true once all is counted, which comes first. Fails as soon as there are more points than
  /// the job allows.
  Result<bool> count();
  /// The next bytes of the file: about as many, or fewer after a turn. To be called when all is counted.
  Result<PointPiece> next(size_t bytes);

  [[nodiscard]] const exporter::PointFacts& facts() const { return facts_; }
  /// The most points that are sent; more of them can only be counted.
  [[nodiscard]] uint64_t most() const { return most_; }
  /// Keeps something as long as the stream.
  void keep(std::shared_ptr<const void> kept) { kept_ = std::move(kept); }

 private:
  PointStream(exporter::ModelPoints points, const PointsJob& job, std::shared_ptr<const std::atomic<bool>> cancelled);
  Status prepare();
  Status add_block(PointPiece& piece);
  [[nodiscard]] Status check() const;

  exporter::ModelPoints points_;
  exporter::PointFormat format_;
  uint64_t most_;
  bool only_count_;
  exporter::WantedFacts wanted_;
  std::shared_ptr<const std::atomic<bool>> cancelled_;
  exporter::PointFacts facts_;
  size_t counted_ = 0;                               ///< pieces of the model
  size_t next_ = 0;                                  ///< likewise, of those that are sent
  std::unique_ptr<exporter::PointEncoder> encoder_;  ///< null until all is counted
  bool begun_ = false;
  std::shared_ptr<const void> kept_;
};

}  // namespace surfcast::service
