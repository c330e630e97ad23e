#include "service/place_members.h"

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "crs/known_system.h"
#include "crs/transformation.h"
#include "ldc/subtree.h"
#include "model/georeference.h"
#include "model/model_writer.h"
#include "model/test_clouds.h"
#include "model/test_folder.h"
#include "model/write_blocks.h"

namespace surfcast::service {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using ModelPointer = std::shared_ptr<const model::ModelFile>;

constexpr double kSpacing = 0.5;  // metres

/// Hills east of Munich, between the zones 32 and 33, in coordinates of zone 32.
std::vector<glm::dvec3> hills() {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 300; ++i) {
    for (int j = 0; j < 300; ++j) {
      points.emplace_back(715'000 + kSpacing * i, 5'334'000 + kSpacing * j, 500 + 10 * std::sin(0.02 * (i + 2 * j)));
    }
  }
  return points;
}

std::vector<glm::dvec3> moved(const char* from, const char* to, std::vector<glm::dvec3> points) {
  geometry::Box bounds;
  for (const glm::dvec3& point : points) bounds.include(point);
  const auto way = crs::Transformation::between(crs::known_system(from), crs::known_system(to), bounds);
  EXPECT_TRUE(way);
  way->apply(points);
  return points;
}

model::Georeference in_system(const char* text) {
  const crs::CoordinateSystem system = crs::known_system(text);
  return {{system.name, system.id, system.wkt}, {}};
}

ModelPointer write(const std::filesystem::path& path, const std::vector<glm::dvec3>& points, double spacing,
                   const model::Georeference& georeference) {
  surfel::SurfelCloud cloud;
  cloud.positions = points;
  cloud.radii.assign(points.size(), static_cast<float>(spacing));
  cloud = model::finish_cloud(std::move(cloud));
  model::number_surfels(cloud);
  Result<model::ModelWriter> writer = model::ModelWriter::create(path, model::schema_of(cloud));
  const ldc::Subtree tree = ldc::build_subtree(cloud, ldc::whole_region(cloud), {}, 0);
  if (!writer || !model::write_blocks(*writer, cloud, tree.blocks, [](size_t) {}))
    throw std::runtime_error("not written");
  writer->set_georeference(georeference);
  if (!writer->finish()) throw std::runtime_error("not finished");
  return std::make_shared<const model::ModelFile>(*model::ModelFile::open(path));
}

TEST(PlaceMembers, ScansOfTwoZonesLieWhereTheTransformationPutsThem) {
  const model::TestFolder folder;
  const std::vector<glm::dvec3> wanted = hills();
  const ModelPointer a = write(folder / "a.surf", wanted, kSpacing, in_system("EPSG:25832"));
  const ModelPointer b =
      write(folder / "b.surf", moved("EPSG:25832", "EPSG:25833", wanted), kSpacing, in_system("EPSG:25833"));
  std::vector<model::Member> members{{"a", a}, {"b", b}};
  const Status placed = place_members(members);
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_TRUE(members[0].places.empty());
  ASSERT_EQ(members[1].places.size(), b->blocks().size());
  const Result<model::ModelFile> joined = model::ModelFile::join(std::move(members));
  ASSERT_TRUE(joined);
  size_t found = 0;
  double largest = 0;
  for (uint32_t i = 0; i < joined->blocks().size(); ++i) {
    if (joined->part(i).member == 0 || joined->blocks()[i].level > 0) continue;
    const auto block = joined->decode(i);
    ASSERT_TRUE(block);
    const auto& numbers = std::get<std::vector<uint32_t>>(block->scalars.back().values);
    for (size_t k = 0; k < block->size(); ++k, ++found) {
      largest = std::max(largest, glm::length(block->position(k) - wanted[numbers[k]]));
    }
  }
  EXPECT_EQ(found, wanted.size());
  EXPECT_LT(largest, 0.01 * kSpacing);
  EXPECT_EQ(joined->georeference()->system.id, "EPSG:25832");
}

TEST(PlaceMembers, ModelsOfOneSystemOrOfNoneLieAsTheyAre) {
  const model::TestFolder folder;
  const std::vector<glm::dvec3> points{{0, 0, 0}, {1, 0, 0}};
  const ModelPointer none = write(folder / "none.surf", points, 1, {});
  const ModelPointer one = write(folder / "one.surf", points, 1, in_system("EPSG:25832"));
  const ModelPointer other = write(folder / "other.surf", points, 1, in_system("EPSG:25832"));
  std::vector<model::Member> members{{"none", none}, {"one", one}, {"other", other}};
  ASSERT_TRUE(place_members(members));
  for (const model::Member& member : members) EXPECT_TRUE(member.places.empty()) << member.name;
}

TEST(PlaceMembers, WhatCannotBePlacedIsNamed) {
  const model::TestFolder folder;
  const ModelPointer here = write(folder / "here.surf", hills(), kSpacing, in_system("EPSG:25832"));
  const ModelPointer local = write(folder / "local.surf", {{0, 0, 0}, {1, 0, 0}}, 1,
                                   {{"site", "", "LOCAL_CS[\"site\",UNIT[\"metre\",1]]"}, {}});
  std::vector<model::Member> members{{"here", here}, {"local", local}};
  const Status lost = place_members(members);
  ASSERT_FALSE(lost);
  EXPECT_THAT(lost.error().message, StartsWith("local: cannot be shown in the coordinate system of the first model"));

  // Few points over a whole country.
  std::vector<glm::dvec3> sparse;
  for (int i = 0; i < 20'000; ++i) sparse.emplace_back(300'000 + 30.0 * i, 5'300'000 + 17.0 * (i % 1000), 0);
  const ModelPointer country = write(folder / "country.surf", sparse, 1, in_system("EPSG:25833"));
  std::vector<model::Member> large{{"here", here}, {"country", country}};
  const Status bent = place_members(large);
  ASSERT_FALSE(bent);
  EXPECT_THAT(bent.error().message, StartsWith("country: "));
  EXPECT_THAT(bent.error().message, HasSubstr("too large"));
}

}  // namespace
}  // namespace surfcast::service
