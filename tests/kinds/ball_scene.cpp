#include "kinds/ball_scene.h"

#include <gtest/gtest.h>

#include "ldc/subtree.h"
#include "model/model_writer.h"
#include "model/write_blocks.h"
#include "support/clouds.h"

namespace surfcast::testing {
namespace {

void add_balls(model::ModelWriter& writer, const BallScene& scene) {
  const ldc::OctreeKey root;
  const std::span balls(scene.balls);
  const uint32_t a = *writer.add(encode_balls(balls.first(2)), root.child(1), {});
  const uint32_t b = *writer.add(encode_balls(balls.last(2)), root.child(6), {});
  EXPECT_TRUE(writer.add(encode_balls(std::span(&scene.coarse, 1)), root, std::vector{a, b}));
}

}  // namespace

kinds::KindTable kinds_with_balls() {
  static const BallKind kBalls;
  static const std::array<const kinds::Kind*, 2> kKinds{kinds::built_in_kinds().front(), &kBalls};
  return kKinds;
}

std::filesystem::path write_scene(const std::filesystem::path& target, const BallScene& scene, int surfels_across) {
  const surfel::SurfelCloud cloud =
      square(surfels_across, BallScene::kSide, glm::dvec3(0), glm::dvec3(0, 0, 1), BallScene::kSquareColor);
  Result<model::ModelWriter> writer = model::ModelWriter::create(target, model::schema_of(cloud));
  EXPECT_TRUE(writer);
  const ldc::Subtree tree = ldc::build_subtree(cloud, ldc::whole_region(cloud), {}, 0);
  EXPECT_TRUE(model::write_blocks(*writer, cloud, tree.blocks, {}));
  add_balls(*writer, scene);
  EXPECT_TRUE(writer->finish());
  return target;
}

std::filesystem::path write_balls(const std::filesystem::path& target, const BallScene& scene) {
  model::ModelSchema schema;
  schema.color_bits = 8;
  Result<model::ModelWriter> writer = model::ModelWriter::create(target, schema);
  EXPECT_TRUE(writer);
  add_balls(*writer, scene);
  EXPECT_TRUE(writer->finish());
  return target;
}

}  // namespace surfcast::testing
