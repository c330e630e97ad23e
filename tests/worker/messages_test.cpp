#include "worker/messages.h"

#include <limits>
#include <random>
#include <span>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::worker {
namespace {

/// The message after its way through bytes.
template <typename T>
T sent(const T& message) {
  const Result<Message> received = decode(encode(message));
  EXPECT_TRUE(received);
  EXPECT_TRUE(std::holds_alternative<T>(*received));
  return std::get<T>(*received);
}

/// Another value of a plain option.
template <typename Member>
void change(Member& member) {
  if constexpr (std::is_enum_v<Member>) {
    member = static_cast<Member>(1);
  } else if constexpr (std::is_arithmetic_v<Member>) {
    member = static_cast<Member>(member + 1.25);
  } else {
    member = {9, 8, 7};
  }
}

/// A request in which no member has its default.
picture::PictureRequest full_request() {
  picture::PictureRequest r;
  picture::with_members(static_cast<picture::PlainOptions&>(r), [](auto&... members) { (change(members), ...); });
  r.camera = geometry::Camera{{1, 2, 3}, {4, 5, 6}, {0, 0.5, 1}, 47};
  r.width = 321;
  r.height = 123;
  r.silhouettes = true;
  r.blends_behind = true;
  r.format = picture::PixelFormat::kLinearFloat;
  r.loading = picture::Loading::kNow;
  r.edition = 3;
  r.viewer = 4;
  r.rest_spacing = 0.75;
  r.displayed_cut = 5;
  r.max_missing_blocks = 6;
  r.coloring = {picture::SurfelColor::kAttribute, picture::ColorMap::kTurbo, -1.5, 2.5, "fa"};
  r.hidden_classes.set(2).set(255);
  r.clip.inside.push_back({{0, 0, 0}, {1, 1, 1}});
  r.clip.outside = {{{2, 2, 2}, {3, 3, 3}}, {{4, 4, 4}, {5, 5, 5}}};
  r.eye_dome = {0.5, 2};
  r.volumes.transfer.points = {{1, {0.1, 0.2, 0.3}, 0.4, 5.0}, {2, {0.4, 0.5, 0.6}, 0.7, std::nullopt}};
  r.volumes.transfer.spacing = 0.1;
  r.volumes.transfer.preset = picture::TransferPreset::kMr;
  r.volumes.transfer.first = 10;
  r.volumes.transfer.last = 20;
  r.volumes.shaded = true;
  r.volumes.medium = false;
  r.volumes.isos = {{300, {1, 0, 0}, 0.5}};
  r.volumes.slices = {{{1, 2, 3}, {0, 0, 1}, 2, 17.5}};
  r.glyphs.shape = picture::GlyphShape::kSuperquadric;
  r.glyphs.radius = picture::GlyphRadius::kUnit;
  r.glyphs.scale = 12;
  r.glyphs.sharpness = 4;
  r.glyphs.thresholds = {{"md", 0.1, std::numeric_limits<double>::infinity()}};
  r.lighting = {0.1, 0.2, 16, {{{0, 1, 0}, 0.5}}};
  r.class_opacities = {{6, 0.25}};
  r.hidden_models = {"tower", "nave"};
  return r;
}

TEST(MessagesTest, AllOfARequestArrives) {
  const picture::PictureRequest r = sent(Draw{77, full_request()}).request;
  ASSERT_TRUE(r.camera);
  EXPECT_EQ(r.camera->position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(r.camera->view_angle, 47);
  EXPECT_EQ(r.width, 321);
  EXPECT_EQ(r.shading, picture::Shading::kUnlit);
  EXPECT_TRUE(r.silhouettes && r.blends_behind);
  EXPECT_EQ(r.background, glm::u8vec3(9, 8, 7));
  EXPECT_EQ(r.rest_spacing, 0.75);
  EXPECT_EQ(r.coloring.attribute, "fa");
  EXPECT_EQ(r.coloring.first, -1.5);
  EXPECT_TRUE(r.hidden_classes.count() == 2 && r.hidden_classes[2] && r.hidden_classes[255]);
  ASSERT_EQ(r.clip.outside.size(), 2U);
  EXPECT_EQ(r.clip.outside[1].max, glm::dvec3(5, 5, 5));
  EXPECT_EQ(r.volumes.transfer.points, full_request().volumes.transfer.points);
  EXPECT_EQ(r.volumes.slices.at(0).axis, 2);
  EXPECT_EQ(r.glyphs.thresholds, full_request().glyphs.thresholds);
  EXPECT_EQ(r.lighting.lights, full_request().lighting.lights);
  EXPECT_EQ(r.class_opacities.at(0).code, 6);
  EXPECT_EQ(r.hidden_models, (std::vector<std::string>{"tower", "nave"}));
  EXPECT_EQ(r.ghost, 1.25);
  EXPECT_EQ(r.error, 1.25);
  EXPECT_EQ(r.opacity, 2.25);
}

// Every member is written and read: what was read is written as the same bytes, and what is cut off is noticed.
TEST(MessagesTest, ARequestThatArrivedHasTheBytesOfTheOneThatWasSent) {
  const Draw draw{77, full_request()};
  EXPECT_EQ(encode(sent(draw)), encode(draw));
  EXPECT_NE(encode(Draw{77, {}}), encode(draw));
}

TEST(MessagesTest, TheConfigurationArrives) {
  Configure configure;
  configure.renderer.gpu = 2;
  configure.renderer.gpu_bytes = size_t{5} << 32;
  configure.renderer.decoders = 3;
  configure.log_format = LogFormat::kJson;
  configure.sandbox = false;
  configure.readable = {"/opt/driver", ""};
  configure.writable = {"/var/cache/shaders"};
  const Configure received = sent(configure);
  EXPECT_EQ(received.renderer.gpu, 2);
  EXPECT_EQ(received.renderer.gpu_bytes, size_t{5} << 32);
  EXPECT_FALSE(received.renderer.host_bytes);
  EXPECT_EQ(received.renderer.decoders, 3U);
  EXPECT_EQ(received.log_format, LogFormat::kJson);
  EXPECT_FALSE(received.sandbox);
  EXPECT_EQ(received.readable, configure.readable);
  EXPECT_EQ(received.writable, configure.writable);
}

TEST(MessagesTest, AFrameArrivesWithoutItsPixels) {
  Drawn drawn;
  drawn.frame.image = {4, 5, picture::PixelFormat::kSrgb8, std::vector<std::byte>(80)};
  drawn.frame.camera.view_angle = 12;
  drawn.frame.converged = true;
  drawn.frame.cut = 99;
  drawn.frame.stats.levels = {{1, 2, 3}};
  drawn.frame.stats.gl_renderer = "llvmpipe";
  drawn.frame.stats.stages = {{"draw", 1.5}};
  drawn.pixels = true;
  const Drawn received = sent(drawn);
  EXPECT_TRUE(received.pixels && received.frame.converged && received.frame.image.pixels.empty());
  EXPECT_EQ(received.frame.image.height, 5);
  EXPECT_EQ(received.frame.cut, 99U);
  EXPECT_EQ(received.frame.stats.levels.at(0).drawn, 3U);
  EXPECT_EQ(received.frame.stats.stages.at(0).name, "draw");
}

/// Questions and answers in which no member has its default.
std::vector<Message> full_queries() {
  kinds::PickedSurfel item{{1, 2, 3}, {0, 0, 1}, glm::u8vec3(4, 5, 6), 0.5, 7, {{"fa", 0.25}, {"", -1}}, 8, 9, 3};
  const pick::BandPoint point{{1, 2, 3}, {4, 5}, {6, 7, 8}};
  service::PointsQuery points{"lion", {}, exporter::PointFormat::kPly, 12, true};
  points.selection.points = {{{{{0, 0, 0}, {1, 1, 1}}}, {{{{0, 1}, {2, 3}}, 0.5, -1, 1}}}, {2, 6}, 3};
  points.selection.source_coordinates = points.selection.normals = true;
  exporter::PointFacts facts{5, {{0, 0, 0}, {1, 1, 1}}, {1, 2, 3}, surfel::Grid{glm::dvec3(0.1), glm::dvec3(7)}};
  return {ConfigureQueries{LogFormat::kJson, false, {"/usr"}, 99, 100},
          Pick{3, {{full_request(), true}, 4, 5, 6}},
          Picked{item},
          SearchSurface{3, {full_request(), true}},
          SurfacePart{{std::byte{1}, std::byte{2}}},
          FindBand{3, {{{0, 1, 2}, {3, 4, 5}}, 0.5, 7}},
          BandPart{9, 8, {glm::dvec3(0.1), glm::dvec3(7)}, {point, point}, {1, 2}, true},
          OpenPoints{1, 2, points},
          CountPoints{3},
          PointsCounted{facts, true},
          NextPiece{4, 5},
          PointsPiece{{{std::byte{3}}, true}},
          ClosePoints{6},
          OfferJoin{7, {{1, "nave", {}}, {2, "tower", {glm::dmat4x3(2), glm::dmat4x3(3)}}}, "nave+tower", {4}, {5, 6}}};
}

TEST(MessagesTest, QueriesThatArrivedHaveTheBytesOfThoseThatWereSent) {
  for (const Message& message : full_queries()) {
    const std::vector<std::byte> bytes = encode(message);
    const Result<Message> received = decode(bytes);
    ASSERT_TRUE(received) << message.index();
    EXPECT_EQ(received->index(), message.index());
    EXPECT_EQ(encode(*received), bytes) << message.index();
    for (size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(decode(std::span(bytes).first(size))) << size;
  }
}

TEST(MessagesTest, AllOfAnItemAndOfAJobArrives) {
  const Picked picked = sent(std::get<Picked>(full_queries()[2]));
  ASSERT_TRUE(picked.item);
  EXPECT_EQ(picked.item->values.at(0).attribute, "fa");
  EXPECT_EQ(picked.item->color, glm::u8vec3(4, 5, 6));
  EXPECT_EQ(picked.item->number, 9U);
  EXPECT_EQ(picked.item->member, 3U);
  const service::PointsQuery points = sent(std::get<OpenPoints>(full_queries()[7])).query;
  EXPECT_EQ(points.selection.points.zone.corridors.at(0).line.at(1), glm::dvec2(2, 3));
  EXPECT_EQ(points.selection.points.classes, (std::vector<uint8_t>{2, 6}));
  EXPECT_TRUE(points.only_count && points.selection.normals);
}

TEST(MessagesTest, AllOfAJoinArrives) {
  const OfferJoin join = sent(std::get<OfferJoin>(full_queries().back()));
  ASSERT_EQ(join.parts.size(), 2U);
  EXPECT_EQ(join.parts[1].name, "tower");
  EXPECT_EQ(join.parts[1].places, (std::vector<glm::dmat4x3>{glm::dmat4x3(2), glm::dmat4x3(3)}));
  EXPECT_EQ(join.suspected, (std::vector<uint32_t>{5, 6}));
}

TEST(MessagesTest, ErrorsArrive) {
  const Error error = sent(Refused{{ErrorKind::kLimit, "too large"}}).error;
  EXPECT_EQ(error.kind, ErrorKind::kLimit);
  EXPECT_EQ(error.message, "too large");
}

TEST(MessagesTest, EveryTruncationIsRefused) {
  const std::vector<std::byte> bytes = encode(Draw{77, full_request()});
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode(std::span(bytes).first(size))) << size;
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(decode(longer));
}

TEST(MessagesTest, DamagedMessagesAreReadOrRefused) {
  std::mt19937 random(7);
  std::vector<std::vector<std::byte>> originals{encode(Draw{77, full_request()}), encode(Drawn{}), encode(Configure{}),
                                                encode(OfferModel{1, "a", {1, 2}, {3}})};
  for (const Message& message : full_queries()) originals.push_back(encode(message));
  size_t refused = 0;
  for (int i = 0; i < 100'000; ++i) {
    std::vector<std::byte> bytes = originals[random() % originals.size()];
    for (unsigned flips = 1 + random() % 4; flips > 0; --flips) bytes[random() % bytes.size()] = std::byte(random());
    refused += decode(bytes) ? 0 : 1;
  }
  EXPECT_GT(refused, 1000U);
}

}  // namespace
}  // namespace surfcast::worker
