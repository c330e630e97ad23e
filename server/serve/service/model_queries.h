#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "kinds/source_block.h"
#include "model/model_file.h"
#include "pick/band.h"
#include "pick/front_surface.h"
#include "picture/picture.h"
#include "service/point_stream.h"

namespace surfcast::service {

/// A picture about whose contents something is asked.
struct SurfaceQuery {
  picture::PictureRequest request;  ///< camera, resolution, clip and hidden classes matter
  bool up_from_model = false;       ///< take the model's vertical axis as the camera's view_up
};

/// A pixel of it.
struct PixelQuery {
  SurfaceQuery picture;
  int x = 0;  ///< pixels from the left edge
  int y = 0;  ///< pixels from the upper edge
  size_t most_blocks = 0;
};

/// Answers what takes the blocks of open models to answer, in this process or in others. Thread-safe. Everything fails
/// with kCancelled soon after its `cancelled` becomes true.
class ModelQueries {
 public:
  using ModelPointer = std::shared_ptr<const model::ModelFile>;

  virtual ~ModelQueries() = default;

  /// See pick::pick_surfel.
  virtual Result<std::optional<kinds::PickedSurfel>> pick(const ModelPointer& model, const PixelQuery& query,
                                                          const std::atomic<bool>& cancelled) = 0;
  /// See pick::find_front_surface.
  virtual Result<std::vector<pick::FrontPixel>> front_surface(const ModelPointer& model, const SurfaceQuery& query,
                                                              const std::atomic<bool>& cancelled) = 0;
  /// See pick::find_band.
  virtual Result<pick::Band> band(const ModelPointer& model, const pick::BandQuery& query,
                                  const std::atomic<bool>& cancelled) = 0;
  virtual Result<std::unique_ptr<PointStream>> points(const ModelPointer& model, const PointsQuery& query,
                                                      std::shared_ptr<const std::atomic<bool>> cancelled) = 0;
};

}  // namespace surfcast::service
