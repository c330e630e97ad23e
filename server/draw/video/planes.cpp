#include "video/planes.h"

#include <algorithm>
#include <cstddef>

namespace surfcast::video {
namespace {

constexpr int kChannels = 4;

// BT.709 in limited range, times 2^16.
constexpr int kBits = 16;
constexpr int kLumaRed = 11966;
constexpr int kLumaGreen = 40254;
constexpr int kLumaBlue = 4064;
constexpr int kBlueRed = -6596;
constexpr int kBlueGreen = -22189;
constexpr int kRedGreen = -26145;
constexpr int kRedBlue = -2640;
constexpr int kMax = 28785;  // of blue in the difference of blue, and of red in that of red

const uint8_t* row_of(const picture::Image& image, int y) {
  return reinterpret_cast<const uint8_t*>(image.pixels.data()) +
         static_cast<size_t>(y) * static_cast<size_t>(image.width) * kChannels;
}

void fill_luma(const uint8_t* pixels, int width, uint8_t* luma) {
  constexpr int kOffset = (16 << kBits) + (1 << (kBits - 1));
  for (int x = 0; x < width; ++x) {
    const uint8_t* p = pixels + static_cast<ptrdiff_t>(x) * kChannels;
    luma[x] = static_cast<uint8_t>((kLumaRed * p[0] + kLumaGreen * p[1] + kLumaBlue * p[2] + kOffset) >> kBits);
  }
}

/// The differences of one pixel of the small planes, from the sums of four pixels.
void fill_difference(int red, int green, int blue, uint8_t& to_blue, uint8_t& to_red) {
  constexpr int kSum = 2;  // bits
  constexpr int kOffset = (128 << (kBits + kSum)) + (1 << (kBits + kSum - 1));
  to_blue = static_cast<uint8_t>((kBlueRed * red + kBlueGreen * green + kMax * blue + kOffset) >> (kBits + kSum));
  to_red = static_cast<uint8_t>((kMax * red + kRedGreen * green + kRedBlue * blue + kOffset) >> (kBits + kSum));
}

void fill_differences(const uint8_t* upper, const uint8_t* lower, int width, uint8_t* to_blue, uint8_t* to_red) {
  const auto at = [](const uint8_t* row, int x) { return row + static_cast<ptrdiff_t>(x) * kChannels; };
  for (int x = 0; x < half_of(width); ++x) {
    const int right = std::min(2 * x + 1, width - 1);
    const uint8_t* a = at(upper, 2 * x);
    const uint8_t* b = at(upper, right);
    const uint8_t* c = at(lower, 2 * x);
    const uint8_t* d = at(lower, right);
    fill_difference(a[0] + b[0] + c[0] + d[0], a[1] + b[1] + c[1] + d[1], a[2] + b[2] + c[2] + d[2], to_blue[x],
                    to_red[x]);
  }
}

}  // namespace

void fill_planes(const picture::Image& image, Planes& planes) {
  const auto width = static_cast<size_t>(image.width);
  const auto half = static_cast<size_t>(half_of(image.width));
  planes.width = image.width;
  planes.height = image.height;
  planes.luma.resize(width * static_cast<size_t>(image.height));
  planes.blue.resize(half * static_cast<size_t>(half_of(image.height)));
  planes.red.resize(planes.blue.size());
  for (int y = 0; y < image.height; ++y) {
    fill_luma(row_of(image, y), image.width, planes.luma.data() + static_cast<size_t>(y) * width);
  }
  for (int y = 0; y < half_of(image.height); ++y) {
    const size_t at = static_cast<size_t>(y) * half;
    fill_differences(row_of(image, 2 * y), row_of(image, std::min(2 * y + 1, image.height - 1)), image.width,
                     planes.blue.data() + at, planes.red.data() + at);
  }
}

}  // namespace surfcast::video
