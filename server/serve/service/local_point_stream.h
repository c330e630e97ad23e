#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

#include "base/result.h"
#include "exporter/model_points.h"
#include "exporter/point_encoder.h"
#include "service/point_stream.h"

namespace surfcast::service {

/// A stream whose blocks are decoded in this process. Holds a block or two and the piece that is being made.
class LocalPointStream : public PointStream {
 public:
  static Result<std::unique_ptr<PointStream>> open(std::shared_ptr<const model::ModelFile> model,
                                                   const PointsQuery& query,
                                                   std::shared_ptr<const std::atomic<bool>> cancelled);

  Result<bool> count() override;
  Result<PointPiece> next(size_t bytes) override;
  [[nodiscard]] const exporter::PointFacts& facts() const override { return facts_; }

 private:
  LocalPointStream(exporter::ModelPoints points, const PointsQuery& query,
                   std::shared_ptr<const std::atomic<bool>> cancelled);
  Status prepare();
  Status add_block(PointPiece& piece);
  [[nodiscard]] Status check() const;

  exporter::ModelPoints points_;
  exporter::PointFormat format_;
  bool only_count_;
  exporter::WantedFacts wanted_;
  std::shared_ptr<const std::atomic<bool>> cancelled_;
  exporter::PointFacts facts_;
  size_t counted_ = 0;                               ///< pieces of the model
  size_t next_ = 0;                                  ///< likewise, of those that are sent
  std::unique_ptr<exporter::PointEncoder> encoder_;  ///< null until all is counted
  bool begun_ = false;
};

}  // namespace surfcast::service
