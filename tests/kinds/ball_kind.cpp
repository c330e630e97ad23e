#include "kinds/ball_kind.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <utility>

#include "kinds/ball_shaders.h"
#include "residency/packing.h"
#include "shared/frame_layout.h"

namespace surfcast::testing {
namespace {

const surfel::Grid kGrid{glm::dvec3(1.0 / 1024), glm::dvec3(0)};

/// A ball as stored in a block of the file.
struct StoredBall {
  glm::u32vec3 index{0};  ///< relative to the block's origin
  float radius = 0;
  glm::u8vec3 color{0};
  uint8_t unused = 0;
};
static_assert(sizeof(StoredBall) == 20);

/// The balls of a block. Fails if the bytes do not match the tables.
Result<std::vector<StoredBall>> read_balls(const model::ModelFile& model, uint32_t block) {
  const Result<model::StoredBlock> stored = model.stored(block);
  if (!stored) return fail(stored);
  const auto wrong = [&] { return fail(model.named(block, {ErrorKind::kInvalidInput, "no balls"})); };
  if (stored->bytes.size() != stored->items * sizeof(StoredBall)) return wrong();
  std::vector<StoredBall> balls(stored->items);
  std::memcpy(balls.data(), stored->bytes.data(), stored->bytes.size());
  for (const StoredBall& ball : balls) {
    const bool inside =
        ball.index.x <= stored->extent.x && ball.index.y <= stored->extent.y && ball.index.z <= stored->extent.z;
    if (!inside || !(ball.radius > 0 && std::isfinite(ball.radius))) return wrong();
  }
  return balls;
}

/// Two texels per ball: position codes, then radius and linear colour.
class BallHeader : public residency::BlockHeader {
 public:
  explicit BallHeader(uint32_t texels) : texels_(texels) {}
  [[nodiscard]] glm::vec4 scale(int unit) const override { return {std::ldexp(1.0F, unit), 0, 0, 0}; }
  void add_runs(const selection::RadiusRange& /*wanted*/, std::vector<residency::TexelRun>& runs) const override {
    for (uint32_t first = 0; first < texels_; first += SURFCAST_CHUNK) {
      runs.push_back({first, std::min<uint32_t>(texels_ - first, SURFCAST_CHUNK), 0});
    }
  }

 private:
  uint32_t texels_;
};

uint32_t packed_light(const glm::u8vec3& color) {
  static const std::vector<uint32_t> kRoots = residency::linear_root_table();
  return (kRoots[color.r] & 0xffffU) | ((kRoots[color.g] & 0xffffU) << 11) | ((kRoots[color.b] >> 16) << 22);
}

class Balls : public kinds::SourceBlock {
 public:
  explicit Balls(std::vector<Ball> balls) : balls_(std::move(balls)) {}

  [[nodiscard]] size_t bytes() const override { return balls_.size() * sizeof(Ball); }
  void hit(const kinds::PickQuery& query, std::vector<kinds::PickHit>& hits) const override {
    const glm::dvec3 d = query.frame.ray(query.pixel);
    for (uint32_t i = 0; i < balls_.size(); ++i) {
      const glm::dvec3 o = query.frame.to_camera(balls_[i].centre);
      const double r = double{balls_[i].radius};
      const double dd = glm::dot(d, d);
      const glm::dvec3 beside = glm::cross(o, d);
      const double form = glm::dot(beside, beside) / (dd * r * r);
      const double z = (glm::dot(d, o) - r * std::sqrt(dd * std::max(0.0, 1 - form))) / dd;
      if (form > 1 || z <= 0 || glm::dot(o, o) <= r * r || !query.clip.shows(balls_[i].centre)) continue;
      hits.push_back({i, form, z, z * (1 + 1 / query.frame.eta)});
    }
  }
  void cover(const kinds::PickQuery& query, kinds::PixelHits& pixels) const override {
    pixels.for_each_shown(pixels.range(), 0, [&](const glm::ivec2& pixel) {
      kinds::PickQuery there = query;
      there.pixel = glm::dvec2(pixel) + 0.5;
      std::vector<kinds::PickHit> hits;
      hit(there, hits);
      for (const kinds::PickHit& found : hits) {
        pixels.add(pixel, found, {glm::vec3(describe(there, found.item).normal), kinds::kNoClass});
      }
    });
  }
  [[nodiscard]] kinds::PickedSurfel describe(const kinds::PickQuery& query, uint32_t item) const override {
    const Ball& ball = balls_[item];
    const glm::dvec3 to_eye = query.frame.eye - ball.centre;
    return {ball.centre, glm::normalize(to_eye), ball.color, double{ball.radius}, glm::length(to_eye), {}};
  }

 private:
  std::vector<Ball> balls_;
};

}  // namespace

model::EncodedBlock encode_balls(std::span<const Ball> balls) {
  model::EncodedBlock block;
  block.kind = BallKind().name();
  block.grid = kGrid;
  block.items = static_cast<uint32_t>(balls.size());
  block.origin = kGrid.index(balls.front().centre);
  glm::i64vec3 highest = block.origin;
  for (const Ball& ball : balls) {
    block.origin = glm::min(block.origin, kGrid.index(ball.centre));
    highest = glm::max(highest, kGrid.index(ball.centre));
    block.max_radius = std::max(block.max_radius, ball.radius);
  }
  block.extent = glm::u32vec3(highest - block.origin);
  block.spacing = block.max_radius;
  block.bytes.resize(balls.size() * sizeof(StoredBall));
  for (size_t i = 0; i < balls.size(); ++i) {
    const StoredBall stored{glm::u32vec3(kGrid.index(balls[i].centre) - block.origin), balls[i].radius, balls[i].color};
    std::memcpy(block.bytes.data() + i * sizeof stored, &stored, sizeof stored);
  }
  return block;
}

Result<residency::PackedBlock> BallKind::load(const model::ModelFile& model, uint32_t block, bool attributes) const {
  const Result<std::vector<StoredBall>> balls = read_balls(model, block);
  if (!balls) return fail(balls);
  const Result<model::StoredBlock> stored = model.stored(block);
  residency::PackedBlock packed;
  packed.lattice = {stored->grid, stored->origin, glm::ivec3(0), stored->extent};
  for (const StoredBall& ball : *balls) {
    packed.texels.emplace_back(ball.index, 0);
    packed.texels.emplace_back(std::bit_cast<uint32_t>(ball.radius), packed_light(ball.color), 0, 0);
  }
  if (attributes) packed.attributes.resize(packed.texels.size());
  packed.header = std::make_shared<const BallHeader>(static_cast<uint32_t>(packed.texels.size()));
  return packed;
}

Result<std::shared_ptr<const kinds::SourceBlock>> BallKind::decode(const model::ModelFile& model,
                                                                   uint32_t block) const {
  const Result<std::vector<StoredBall>> stored = read_balls(model, block);
  if (!stored) return fail(stored);
  const Result<model::StoredBlock> place = model.stored(block);
  std::vector<Ball> balls;
  for (const StoredBall& ball : *stored) {
    balls.push_back({place->grid.position(place->origin + glm::i64vec3(ball.index)), ball.radius, ball.color});
  }
  return std::make_shared<const Balls>(std::move(balls));
}

kinds::KindShaders BallKind::shaders() const {
  return {kBallProject, kBallFragment};
}

}  // namespace surfcast::testing
