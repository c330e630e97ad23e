#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "base/result.h"
#include "pick/pick_surfel.h"
#include "picture/picture.h"
#include "service/model_source.h"
#include "service/worker_pool.h"

namespace surfcast::service {

struct PickLimits {
  unsigned threads = 2;
  size_t waiting = 64;                    ///< picks that may be outstanding at a time
  size_t block_bytes = size_t{64} << 20;  ///< of decoded blocks that are kept for later picks
};

/// A request for the item that a picture shows in a pixel.
struct PickJob {
  std::string model;
  picture::PictureRequest request;  ///< camera, resolution, clip and hidden classes matter
  bool up_from_model = false;       ///< take the model's vertical axis as the camera's view_up
  int x = 0;                        ///< pixels from the left edge
  int y = 0;                        ///< pixels from the upper edge
};

/// Picks items in pictures, on threads of its own so that pictures are not delayed. Methods may be called from any
/// thread.
class PickService {
 public:
  using Done = std::function<void(Result<std::optional<kinds::PickedSurfel>>)>;

  /// `models` must outlive the service.
  explicit PickService(const ModelSource& models, const PickLimits& limits = {});
  /// Cancels the outstanding picks.
  ~PickService();

  /// `done` is called once: on a thread of the service, or, if too many picks wait already, before this call returns.
  /// It must not throw or block.
  void pick(PickJob job, Done done);

 private:
  [[nodiscard]] Result<std::optional<kinds::PickedSurfel>> run(const PickJob& job);

  const ModelSource& models_;
  std::atomic<bool> stopping_ = false;
  const size_t most_waiting_;
  std::atomic<size_t> waiting_ = 0;
  pick::SourceBlocks blocks_;
  WorkerPool pool_;  ///< last, so that its threads end first
};

}  // namespace surfcast::service
