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
#include "exporter/point_facts.h"

namespace surfcast::service {

class PickService;

/// The points of a region of an open model that are wanted.
struct PointsQuery {
  std::string model;  ///< its name, for the file
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

/// The points of a region as a file, which is made piece by piece as it is asked for. Once it is cancelled, counting
/// and making pieces fail with kCancelled. Used by one thread at a time.
class PointStream {
 public:
  /// `most`: of the job.
  explicit PointStream(uint64_t most) : most_(most) {}
  PointStream(const PointStream&) = delete;
  PointStream& operator=(const PointStream&) = delete;
  virtual ~PointStream() = default;

  /// Counts on for a turn; true once all is counted, which comes first. Fails as soon as there are more points than
  /// the job allows.
  virtual Result<bool> count() = 0;
  /// The next bytes of the file: about as many, or fewer after a turn. To be called when all is counted.
  virtual Result<PointPiece> next(size_t bytes) = 0;
  [[nodiscard]] virtual const exporter::PointFacts& facts() const = 0;

  /// The most points that are sent; more of them can only be counted.
  [[nodiscard]] uint64_t most() const { return most_; }
  /// Keeps something as long as the stream.
  void keep(std::shared_ptr<const void> kept) { kept_ = std::move(kept); }
  /// The service that makes the pieces; null until one has taken the stream.
  [[nodiscard]] PickService* service() const { return service_; }
  void set_service(PickService& service) { service_ = &service; }

 private:
  uint64_t most_;
  std::shared_ptr<const void> kept_;
  PickService* service_ = nullptr;
};

}  // namespace surfcast::service
