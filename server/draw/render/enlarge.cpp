#include "render/enlarge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/catmull_rom.h"

namespace surfcast::render {
namespace {

constexpr size_t kChannels = 4;
constexpr int kTaps = 4;

/// Where the pixels of an enlarged row or column lie in the drawn one: the first of four neighbours, and their weights.
struct Taps {
  int first = 0;
  std::array<float, kTaps> weights{};
};

/// `pitch`: drawn pixels of an enlarged one. The middles of both lengths meet.
std::vector<Taps> taps_of(int enlarged, int drawn, double pitch) {
  std::vector<Taps> taps(static_cast<size_t>(enlarged));
  for (int i = 0; i < enlarged; ++i) {
    const double at = (i + 0.5 - 0.5 * enlarged) * pitch + 0.5 * drawn - 0.5;
    const double below = std::floor(at);
    Taps& tap = taps[static_cast<size_t>(i)];
    tap.first = static_cast<int>(below) - 1;
    std::ranges::transform(catmull_rom_weights(at - below), tap.weights.begin(),
                           [](double weight) { return static_cast<float>(weight); });
  }
  return taps;
}

/// The pixels of a drawn row at the places of the enlarged ones.
template <typename Channel>
void enlarge_row(const Channel* drawn, int width, const std::vector<Taps>& taps, float* enlarged) {
  for (const Taps& tap : taps) {
    std::array<float, kChannels> sum{};
    for (int k = 0; k < kTaps; ++k) {
      const Channel* pixel = drawn + kChannels * static_cast<size_t>(std::clamp(tap.first + k, 0, width - 1));
      for (size_t c = 0; c < kChannels; ++c) {
        sum[c] += tap.weights[static_cast<size_t>(k)] * static_cast<float>(pixel[c]);
      }
    }
    enlarged = std::ranges::copy(sum, enlarged).out;
  }
}

/// A value within the range of a channel. The fourth one is a coverage.
template <typename Channel>
Channel channel_of(float value, size_t c) {
  if constexpr (std::is_same_v<Channel, uint8_t>) {
    return static_cast<uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
  } else {
    return c == 3 ? std::clamp(value, 0.0F, 1.0F) : std::max(value, 0.0F);
  }
}

/// The drawn rows around an enlarged one, enlarged along themselves: no more than it needs.
template <typename Channel>
class RowWindow {
 public:
  RowWindow(const picture::Image& image, std::vector<Taps> taps) : image_(image), taps_(std::move(taps)) {
    for (std::vector<float>& row : rows_) row.resize(kChannels * taps_.size());
  }

  /// Moves to the rows of these taps, which never go up.
  void move_to(const Taps& down) {
    const size_t pitch = kChannels * static_cast<size_t>(image_.width);
    const auto* drawn = reinterpret_cast<const Channel*>(image_.pixels.data());
    for (const int last = inside(down.first + kTaps - 1); next_ <= last; ++next_) {
      enlarge_row(drawn + static_cast<size_t>(next_) * pitch, image_.width, taps_, place_of(next_).data());
    }
  }

  /// A row of the window; beyond the picture that at its border.
  [[nodiscard]] const float* row(int index) { return place_of(inside(index)).data(); }

 private:
  [[nodiscard]] int inside(int row) const { return std::clamp(row, 0, image_.height - 1); }
  std::vector<float>& place_of(int row) { return rows_.at(static_cast<size_t>(row % kTaps)); }

  const picture::Image& image_;
  std::vector<Taps> taps_;
  std::array<std::vector<float>, kTaps> rows_;
  int next_ = 0;
};

template <typename Channel>
void enlarge_channels(const picture::Image& image, picture::Image& result) {
  const double pitch = static_cast<double>(image.height) / result.height;
  RowWindow<Channel> window(image, taps_of(result.width, image.width, pitch));
  const size_t row = kChannels * static_cast<size_t>(result.width);
  auto* pixels = reinterpret_cast<Channel*>(result.pixels.data());
  for (const Taps& tap : taps_of(result.height, image.height, pitch)) {
    window.move_to(tap);
    std::array<const float*, kTaps> rows{};
    for (int k = 0; k < kTaps; ++k) rows[static_cast<size_t>(k)] = window.row(tap.first + k);
    for (size_t i = 0; i < row; ++i) {
      float sum = 0;
      for (size_t k = 0; k < kTaps; ++k) sum += tap.weights[k] * rows[k][i];
      pixels[i] = channel_of<Channel>(sum, i % kChannels);
    }
    pixels += row;
  }
}

}  // namespace

picture::PictureRequest at_render_scale(const picture::PictureRequest& request) {
  picture::PictureRequest drawn = request;
  drawn.render_scale = 1;
  drawn.silhouettes = false;
  drawn.blends_behind = true;
  drawn.height = std::max(1, static_cast<int>(std::lround(request.render_scale * request.height)));
  drawn.width = (request.width * drawn.height + request.height - 1) / request.height;
  const double scale = static_cast<double>(drawn.height) / request.height;
  drawn.spacing *= scale;
  drawn.eye_dome.radius *= scale;
  return drawn;
}

picture::Image enlarge(const picture::Image& image, int width, int height) {
  picture::Image result{width, height, image.format, {}};
  if (image.pixels.empty()) return result;
  const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  const bool floats = image.format == picture::PixelFormat::kLinearFloat;
  result.pixels.resize(kChannels * pixels * (floats ? sizeof(float) : sizeof(uint8_t)));
  if (floats) {
    enlarge_channels<float>(image, result);
  } else {
    enlarge_channels<uint8_t>(image, result);
  }
  return result;
}

void enlarge_depth(const picture::DepthMap& drawn, glm::ivec2 size, glm::ivec2 enlarged, picture::DepthMap& map) {
  const double pitch = static_cast<double>(size.y) / enlarged.y;
  const auto texel_at = [&](int texel, int pixels, int drawn_pixels, int texels) {
    const double pixel = ((texel + 0.5) * map.cell - 0.5 * pixels) * pitch + 0.5 * drawn_pixels;
    return static_cast<size_t>(std::clamp(static_cast<int>(pixel) / drawn.cell, 0, texels - 1));
  };
  map.seen_through = drawn.seen_through;
  for (int y = 0; y < map.height; ++y) {
    const size_t row = texel_at(y, enlarged.y, size.y, drawn.height) * static_cast<size_t>(drawn.width);
    for (int x = 0; x < map.width; ++x) {
      const size_t to = static_cast<size_t>(y) * static_cast<size_t>(map.width) + static_cast<size_t>(x);
      map.inverse[to] = drawn.inverse[row + texel_at(x, enlarged.x, size.x, drawn.width)];
    }
  }
}

}  // namespace surfcast::render
