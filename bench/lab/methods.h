#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lab/plain_rasterizer.h"
#include "lab/renderer_thread.h"
#include "lab/results.h"

namespace surfcast::lab {

/// A picture, and what drawing it took.
struct DrawnPicture {
  SrgbPicture picture;
  double milliseconds = 0;
  double processor_milliseconds = 0;
  std::vector<picture::StageTime> stages;
  uint64_t splats = 0;
};

/// Draws one model with every method. Both kernels have renderers of their own, on threads of their own.
class Methods {
 public:
  Methods();
  ~Methods();
  Methods(const Methods&) = delete;
  Methods& operator=(const Methods&) = delete;

  [[nodiscard]] static std::vector<MethodFacts> all();
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Changes the model.
  void open(std::shared_ptr<const model::ModelFile> model);
  /// The view that fits the model, where the request states none.
  geometry::Camera camera_of(const picture::PictureRequest& request);
  DrawnPicture draw(const std::string& method, const picture::PictureRequest& request);
  /// What the scan itself shows without aliasing: drawn with 4 x 4 times the pixels, then filtered with the pixel
  /// prefilter.
  SrgbPicture supersampled(const picture::PictureRequest& request);

 private:
  DrawnPicture draw_plain(PlainShape shape, const picture::PictureRequest& request);
  picture::Frame draw_frame(RendererThread& thread, const picture::PictureRequest& request);

  RendererThread ours_;
  RendererThread papers_;
  std::string device_;
  std::shared_ptr<const model::ModelFile> model_;
  std::unique_ptr<PlainRasterizer> rasterizer_;  ///< of the size of the last picture; made and used on our thread
  glm::ivec2 painted_{0};
};

}  // namespace surfcast::lab
