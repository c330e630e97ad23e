#include "service/picture_channels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "base/contract.h"
#include "geometry/camera.h"

namespace surfcast::service {
namespace {

using picture::Channel;

/// A pixel of a picture, and what it shows.
struct ChannelPixel {
  const pick::FrontPixel& front;
  float coverage = 0;
  glm::dvec3 direction{0};  ///< world, with a component of 1 along the view axis

  [[nodiscard]] bool background() const { return front.number == pick::FrontPixel::kBackground; }
};

using Words = std::vector<uint32_t>;

void append(float value, Words& words) {
  words.push_back(std::bit_cast<uint32_t>(value));
}

void append(const glm::vec3& value, Words& words) {
  for (int axis = 0; axis < 3; ++axis) append(value[axis], words);
}

/// The front surface relative to the eye.
glm::vec3 position_of(const ChannelPixel& pixel) {
  if (pixel.background()) return glm::vec3(std::numeric_limits<float>::quiet_NaN());
  return glm::vec3(pixel.direction * pixel.front.depth);
}

void append(Channel channel, const ChannelPixel& pixel, Words& words) {
  switch (channel) {
    case Channel::kDepth:
      return append(static_cast<float>(pixel.front.depth), words);
    case Channel::kNormal:
      return append(pixel.front.normal, words);
    case Channel::kPosition:
      return append(position_of(pixel), words);
    case Channel::kCoverage:
      return append(pixel.coverage, words);
    case Channel::kClassification:
      return append(pixel.front.code, words);
    case Channel::kSurfel:
      return words.push_back(static_cast<uint32_t>(pixel.front.number));  // the background has all bits set
  }
}

std::vector<picture::FileChannel> file_channels(Channel channel) {
  switch (channel) {
    case Channel::kDepth:
      return {{"Z"}};
    case Channel::kNormal:
      return {{"N.X"}, {"N.Y"}, {"N.Z"}};
    case Channel::kPosition:
      return {{"P.X"}, {"P.Y"}, {"P.Z"}};
    case Channel::kCoverage:
      return {{"A"}};
    case Channel::kClassification:
      return {{"classification"}};
    case Channel::kSurfel:
      return {{"id", true}};
  }
  return {};
}

std::vector<Channel> listed(const picture::ChannelSet& channels) {
  std::vector<Channel> list;
  for (size_t i = 0; i < channels.size(); ++i) {
    if (channels[i]) list.push_back(static_cast<Channel>(i));
  }
  return list;
}

/// The fourth value of a pixel of floats.
float coverage_of(const picture::Image& image, size_t pixel) {
  float coverage = 0;
  std::memcpy(&coverage, image.pixels.data() + (4 * pixel + 3) * sizeof coverage, sizeof coverage);
  return coverage;
}

}  // namespace

bool needs_front_surface(const picture::ChannelSet& channels) {
  picture::ChannelSet others = channels;
  others.reset(static_cast<size_t>(Channel::kCoverage));
  return others.any();
}

Status check_channels(const picture::ChannelSet& channels, const model::ModelInfo& info) {
  const auto& names = info.scalar_names;
  if (has(channels, Channel::kClassification) &&
      std::find(names.begin(), names.end(), "classification") == names.end()) {
    return fail(ErrorKind::kInvalidInput, "channels: the model has no classification");
  }
  if (has(channels, Channel::kSurfel) && info.surfels >= std::numeric_limits<uint32_t>::max()) {
    return fail(ErrorKind::kLimit, "channels: the model has more surfels than numbers of 32 bits");
  }
  return {};
}

picture::Channels make_channels(const picture::ChannelSet& channels, const picture::Frame& frame,
                                std::span<const pick::FrontPixel> front) {
  const picture::Image& image = frame.image;
  const auto view = geometry::make_camera_frame(frame.camera, image.width, image.height);
  SURFCAST_EXPECTS(view.has_value() && image.format == picture::PixelFormat::kLinearFloat);
  const std::vector<Channel> list = listed(channels);
  picture::Channels result;
  result.origin = view->eye;
  for (const Channel channel : list) {
    for (picture::FileChannel& file : file_channels(channel)) result.channels.push_back(std::move(file));
  }
  const size_t count = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  SURFCAST_EXPECTS(front.empty() || front.size() == count);
  result.words.reserve(count * result.channels.size());
  const pick::FrontPixel nothing;
  for (size_t i = 0; i < count; ++i) {
    const auto width = static_cast<size_t>(image.width);
    const glm::dvec2 pixel_corner(glm::uvec2(i % width, i / width));
    const glm::dvec3 ray = view->ray(pixel_corner + 0.5);
    const ChannelPixel pixel{front.empty() ? nothing : front[i], coverage_of(image, i),
                             view->right * ray.x + view->up * ray.y + view->forward};
    for (const Channel channel : list) append(channel, pixel, result.words);
  }
  return result;
}

}  // namespace surfcast::service
