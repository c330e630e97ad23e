#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "access/authorization.h"
#include "base/result.h"
#include "pick/band.h"
#include "pick/front_surface.h"
#include "picture/channels.h"
#include "picture/picture.h"
#include "service/client_places.h"
#include "service/model_queries.h"
#include "service/model_source.h"
#include "service/point_stream.h"
#include "service/source_positions.h"
#include "service/worker_pool.h"

namespace surfcast::service {

struct PickLimits {
  unsigned threads = 2;
  size_t waiting = 64;                    ///< picks that may be outstanding at a time
  size_t block_bytes = size_t{64} << 20;  ///< of decoded blocks that are kept for later picks
  size_t profile_points = 1'000'000;      ///< of one profile
  size_t blocks = 256;                    ///< that one pick may read, see pick::pick_surfel
  uint64_t region_points = 100'000'000;   ///< of one region, see PointStream
  size_t regions = 16;                    ///< whose points may be on their way at a time
  size_t region_bytes = size_t{1} << 20;  ///< of the file of a region that are made at once
};

/// A request for the item that a picture shows in a pixel.
struct PickJob {
  access::AuthorizedModel model;
  picture::PictureRequest request{};  ///< camera, resolution, clip and hidden classes matter
  bool up_from_model = false;         ///< take the model's vertical axis as the camera's view_up
  int x = 0;                          ///< pixels from the left edge
  int y = 0;                          ///< pixels from the upper edge
};

/// What a picture shows in a pixel.
struct PickedPoint : kinds::PickedSurfel {
  std::optional<glm::dvec3> source_position;  ///< in the system of the source, where that is not the model's
  std::string model{};                        ///< of a joined model: the name of the one that the item is of
};

/// A request for what a picture shows in all its pixels.
struct SurfaceJob {
  access::AuthorizedModel model;
  picture::PictureRequest request;  ///< as in PickJob
  bool up_from_model = false;       ///< likewise
  picture::ChannelSet channels;     ///< that will be made of it; an error if the model cannot have one of them
};

/// A request for the points near a line.
struct ProfileJob {
  access::AuthorizedModel model;
  pick::BandQuery query{};  ///< `most`: 0 or more than PickLimits::profile_points: as many as that
};

/// A request for the points of a region.
struct PointsJob {
  access::AuthorizedModel model;
  PointsQuery query{};
};

/// The points near a line, and what is needed to describe them.
struct ProfileResult {
  pick::Band band;
  bool z_up = true;
  int color_bits = 0;
  std::vector<std::string> attributes;
};

/// Picks items in pictures, on threads of its own so that pictures are not delayed, in turns of the clients. Methods
/// may be called from any thread.
class PickService {
 public:
  using Done = std::function<void(Result<std::optional<PickedPoint>>)>;
  using ProfileDone = std::function<void(Result<ProfileResult>)>;
  /// Shared, because callbacks are copied.
  using PointsDone = std::function<void(Result<std::shared_ptr<PointStream>>)>;
  using PieceDone = std::function<void(Result<PointPiece>)>;
  using SurfaceDone = std::function<void(Result<std::vector<pick::FrontPixel>>)>;

  /// `models` must outlive the service. `queries`: null: this process answers.
  explicit PickService(const ModelSource& models, const PickLimits& limits = {},
                       std::shared_ptr<ModelQueries> queries = nullptr);
  /// Cancels the outstanding picks.
  ~PickService();

  /// `done` is called once: on a thread of the service, or, if too many picks wait already, before this call returns.
  /// It must not throw or block.
  void pick(PickJob job, const Done& done, ClientId client = 0);
  /// Searches all pixels, one picture after another, on a thread that does nothing else. `done` is called once, on that
  /// thread, with kCancelled soon after `cancelled` becomes true. The caller bounds the number of searches.
  void find_surface(SurfaceJob job, std::shared_ptr<const std::atomic<bool>> cancelled, SurfaceDone done,
                    ClientId client = 0);
  /// Finds the points near a line, on the same thread. At most PickLimits::waiting profiles may be outstanding. `done`
  /// as of pick().
  void profile(ProfileJob job, ProfileDone done, ClientId client = 0);
  /// Counts the points of a region, on the same thread, in turns with others. `done` as of pick(), with kCancelled soon
  /// after `cancelled` becomes true. Each stream that is alive has one of PickLimits::regions places, by ClientPlaces.
  void points(PointsJob job, std::shared_ptr<const std::atomic<bool>> cancelled, PointsDone done, ClientId client = 0);
  /// Makes the next piece of their file, likewise. One piece of a stream may be asked for at a time.
  void next_piece(std::shared_ptr<PointStream> stream, PieceDone done, ClientId client = 0);

 private:
  void count(const std::shared_ptr<PointStream>& stream, const PointsDone& done, ClientId client);
  [[nodiscard]] Result<std::shared_ptr<PointStream>> open_stream(PointsJob job,
                                                                 std::shared_ptr<const std::atomic<bool>> cancelled,
                                                                 std::shared_ptr<const void> place);
  [[nodiscard]] Result<ProfileResult> find_profile(const ProfileJob& job) const;
  [[nodiscard]] Result<std::optional<PickedPoint>> run(const PickJob& job);
  [[nodiscard]] Result<std::vector<pick::FrontPixel>> search(const SurfaceJob& job, const std::atomic<bool>& cancelled);

  const ModelSource& models_;
  const std::shared_ptr<ModelQueries> queries_;
  std::atomic<bool> stopping_ = false;
  const size_t most_waiting_;
  const size_t most_points_;
  const size_t most_blocks_;
  const uint64_t most_region_points_;
  const size_t region_bytes_;
  ClientPlaces regions_;
  std::atomic<size_t> waiting_ = 0;
  std::atomic<size_t> profiles_waiting_ = 0;
  SourcePositions source_positions_;
  // Last, so that their threads end first.
  WorkerPool pool_;
  WorkerPool searches_;  ///< one thread
};

}  // namespace surfcast::service
