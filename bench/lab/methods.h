#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lab/plain_rasterizer.h"
#include "lab/renderer_thread.h"
#include "lab/results.h"

namespace surfcast::lab {

/// A picture and the cost of drawing it.
struct DrawnPicture {
  SrgbPicture picture;
  double milliseconds = 0;
  double processor_milliseconds = 0;
  std::vector<picture::StageTime> stages;
  uint64_t splats = 0;
};

/// Draws one model with every method. Each of the two kernels has its own renderer on its own thread.
class Methods {
 public:
  Methods();
  ~Methods();
  Methods(const Methods&) = delete;
  Methods& operator=(const Methods&) = delete;

  [[nodiscard]] static std::vector<MethodFacts> all();
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Replaces the model.
  void open(std::shared_ptr<const model::ModelFile> model);
  /// The camera of the request or, without one, the camera that fits the model.
  geometry::Camera camera_of(const picture::PictureRequest& request);
  DrawnPicture draw(const std::string& method, const picture::PictureRequest& request);
  /// A picture of the scan without aliasing: drawn with 4 x 4 samples per pixel, then filtered with the pixel
  /// prefilter.
  SrgbPicture supersampled(const picture::PictureRequest& request);

 private:
  DrawnPicture draw_plain(PlainShape shape, const picture::PictureRequest& request);
  picture::Frame draw_frame(RendererThread& thread, const picture::PictureRequest& request);

  RendererThread ours_;
  RendererThread papers_;
  std::string device_;
  std::shared_ptr<const model::ModelFile> model_;
  std::unique_ptr<PlainRasterizer> rasterizer_;  ///< for the size of the last picture; belongs to the thread of `ours_`
  glm::ivec2 painted_{0};
};

}  // namespace surfcast::lab
