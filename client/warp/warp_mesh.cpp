#include "warp/warp_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

namespace surfcast::warp {
namespace {

// Width of the surroundings beyond the border, heights of the frame.
constexpr float kSurroundings = 0.25F;

/// The texels of a plane with a ring around them, whose vertices lie on the border of the frame.
class Grid {
 public:
  Grid(const DepthPlane& depth, int width, int height)
      : columns_(depth.width + 2),
        rows_(depth.height + 2),
        cell_(depth.cell),
        x_(places(depth.width, depth.cell, width)),
        y_(places(depth.height, depth.cell, height)),
        inverse_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_)) {
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        const int column = std::clamp(x - 1, 0, depth.width - 1);
        const int row = std::clamp(y - 1, 0, depth.height - 1);
        at(x, y) =
            depth.inverse[static_cast<size_t>(row) * static_cast<size_t>(depth.width) + static_cast<size_t>(column)];
      }
    }
    move_to_centres();
    extend_to_border();
  }

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] uint32_t index(int x, int y) const { return static_cast<uint32_t>(y * columns_ + x); }
  [[nodiscard]] float inverse(int x, int y) const { return inverse_[index(x, y)]; }
  [[nodiscard]] glm::vec2 pixel(int x, int y) const { return {x_[static_cast<size_t>(x)], y_[static_cast<size_t>(y)]}; }

  /// The texel of a vertex; of one on the border, the nearest.
  [[nodiscard]] size_t texel(const glm::ivec2& at) const {
    const int column = std::clamp(at.x - 1, 0, columns_ - 3);
    const int row = std::clamp(at.y - 1, 0, rows_ - 3);
    return static_cast<size_t>(row) * static_cast<size_t>(columns_ - 2) + static_cast<size_t>(column);
  }

  [[nodiscard]] bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < columns_ && y < rows_; }

  /// Whether the surface is broken between (x, y) and its neighbour (x + dx, y + dy).
  [[nodiscard]] bool cut(int x, int y, int dx, int dy) const {
    const float a = inverse(x, y);
    const float b = inverse(x + dx, y + dy);
    if (a == 0 || b == 0) return a != b;
    const float tolerance = surface_step(a, b, cell_);
    const float step = b - a;
    if (std::abs(step) <= tolerance) return false;
    return !explained(step, tolerance, x - dx, y - dy, x, y) &&
           !explained(step, tolerance, x + dx, y + dy, x + 2 * dx, y + 2 * dy);
  }

 private:
  /// Centres of the cells along one side, with both ends of the side.
  static std::vector<float> places(int texels, int cell, int pixels) {
    std::vector<float> places{0};
    for (int i = 0; i < texels; ++i) {
      const int end = std::min((i + 1) * cell, pixels);
      places.push_back(static_cast<float>(i * cell + end) / 2);
    }
    places.push_back(static_cast<float>(pixels));
    return places;
  }

  float& at(int x, int y) { return inverse_[index(x, y)]; }

  /// Whether the step between two neighbours is that between two others in the same direction.
  [[nodiscard]] bool explained(float step, float tolerance, int x0, int y0, int x1, int y1) const {
    if (!inside(x0, y0) || !inside(x1, y1) || inverse(x0, y0) == 0 || inverse(x1, y1) == 0) return false;
    return std::abs(inverse(x1, y1) - inverse(x0, y0) - step) <= tolerance;
  }

  /// The change of the inverse depth across half a cell, where the surface is not broken on either side.
  [[nodiscard]] float half_step(int x, int y, int dx, int dy) const {
    if (!inside(x - dx, y - dy) || !inside(x + dx, y + dy)) return 0;
    if (cut(x - dx, y - dy, dx, dy) || cut(x, y, dx, dy)) return 0;
    return std::abs(inverse(x + dx, y + dy) - inverse(x - dx, y - dy)) / 4;
  }

  /// A texel is the nearest point of its cell, which on a slanted surface is a corner of it. The centre is farther.
  void move_to_centres() {
    std::vector<float> centres = inverse_;
    for (int y = 1; y < rows_ - 1; ++y) {
      for (int x = 1; x < columns_ - 1; ++x) {
        const float nearest = inverse(x, y);
        if (nearest == 0) continue;
        centres[index(x, y)] = std::max(nearest - half_step(x, y, 1, 0) - half_step(x, y, 0, 1), nearest / 2);
      }
    }
    inverse_ = std::move(centres);
  }

  /// Continues the slopes to the border, half a cell beyond the last centres.
  void extend_to_border() {
    const auto extend = [&](int x, int y, int dx, int dy) {
      const float last = inverse(x + dx, y + dy);
      const float before = inverse(x + 2 * dx, y + 2 * dy);
      at(x, y) = cut(x + dx, y + dy, dx, dy) ? last : std::max(last + (last - before) / 2, last / 2);
    };
    if (columns_ > 3) {
      for (int y = 1; y < rows_ - 1; ++y) {
        extend(0, y, 1, 0);
        extend(columns_ - 1, y, -1, 0);
      }
    }
    if (rows_ > 3) {
      for (int x = 0; x < columns_; ++x) {
        extend(x, 0, 0, 1);
        extend(x, rows_ - 1, 0, -1);
      }
    }
  }

  int columns_;
  int rows_;
  int cell_;
  std::vector<float> x_;
  std::vector<float> y_;
  std::vector<float> inverse_;
};

/// What outlines beside a vertex separate. Away from them, both sheets are its own depth.
struct Outline {
  bool beside = false;
  float near = 0;        ///< inverse depth of the surface in front
  glm::ivec2 far_at{0};  ///< the vertex that is behind
};

Outline outline_at(const Grid& grid, const glm::ivec2& at) {
  Outline outline;
  outline.near = grid.inverse(at.x, at.y);
  outline.far_at = at;
  for (const glm::ivec2& step : {glm::ivec2(-1, 0), glm::ivec2(1, 0), glm::ivec2(0, -1), glm::ivec2(0, 1)}) {
    const glm::ivec2 other = at + step;
    if (!grid.inside(other.x, other.y) || !grid.cut(at.x, at.y, step.x, step.y)) continue;
    outline.beside = true;
    const float there = grid.inverse(other.x, other.y);
    outline.near = std::max(outline.near, there);
    if (there < grid.inverse(outline.far_at.x, outline.far_at.y)) outline.far_at = other;
  }
  return outline;
}

class MeshBuilder {
 public:
  explicit MeshBuilder(const Grid& grid) : grid_(grid) {
    for (int y = 0; y < grid.rows(); ++y) {
      for (int x = 0; x < grid.columns(); ++x) outlines_.push_back(outline_at(grid, {x, y}));
    }
  }

  /// Adds the two triangles of the square whose upper left corner is (x, y).
  void add_square(int x, int y) {
    const glm::ivec2 a(x, y);
    const glm::ivec2 b(x + 1, y);
    const glm::ivec2 c(x, y + 1);
    const glm::ivec2 d(x + 1, y + 1);
    const bool top = grid_.cut(x, y, 1, 0);
    const bool bottom = grid_.cut(x, y + 1, 1, 0);
    const bool left = grid_.cut(x, y, 0, 1);
    const bool right = grid_.cut(x + 1, y, 0, 1);
    // Divided between the ends of the diagonal that are nearer to each other.
    const float falling = std::abs(grid_.inverse(x, y) - grid_.inverse(x + 1, y + 1));
    const float rising = std::abs(grid_.inverse(x + 1, y) - grid_.inverse(x, y + 1));
    if (falling <= rising) {
      add_triangle({a, b, d}, top || right);
      add_triangle({a, d, c}, left || bottom);
    } else {
      add_triangle({a, b, c}, top || left);
      add_triangle({b, d, c}, right || bottom);
    }
  }

  /// Continues the frame beyond its border, for what a turning eye sees there.
  void add_surroundings(float margin) {
    const int right = grid_.columns() - 1;
    const int bottom = grid_.rows() - 1;
    for (int x = 0; x < right; ++x) {
      add_strip({x, 0}, {x + 1, 0}, {0, -margin});
      add_strip({x, bottom}, {x + 1, bottom}, {0, margin});
    }
    for (int y = 0; y < bottom; ++y) {
      add_strip({0, y}, {0, y + 1}, {-margin, 0});
      add_strip({right, y}, {right, y + 1}, {margin, 0});
    }
  }

  [[nodiscard]] WarpMesh take() && { return std::move(mesh_); }

 private:
  using Corners = std::array<glm::ivec2, 3>;

  [[nodiscard]] const Outline& outline(const glm::ivec2& at) const { return outlines_[grid_.index(at.x, at.y)]; }
  [[nodiscard]] float inverse(const glm::ivec2& at) const { return grid_.inverse(at.x, at.y); }

  [[nodiscard]] MeshTriangle plain(const Corners& corners) const {
    MeshTriangle triangle;
    triangle.background = true;
    for (size_t i = 0; i < 3; ++i) {
      const glm::ivec2& at = corners.at(i);
      triangle.corners.at(i) = {grid_.pixel(at.x, at.y), grid_.inverse(at.x, at.y)};
      triangle.background &= triangle.corners.at(i).inverse == 0;
    }
    return triangle;
  }

  /// A strip from the border between two vertices outwards.
  void add_strip(const glm::ivec2& a, const glm::ivec2& b, const glm::vec2& outwards) {
    const MeshVertex from{grid_.pixel(a.x, a.y), grid_.inverse(a.x, a.y), 1, grid_.texel(a)};
    const MeshVertex to{grid_.pixel(b.x, b.y), grid_.inverse(b.x, b.y), 1, grid_.texel(b)};
    const MeshVertex from_outside{from.pixel + outwards, from.inverse, 0, from.fill_texel};
    const MeshVertex to_outside{to.pixel + outwards, to.inverse, 0, to.fill_texel};
    MeshTriangle triangle;
    triangle.sheet = Sheet::kSurroundings;
    triangle.corners = {from, to, to_outside};
    mesh_.push_back(triangle);
    triangle.corners = {from, to_outside, from_outside};
    mesh_.push_back(triangle);
  }

  void add_triangle(const Corners& corners, bool cut) {
    const auto beside = std::ranges::find_if(corners, [&](const glm::ivec2& at) { return outline(at).beside; });
    MeshTriangle triangle = plain(corners);
    if (beside == corners.end()) {
      mesh_.push_back(triangle);
      return;
    }
    const glm::ivec2 far_at = outline(*beside).far_at;
    triangle.far = grid_.pixel(far_at.x, far_at.y);
    triangle.background = false;
    if (cut) add_fill(triangle, corners);
    add_sheets(triangle, corners, far_at);
  }

  /// Corners of the surface in front take the fill colour of the farthest corner, the others their own. Beside
  /// background all corners take that of the background.
  void add_fill(MeshTriangle triangle, const Corners& corners) {
    const auto by_inverse = [&](const glm::ivec2& at) { return inverse(at); };
    const auto [far, near] = std::ranges::minmax(corners, {}, by_inverse);
    triangle.sheet = Sheet::kFill;
    for (size_t i = 0; i < 3; ++i) {
      const glm::ivec2& at = corners.at(i);
      const bool in_front = inverse(near) - inverse(at) <= inverse(at) - inverse(far);
      triangle.corners.at(i).fill_texel = grid_.texel(in_front || inverse(far) == 0 ? far : at);
    }
    mesh_.push_back(triangle);
  }

  /// `triangle`: one beside an outline, which has `farthest` behind it.
  void add_sheets(const MeshTriangle& triangle, const Corners& corners, glm::ivec2 farthest) {
    float nearest = 0;
    for (const glm::ivec2& at : corners) {
      if (!outline(at).beside) continue;
      nearest = std::max(nearest, outline(at).near);
      if (inverse(outline(at).far_at) < inverse(farthest)) farthest = outline(at).far_at;
    }
    // A triangle from a surface to background would become a needle as the eye moves.
    const bool open = inverse(farthest) == 0;
    MeshTriangle near = triangle;
    MeshTriangle far = triangle;
    near.sheet = Sheet::kNear;
    far.sheet = Sheet::kFar;
    for (size_t i = 0; i < 3; ++i) {
      const glm::ivec2& at = corners.at(i);
      const Outline& corner = outline(at);
      const float own = inverse(at);
      const bool in_front = nearest - own <= own - inverse(farthest);
      near.corners.at(i).front = far.corners.at(i).front = in_front ? 1.0F : 0.0F;
      near.corners.at(i).inverse = corner.beside ? corner.near : (in_front ? own : nearest);
      const glm::ivec2 behind = open ? farthest : corner.beside ? corner.far_at : in_front ? farthest : at;
      far.corners.at(i).inverse = inverse(behind);
      far.corners.at(i).fill_texel = grid_.texel(behind);
    }
    mesh_.push_back(far);
    mesh_.push_back(near);
  }

  const Grid& grid_;
  std::vector<Outline> outlines_;
  WarpMesh mesh_;
};

}  // namespace

WarpMesh make_warp_mesh(const DepthPlane& depth, int width, int height) {
  const Grid grid(depth, width, height);
  MeshBuilder builder(grid);
  for (int y = 0; y + 1 < grid.rows(); ++y) {
    for (int x = 0; x + 1 < grid.columns(); ++x) builder.add_square(x, y);
  }
  builder.add_surroundings(kSurroundings * static_cast<float>(height));
  return std::move(builder).take();
}

}  // namespace surfcast::warp
