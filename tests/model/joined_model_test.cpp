#include "model/joined_model.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>

#include "model/georeference.h"
#include "model/hidden_members.h"
#include "model/model_writer.h"
#include "model/round_trip.h"

namespace surfcast::model {
namespace {

using ModelPointer = std::shared_ptr<const ModelFile>;

ModelPointer shared(ModelFile model) {
  return std::make_shared<const ModelFile>(std::move(model));
}

ModelPointer sphere(const TestFolder& folder, const std::string& name, surfel::SurfelCloud cloud) {
  return shared(write_and_open(cloud, folder / (name + ".surf").c_str()));
}

surfel::SurfelCloud moved(surfel::SurfelCloud cloud, const glm::dvec3& by) {
  for (glm::dvec3& position : cloud.positions) position += by;
  return cloud;
}

ModelFile joined(std::vector<Member> members) {
  Result<ModelFile> model = ModelFile::join(std::move(members));
  if (!model) throw std::runtime_error(model.error().message);
  return std::move(*model);
}

void expect_same_points(const DecodedBlock& a, const DecodedBlock& b) {
  EXPECT_EQ(a.grid, b.grid);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.indices, b.indices);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.radii, b.radii);
  EXPECT_EQ(a.weights, b.weights);
}

TEST(JoinedModel, IsTheForestOfItsMembers) {
  const TestFolder folder;
  const ModelPointer a = sphere(folder, "a", sphere_cloud(20000));
  const ModelPointer b = sphere(folder, "b", moved(sphere_cloud(30000), {3, 0, 0}));
  const ModelFile model = joined({{"a", a}, {"b", b}});
  ASSERT_EQ(model.blocks().size(), a->blocks().size() + b->blocks().size());
  EXPECT_EQ(model.tree().roots().size(), a->tree().roots().size() + b->tree().roots().size());
  EXPECT_EQ(model.path().string(), "a+b");
  for (uint32_t i = 0; i < model.blocks().size(); ++i) {
    const Part part = model.part(i);
    EXPECT_EQ(&part.model, part.member == 0 ? a.get() : b.get());
    EXPECT_EQ(part.member, i < a->blocks().size() ? 0U : 1U);
    EXPECT_EQ(model.blocks()[i].level, part.model.blocks()[part.block].level);
    EXPECT_EQ(model.tree().children(i).count, part.model.tree().children(part.block).count);
    const Result<DecodedBlock> block = model.decode(i);
    ASSERT_TRUE(block);
    expect_same_points(*block, *part.model.decode(part.block));
    EXPECT_EQ(block->colors, part.model.decode(part.block)->colors);
  }
}

TEST(JoinedModel, BlocksOfDifferentMembersAreNotMadeTogether) {
  const TestFolder folder;
  const ModelFile model = joined({{"a", sphere(folder, "a", sphere_cloud(20000))},
                                  {"b", sphere(folder, "b", moved(sphere_cloud(30000), {3, 0, 0}))}});
  std::set<uint64_t> units;
  for (uint32_t i = 0; i < model.blocks().size(); ++i) units.insert(model.unit_of(i));
  EXPECT_EQ(units.size(), model.blocks().size());
}

TEST(JoinedModel, HasThePropertiesOfAllItsMembers) {
  const TestFolder folder;
  surfel::SurfelCloud first = sphere_cloud(1000);
  first.scalars.push_back({"intensity", std::vector<uint16_t>(1000, 7)});
  first.sources = {{"a.laz", 0, 1000, std::nullopt}};
  surfel::SurfelCloud second = moved(sphere_cloud(500), {0, 0, 5});
  second.scalars.push_back({"classification", std::vector<uint8_t>(500, 2)});
  second.scalars.push_back({"intensity", std::vector<float>(500, 0.5F)});
  second.sources = {{"b.ply", 0, 500, std::nullopt}};
  second.oriented = false;
  const ModelPointer a = sphere(folder, "a", first);
  const ModelPointer b = sphere(folder, "b", second);
  const ModelFile model = joined({{"a", a}, {"b", b}});
  const ModelInfo& info = model.info();
  EXPECT_EQ(info.surfels, 1500U);
  EXPECT_EQ(info.scalar_names, (std::vector<std::string>{"intensity", "classification"}));
  EXPECT_EQ(info.source_names, (std::vector<std::string>{"a.laz", "b.ply"}));
  geometry::Box bounds = a->info().bounds;
  bounds.include(b->info().bounds);
  EXPECT_EQ(info.bounds.min, bounds.min);
  EXPECT_EQ(info.bounds.max, bounds.max);
  ASSERT_NE(info.range_of("intensity"), nullptr);
  EXPECT_EQ(info.range_of("intensity")->smallest, 0.5);
  EXPECT_EQ(info.range_of("intensity")->largest, 7);
  EXPECT_FALSE(info.oriented) << "one of the scans is not";
  for (uint32_t i = 0; i < model.blocks().size(); ++i) {
    EXPECT_EQ(model.blocks()[i].normals.has_value(), model.part(i).member == 0) << "the other has normals that count";
  }
  ASSERT_EQ(info.classes.size(), 2U);
  EXPECT_EQ(info.classes[0].code, 0U) << "surfels without a class count as unclassified";
  EXPECT_EQ(info.classes[0].surfels, 1000U);
  EXPECT_EQ(info.classes[1].surfels, 500U);
  EXPECT_GT(info.elevation.high, 5);
}

TEST(JoinedModel, FillsInWhatAMemberLacks) {
  const TestFolder folder;
  surfel::SurfelCloud plain = sphere_cloud(100);
  plain.colors.reset();
  surfel::SurfelCloud rich = sphere_cloud(200);
  rich.colors->bits = 16;
  rich.scalars.push_back({"alpha", std::vector<uint8_t>(200, 51)});
  rich.scalars.push_back({"time", std::vector<double>(200, 0.25)});
  surfel::SurfelCloud bytes = sphere_cloud(300);
  bytes.scalars.push_back({"alpha", std::vector<float>(300, 0.5F)});
  const ModelPointer a = sphere(folder, "a", plain);
  const ModelPointer b = sphere(folder, "b", rich);
  const ModelPointer c = sphere(folder, "c", bytes);
  const ModelFile model = joined({{"a", a}, {"b", b}, {"c", c}});
  ASSERT_EQ(model.blocks().size(), 3U);
  ASSERT_EQ(model.info().color_bits, 16);
  const auto alpha = [](const DecodedBlock& block) {
    return std::get<std::vector<float>>(block.scalars.at(0).values)[0];
  };
  const auto time = [](const DecodedBlock& block) {
    return std::get<std::vector<double>>(block.scalars.at(1).values)[0];
  };

  const Result<DecodedBlock> first = model.decode(0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->colors.at(7), glm::u16vec3(0x8000));
  EXPECT_EQ(alpha(*first), 1);
  EXPECT_EQ(time(*first), 0);
  const Result<DecodedBlock> second = model.decode(1);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->colors, b->decode(0)->colors);
  EXPECT_FLOAT_EQ(alpha(*second), 0.2F);
  EXPECT_EQ(time(*second), 0.25);
  const Result<DecodedBlock> third = model.decode(2);
  ASSERT_TRUE(third);
  EXPECT_EQ(third->colors.at(7), c->decode(0)->colors.at(7) * uint16_t{257});
  EXPECT_EQ(alpha(*third), 0.5F);
  EXPECT_DOUBLE_EQ(model.info().range_of("alpha")->smallest, 0.2);

  const Result<DecodedBlock> drawn = model.decode(1, WantedScalars::kDrawn);
  ASSERT_TRUE(drawn);
  ASSERT_EQ(drawn->scalars.size(), 1U) << "times are not drawn";
  EXPECT_FLOAT_EQ(alpha(*drawn), 0.2F);
}

/// A wavy square of side 1 with surfels on a grid, of one colour.
surfel::SurfelCloud square_tile(const glm::dvec3& at, int side, const glm::u16vec3& color) {
  surfel::SurfelCloud cloud;
  cloud.colors = surfel::ColorAttribute{8, {}};
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const glm::dvec2 place = glm::dvec2(x + 0.5, y + 0.5) / double(side);
      cloud.positions.emplace_back(at + glm::dvec3(place, 0.01 * std::sin(9 * (at.x + place.x))));
      cloud.radii.push_back(1.1F / static_cast<float>(side));
      cloud.colors->values.push_back(color);
    }
  }
  cloud.oriented = true;
  const auto count = cloud.size();
  cloud.scalars.push_back({"intensity", std::vector<uint16_t>(count, static_cast<uint16_t>(100 + 10 * at.x))});
  cloud.scalars.push_back({"time", std::vector<double>(count, 3)});
  return finish_cloud(std::move(cloud));
}

constexpr int kTiles = 16;

std::string tile_name(int tile) {
  return "tile" + std::to_string(tile);
}

/// 4 x 4 tiles, each a single block.
std::vector<Member> square_tiles(const TestFolder& folder) {
  std::vector<Member> members;
  for (int i = 0; i < kTiles; ++i) {
    const glm::u16vec3 color(i % 2 == 0 ? 200 : 20, 100, 50);
    members.push_back({tile_name(i), sphere(folder, tile_name(i), square_tile({i % 4, i / 4, 0}, 64, color))});
    if (members.back().model->blocks().size() != 1) throw std::runtime_error("a tile of several blocks");
  }
  return members;
}

double area_of(const DecodedBlock& block) {
  double area = 0;
  for (const float radius : block.radii) area += double{radius} * double{radius};
  return area;
}

TEST(JoinedModel, HasCoarseBlocksAboveItsMembers) {
  const TestFolder folder;
  const ModelFile model = joined(square_tiles(folder));
  const ldc::BlockTree& tree = model.tree();
  ASSERT_EQ(tree.roots().size(), 1U);
  ASSERT_EQ(model.blocks().size(), kTiles + 1U) << "four tiles have as many surfels as a block may have";
  EXPECT_EQ(model.info().surfels, kTiles * 64U * 64U) << "blocks above the members have no surfels of their own";
  EXPECT_EQ(model.info().levels, 2);
  const uint32_t root = tree.roots().front();
  EXPECT_TRUE(model.members_of(root).count() == kTiles);
  EXPECT_EQ(&model.part(root).model, &model);
  EXPECT_FALSE(model.stored(root));

  const Result<DecodedBlock> top = model.decode(root);
  ASSERT_TRUE(top);
  const ldc::BlockEntry& entry = model.blocks()[root];
  EXPECT_NEAR(static_cast<double>(top->size()), 64 * 64, 200) << "a surfel for each ray";
  EXPECT_LE(top->size(), entry.items);
  double area = 0;
  double red = 0;
  double intensity = 0;
  for (uint32_t block = 1; block <= kTiles; ++block) area += area_of(*model.decode(block));
  EXPECT_NEAR(area_of(*top) / area, 1, 0.05);
  ASSERT_EQ(top->scalars.size(), 1U) << "times have no mean";
  for (size_t i = 0; i < top->size(); ++i) {
    const glm::dvec3 at = top->position(i);
    EXPECT_EQ(glm::clamp(at, entry.bounds.min - 0.01, entry.bounds.max + 0.01), at);
    EXPECT_NEAR(at.z, 0.01 * std::sin(9 * at.x), 0.003);
    EXPECT_LE(top->radii[i], entry.max_radius);
    EXPECT_GT(top->normals[i].z, 0.9F);
    red += top->colors[i].x;
    intensity += std::get<std::vector<uint16_t>>(top->scalars[0].values)[i];
  }
  EXPECT_NEAR(intensity / static_cast<double>(top->size()), 115, 1);
  EXPECT_NEAR(red / static_cast<double>(top->size()), 110, 3);
  EXPECT_TRUE(model.decode(root, WantedScalars::kNone)->scalars.empty());
  expect_same_points(*top, *model.decode(root));
}

TEST(JoinedModel, HidesMembersBelowACoarseBlock) {
  const TestFolder folder;
  const ModelFile model = joined(square_tiles(folder));
  const std::vector<bool> hidden = hidden_members(model, std::vector{tile_name(3), tile_name(9)});
  const std::vector<uint32_t> shown = shown_roots(model, hidden);
  ASSERT_EQ(shown.size(), kTiles - 2U);
  for (const uint32_t block : shown) {
    const uint32_t member = model.part(block).member;
    EXPECT_TRUE(member != 3 && member != 9);
  }
  EXPECT_EQ(shown_roots(model, {}), std::vector<uint32_t>{0});
  EXPECT_TRUE(shown_roots(model, std::vector<bool>(kTiles, true)).empty());
}

TEST(JoinedModel, ACoarseBlockOfADamagedMemberNamesIt) {
  const TestFolder folder;
  std::vector<Member> members = square_tiles(folder);
  const std::filesystem::path path = folder / "tile5.surf";
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(members[5].model->blocks()[0].offset) + 100);
    file.write("damage", 6);
  }
  members[5].model = shared(*ModelFile::open(path));
  const ModelFile model = joined(std::move(members));
  const Result<DecodedBlock> top = model.decode(0);
  ASSERT_FALSE(top);
  EXPECT_THAT(top.error().message, ::testing::StartsWith(path.string() + ": block 0: "));
}

TEST(JoinedModel, ManyThreadsMakeACoarseBlockOnce) {
  const TestFolder folder;
  const ModelFile model = joined(square_tiles(folder));
  std::vector<DecodedBlock> blocks(4);
  {
    std::vector<std::jthread> threads;
    for (DecodedBlock& block : blocks) threads.emplace_back([&model, &block] { block = *model.decode(0); });
  }
  for (const DecodedBlock& block : blocks) expect_same_points(block, blocks[0]);
}

Volume one_brick_volume(const std::string& name) {
  Volume volume;
  volume.name = name;
  volume.size = {40, 33, 1};
  volume.histogram.assign(kHistogramBins, 0);
  volume.histogram.front() = volume.samples();
  volume.high = 1;
  return volume;
}

ModelPointer volume_model(const std::filesystem::path& path, const std::string& name) {
  Result<ModelWriter> writer = ModelWriter::create(path, {});
  if (!writer) throw std::runtime_error(writer.error().message);
  const ldc::OctreeKey root;
  std::vector<uint32_t> children;
  for (uint32_t level = 0; level < 2; ++level) {
    for (uint32_t octant = 0; octant < (level == 0 ? 4U : 1U); ++octant) {
      EncodedBlock block;
      block.bytes.assign(7, std::byte{42});
      block.items = 5;
      block.spacing = block.max_radius = level == 0 ? 1.0F : 2.0F;
      block.kind = kGridKind;
      block.brick = {0, level, {octant % 2, octant / 2, 0}, 0, 1};
      const auto added = writer->add(std::move(block), level == 0 ? root.child(octant) : root,
                                     level == 0 ? std::vector<uint32_t>() : children);
      if (level == 0) children.push_back(*added);
    }
  }
  writer->set_volumes({one_brick_volume(name)});
  if (!writer->finish()) throw std::runtime_error("the volume cannot be written");
  Result<ModelFile> model = ModelFile::open(path);
  if (!model) throw std::runtime_error(model.error().message);
  return shared(std::move(*model));
}

TEST(JoinedModel, NumbersTheVolumesOfAllMembers) {
  const TestFolder folder;
  const ModelPointer scan = sphere(folder, "scan", sphere_cloud(100));
  const ModelPointer head = volume_model(folder / "head.surf", "head");
  const ModelPointer chest = volume_model(folder / "chest.surf", "chest");
  const ModelFile model = joined({{"head", head}, {"scan", scan}, {"chest", chest}});
  ASSERT_EQ(model.volumes().size(), 2U);
  EXPECT_EQ(model.volumes()[0].name, "head");
  EXPECT_EQ(model.volumes()[1].name, "chest");
  ASSERT_EQ(model.info().kinds.size(), 2U);
  EXPECT_EQ(model.info().kinds[0].kind, kGridKind);
  EXPECT_EQ(model.info().kinds[0].blocks, 10U);
  EXPECT_EQ(model.info().kinds[1].items, 100U);
  for (uint32_t i = 0; i < model.blocks().size(); ++i) {
    const Part part = model.part(i);
    if (part.member == 1) continue;
    EXPECT_EQ(model.brick(i).volume, part.member / 2);
    EXPECT_EQ(model.brick(i).brick, part.model.brick(part.block).brick);
    EXPECT_EQ(part.first_volume, part.member / 2);
  }
}

TEST(JoinedModel, RefusesTooManyMembersAndOneTwice) {
  const TestFolder folder;
  const ModelPointer one = sphere(folder, "one", sphere_cloud(100));
  std::vector<Member> members;
  for (size_t i = 0; i < kMaxMembers; ++i) members.push_back({std::to_string(i), one});
  EXPECT_TRUE(ModelFile::join(members));
  members.push_back({"more", one});
  const Result<ModelFile> many = ModelFile::join(members);
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().kind, ErrorKind::kLimit);
  const Result<ModelFile> twice = ModelFile::join({{"one", one}, {"one", one}});
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().message, "one: is named twice");
}

TEST(JoinedModel, HidesMembersByName) {
  const TestFolder folder;
  const ModelPointer a = sphere(folder, "a", sphere_cloud(50000));
  const ModelPointer b = sphere(folder, "b", sphere_cloud(100));
  const ModelFile model = joined({{"a", a}, {"b", b}});
  EXPECT_TRUE(hidden_members(model, std::vector<std::string>{"c"}).empty());
  EXPECT_TRUE(hidden_members(*a, std::vector<std::string>{"a"}).empty()) << "a plain model has no members";
  const std::vector<bool> hidden = hidden_members(model, std::vector<std::string>{"b", "c"});
  EXPECT_EQ(hidden, (std::vector<bool>{false, true}));
  const auto roots = a->tree().roots();
  EXPECT_EQ(shown_roots(model, hidden), std::vector<uint32_t>(roots.begin(), roots.end()));
  EXPECT_TRUE(shown_roots(model, {true, true}).empty());
}

TEST(JoinedModel, PlacesTheBlocksOfAMember) {
  const TestFolder folder;
  const ModelPointer a = sphere(folder, "a", sphere_cloud(100));
  const ModelPointer b = sphere(folder, "b", sphere_cloud(50000));
  const glm::dmat4 turned = glm::rotate(glm::translate(glm::dmat4(1), {1e6, 2e6, 3}), 0.3, {0, 0, 1});
  const glm::dmat4x3 place = glm::dmat4x3(glm::scale(turned, glm::dvec3(2)));
  const ModelFile model = joined({{"a", a}, {"b", b, std::vector<glm::dmat4x3>(b->blocks().size(), place)}});
  for (uint32_t i = 0; i < model.blocks().size(); ++i) {
    const Part part = model.part(i);
    if (part.member == 0) continue;
    const Result<DecodedBlock> block = model.decode(i);
    const Result<DecodedBlock> own = b->decode(part.block);
    ASSERT_TRUE(block && own);
    const double half_step = std::sqrt(3.0) / 2 * 2 * own->grid.scale.x;
    const ldc::BlockEntry& entry = model.blocks()[i];
    for (size_t k = 0; k < block->size(); ++k) {
      const glm::dvec3 wanted = place * glm::dvec4(own->position(k), 1);
      ASSERT_LE(glm::length(block->position(k) - wanted), half_step + 1e-9);
      ASSERT_GE(glm::dot(glm::dvec3(block->normals[k]), glm::dmat3(turned) * glm::dvec3(own->normals[k])), 1 - 1e-6);
      ASSERT_FLOAT_EQ(block->radii[k], 2 * own->radii[k]);
      const geometry::Box bounds{entry.bounds.min - half_step, entry.bounds.max + half_step};
      ASSERT_EQ(glm::clamp(block->position(k), bounds.min, bounds.max), block->position(k));
    }
    EXPECT_NEAR(entry.spacing, 2 * b->blocks()[part.block].spacing, 1e-9);
  }
}

TEST(JoinedModel, RefusesToPlaceVolumes) {
  const TestFolder folder;
  const ModelPointer scan = sphere(folder, "scan", sphere_cloud(100));
  const ModelPointer head = volume_model(folder / "head.surf", "head");
  const Result<ModelFile> model =
      ModelFile::join({{"scan", scan}, {"head", head, std::vector<glm::dmat4x3>(head->blocks().size())}});
  ASSERT_FALSE(model);
  EXPECT_THAT(model.error().message, ::testing::StartsWith("head: lies in another coordinate system"));
}

TEST(JoinedModel, NamesTheMemberInErrors) {
  const TestFolder folder;
  const ModelPointer a = sphere(folder, "a", sphere_cloud(100));
  const ModelPointer b = sphere(folder, "b", sphere_cloud(100));
  const ModelFile model = joined({{"a", a}, {"b", b}});
  EXPECT_EQ(model.named(1, {ErrorKind::kInvalidInput, "damaged"}).message,
            (folder / "b.surf").string() + ": block 0: damaged");
}

}  // namespace
}  // namespace surfcast::model
