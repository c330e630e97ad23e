#include "volume/volume_pictures.h"

#include <cmath>
#include <cstring>

namespace surfcast::testing {

reference::LightPicture light_of(const picture::Image& image) {
  reference::LightPicture light(image.width, image.height);
  for (size_t i = 0; i < light.pixels.size(); ++i) {
    glm::vec4 pixel;
    std::memcpy(&pixel, image.pixels.data() + i * sizeof pixel, sizeof pixel);
    light.pixels[i] = glm::dvec4(pixel);
  }
  return light;
}

picture::PictureRequest request_of(const geometry::CameraFrame& frame) {
  picture::PictureRequest request;
  request.width = frame.width;
  request.height = frame.height;
  const double angle = 2 * std::atan(0.5 * frame.height / frame.eta) * 180 / M_PI;
  request.camera = geometry::Camera{frame.eye, frame.eye + frame.forward, frame.up, angle};
  request.format = picture::PixelFormat::kLinearFloat;
  return request;
}

double mean_opacity(const reference::LightPicture& picture) {
  double sum = 0;
  for (const glm::dvec4& pixel : picture.pixels) sum += pixel.w;
  return sum / static_cast<double>(picture.pixels.size());
}

}  // namespace surfcast::testing
