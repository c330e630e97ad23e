#include "reference/sheet_renderer.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <numeric>

#include <tbb/parallel_for.h>

#include "reference/affine_kernel.h"

namespace surfcast::reference {
namespace {

struct SheetKernel {
  AffineKernel shape;
  glm::dvec2 pixel;  ///< of the centre
  glm::dvec2 reach;  ///< pixels
  Classified seen;
};

/// The axis of the grid whose planes are most parallel to the picture.
int sheet_axis(const VolumeGrid& grid, const geometry::CameraFrame& frame) {
  const glm::dmat3 planes = glm::transpose(glm::inverse(grid.axes));  // columns: normals of planes of constant index
  const auto facing = [&](int axis) { return std::abs(glm::dot(glm::normalize(planes[axis]), frame.forward)); };
  int best = 0;
  for (int axis = 1; axis < 3; ++axis) best = facing(axis) > facing(best) ? axis : best;
  return best;
}

/// Sheets from the eye on, by index along the axis.
std::vector<int> sheets_in_order(const VolumeGrid& grid, int axis, const glm::dvec3& eye) {
  std::vector<int> sheets(grid.size[axis]);
  std::iota(sheets.begin(), sheets.end(), 0);
  const double place = (glm::inverse(grid.axes) * (eye - grid.origin))[axis];
  std::stable_sort(sheets.begin(), sheets.end(),
                   [&](int a, int b) { return std::abs(a - place) < std::abs(b - place); });
  return sheets;
}

class SheetPass {
 public:
  SheetPass(const VolumeGrid& grid, const TransferFunction& transfer, const geometry::CameraFrame& frame,
            const SheetParameters& parameters)
      : frame_(frame), parameters_(parameters) {
    const int axis = sheet_axis(grid, frame);
    for (const int sheet : sheets_in_order(grid, axis, frame.eye)) {
      sheets_.emplace_back();
      glm::ivec3 i;
      i[axis] = sheet;
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      for (i[u] = 0; i[u] < grid.size[u]; ++i[u]) {
        for (i[v] = 0; i[v] < grid.size[v]; ++i[v]) add(grid, i, transfer.at(grid.at(i)));
      }
    }
  }

  [[nodiscard]] LightPicture draw() const {
    LightPicture picture(frame_.width, frame_.height);
    tbb::parallel_for(0, frame_.height, [&](int y) {
      std::vector<RayLight> row(frame_.width);
      for (const auto& sheet : sheets_) composite(sheet, y, row);
      for (int x = 0; x < frame_.width; ++x) picture.pixels[picture.index(x, y)] = row[x].premultiplied();
    });
    return picture;
  }

 private:
  void add(const VolumeGrid& grid, const glm::ivec3& i, const Classified& seen) {
    const glm::dvec3 o = frame_.to_camera(grid.place(glm::dvec3(i)));
    if (seen.extinction == 0 || !(o.z > 0)) return;
    const glm::dmat3 factor{frame_.rotate(grid.axes[0]), frame_.rotate(grid.axes[1]), frame_.rotate(grid.axes[2])};
    const double variance = parameters_.prefilter * parameters_.prefilter;
    const AffineKernel shape(o, parameters_.sigma * factor, frame_.eta, variance);
    const glm::dvec2 reach{std::sqrt(parameters_.cutoff * shape.footprint().x),
                           std::sqrt(parameters_.cutoff * shape.footprint().y)};
    sheets_.back().push_back({shape, frame_.project(o), reach, seen});
  }

  /// Adds one sheet to a row of pixels: optical depths and colours add up within it.
  void composite(const std::vector<SheetKernel>& sheet, int y, std::vector<RayLight>& row) const {
    std::vector<glm::dvec4> sums(row.size());
    for (const SheetKernel& kernel : sheet) {
      if (std::abs(y + 0.5 - kernel.pixel.y) > kernel.reach.y) continue;
      const int first = std::max(0, static_cast<int>(std::max(-1.0, kernel.pixel.x - kernel.reach.x)));
      const double end = std::min<double>(frame_.width, kernel.pixel.x + kernel.reach.x + 1);
      for (int x = first; x < end; ++x) add_fragment(kernel, frame_.ray({x + 0.5, y + 0.5}), sums[x]);
    }
    for (size_t x = 0; x < row.size(); ++x) {
      if (sums[x].w > 0) row[x].add(glm::dvec3(sums[x]) / sums[x].w, sums[x].w, 1);
    }
  }

  void add_fragment(const SheetKernel& kernel, const glm::dvec3& d, glm::dvec4& sum) const {
    if (!(kernel.shape.r2(d) <= parameters_.cutoff)) return;
    const double normal = 2 * std::numbers::pi * parameters_.sigma * parameters_.sigma;
    const double peak = std::pow(normal, -1.5) / (1 - std::exp(-0.5 * parameters_.cutoff));
    const double tau = peak * kernel.seen.extinction * kernel.shape.length(d);
    sum += glm::dvec4(tau * kernel.seen.color, tau);
  }

  const geometry::CameraFrame& frame_;
  SheetParameters parameters_;
  std::vector<std::vector<SheetKernel>> sheets_;
};

}  // namespace

LightPicture draw_sheets(const VolumeGrid& samples, const TransferFunction& transfer,
                         const geometry::CameraFrame& frame, const SheetParameters& parameters) {
  return SheetPass(samples, transfer, frame, parameters).draw();
}

}  // namespace surfcast::reference
