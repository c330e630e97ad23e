#include "render/sampled_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/contract.h"
#include "render/spacing_search.h"

namespace surfcast::render {
namespace {

struct Cell {
  Region region;
  SquaredError difference;
  double share = 0;  ///< of all chances
};

/// The part of a small picture that shows a region of one of `width` x `height` pixels. Never empty.
Region part_of(const picture::Image& small, const Region& region, int width, int height) {
  const auto place = [](int at, int from, int to) { return static_cast<int>(int64_t{at} * to / from); };
  const int x = std::min(place(region.x, width, small.width), small.width - 1);
  const int y = std::min(place(region.y, height, small.height), small.height - 1);
  return {x, y, std::max(place(region.x + region.width, width, small.width) - x, 1),
          std::max(place(region.y + region.height, height, small.height) - y, 1)};
}

/// The windows of a picture that show anything. Their differences are those of the small pictures.
std::vector<Cell> cells_of(const picture::Image& fine, const picture::Image& coarse, int width, int height, int side) {
  std::vector<Cell> cells;
  for (int y = 0; y < height; y += side) {
    for (int x = 0; x < width; x += side) {
      const Region region{x, y, std::min(side, width - x), std::min(side, height - y)};
      const SquaredError difference = compare_pixels(fine, coarse, part_of(fine, region, width, height));
      if (difference.pixels > 0) cells.push_back({region, difference});
    }
  }
  return cells;
}

/// A tenth of the chances follows the covered pixels alone, because the difference can miss an error.
void set_shares(std::vector<Cell>& cells, double covered) {
  constexpr double kAnywhere = 0.1;
  const auto likely = [](const Cell& cell) { return std::sqrt(cell.difference.squares * cell.difference.pixels); };
  double sum = 0;
  for (const Cell& cell : cells) sum += likely(cell);
  for (Cell& cell : cells) {
    const double by_pixels = cell.difference.pixels / covered;
    cell.share = sum > 0 ? (1 - kAnywhere) * likely(cell) / sum + kAnywhere * by_pixels : by_pixels;
  }
}

/// Systematic sampling: equal steps through the sum of shares. A window that is met several times counts as often.
std::vector<SampledWindow> sample(const std::vector<Cell>& cells, int count) {
  std::vector<SampledWindow> windows;
  double sum = 0;
  double step = 0.5;
  for (const Cell& cell : cells) {
    sum += count * cell.share;
    const double hits = std::max(0.0, std::ceil(sum - step));
    step += hits;
    if (hits > 0) windows.push_back({cell.region, hits / (count * cell.share)});
  }
  return windows;
}

}  // namespace

SquaredError compare_pixels(const picture::Image& a, const picture::Image& b, const Region& region) {
  SURFCAST_EXPECTS(a.width == b.width && a.height == b.height && a.pixels.size() == b.pixels.size());
  constexpr size_t kPixel = 4;
  uint64_t squares = 0;
  uint64_t pixels = 0;
  for (int y = region.y; y < region.y + region.height; ++y) {
    const size_t row = static_cast<size_t>(y) * static_cast<size_t>(a.width) + static_cast<size_t>(region.x);
    const std::byte* first = a.pixels.data() + row * kPixel;
    const std::byte* second = b.pixels.data() + row * kPixel;
    for (int x = 0; x < region.width; ++x, first += kPixel, second += kPixel) {
      if (first[3] == std::byte{0} && second[3] == std::byte{0}) continue;
      ++pixels;
      for (size_t c = 0; c < 3; ++c) {
        const int difference = std::to_integer<int>(first[c]) - std::to_integer<int>(second[c]);
        squares += static_cast<uint64_t>(difference * difference);
      }
    }
  }
  return {static_cast<double>(squares) / 3, static_cast<double>(pixels)};
}

double psnr_of(double mean_square) {
  constexpr double kPeak = 255;
  return mean_square > 0 ? std::min(10 * std::log10(kPeak * kPeak / mean_square), kSamePicture) : kSamePicture;
}

ErrorSample choose_windows(const picture::Image& fine, const picture::Image& coarse, int width, int height, int side,
                           int most) {
  std::vector<Cell> cells = cells_of(fine, coarse, width, height, side);
  double small = 0;
  for (const Cell& cell : cells) small += cell.difference.pixels;
  const double pixels = static_cast<double>(width) * height;
  ErrorSample chosen{{}, small * pixels / (static_cast<double>(fine.width) * fine.height)};
  if (pixels <= static_cast<double>(most) * side * side) {
    chosen.windows.push_back({{0, 0, width, height}, 1});
    return chosen;
  }
  set_shares(cells, small);
  chosen.windows = sample(cells, most);
  return chosen;
}

}  // namespace surfcast::render
