#include "lab/srgb_pictures.h"

#include <glm/vec4.hpp>

namespace surfcast::lab {

SrgbPicture picture_of(const picture::Image& image) {
  SrgbPicture picture{image.width, image.height, {}};
  const auto* pixels = reinterpret_cast<const glm::u8vec4*>(image.pixels.data());
  for (int i = 0; i < image.width * image.height; ++i) picture.pixels.emplace_back(pixels[i]);
  return picture;
}

}  // namespace surfcast::lab
