#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gaussian/gaussian_files.h"
#include "support/packing.h"

namespace surfcast::gaussian {
namespace {

using ::testing::AllOf;
using testing::fault_of;
using ::testing::HasSubstr;
using testing::SogContent;
using testing::SpzContent;
using testing::write;

TEST(SplatTest, RecordsOf32BytesAreRead) {
  const model::TestFolder folder;
  testing::Bytes bytes;
  for (const float value : {1.5F, -2.0F, 3.0F, 0.1F, 0.2F, 0.0F}) bytes.add<float>(value);
  for (const int byte : {0, 255, 51, 128, 128, 0, 128, 192}) bytes.add<uint8_t>(static_cast<uint8_t>(byte));
  const auto path = write(folder / "a.splat", bytes.text() + bytes.text());
  const Gaussians g = testing::read_whole(path);
  ASSERT_EQ(g.size(), 2u);
  EXPECT_EQ(g.positions[1], glm::dvec3(1.5, -2, 3));
  EXPECT_EQ(g.scales[1], glm::vec3(0.1F, 0.2F, 0));
  EXPECT_NEAR(g.harmonics[3], -0.5 / kConstantHarmonic, 1e-6);
  EXPECT_NEAR(g.harmonics[4], 0.5 / kConstantHarmonic, 1e-6);
  EXPECT_NEAR(g.harmonics[5], -0.3 / kConstantHarmonic, 1e-6);
  EXPECT_NEAR(g.opacities[1], 128 / 255.0, 1e-7);
  // (0, -1, 0, 0.5), of length 1.
  EXPECT_NEAR(g.rotations[1].w, 0, 1e-7);
  EXPECT_NEAR(g.rotations[1].x, -1 / std::sqrt(1.25), 1e-6);
  EXPECT_NEAR(g.rotations[1].z, 0.5 / std::sqrt(1.25), 1e-6);
  EXPECT_THAT(fault_of(write(folder / "b.splat", bytes.text().substr(1))), HasSubstr("31 bytes"));
}

void expect_spz_pair(const std::filesystem::path& path, uint32_t version) {
  const Result<GaussianReader> reader = GaussianReader::open(path);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(reader->traits().degree, 1);
  EXPECT_EQ(reader->traits().up, UpAxis::kPlusY);
  EXPECT_EQ(reader->traits().format, "SPZ " + std::to_string(version));
  const Gaussians g = testing::read_whole(path);
  ASSERT_EQ(g.size(), 2u);
  EXPECT_EQ(g.positions[0], glm::dvec3(1, -0.5, 0));
  EXPECT_EQ(g.positions[1], glm::dvec3(-2048, 2048 - 1 / 4096.0, 1 / 4096.0));
  EXPECT_EQ(g.opacities[0], 0.0F);
  EXPECT_EQ(g.opacities[1], 1.0F);
  EXPECT_NEAR(g.scales[0].x, 1, 1e-6);
  EXPECT_NEAR(g.scales[0].y, std::exp(-1.0), 1e-6);
  EXPECT_NEAR(g.scales[1].x, std::exp(-10.0), 1e-9);
  EXPECT_NEAR(g.harmonics[0], -0.5 / 0.15, 1e-6);
  EXPECT_NEAR(g.harmonics[14], 0.1 / 0.15, 1e-6);
  for (size_t k = 0; k < 9; ++k) EXPECT_EQ(g.harmonics[3 + k], static_cast<float>(k) / 128);
  EXPECT_EQ(g.harmonics[15], 9 / 128.0F);
  if (version == 2) {
    EXPECT_NEAR(g.rotations[0].x, 1, 1e-4);
    EXPECT_NEAR(g.rotations[1].w, 1, 1e-4);
  } else {
    EXPECT_EQ(g.rotations[0], glm::quat(1, 0, 0, 0));
    const double part = 256 / 511.0 * std::sqrt(0.5);
    EXPECT_NEAR(g.rotations[1].y, -std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(g.rotations[1].w, part, 1e-6);
    EXPECT_NEAR(g.rotations[1].x, std::sqrt(0.5 - part * part), 1e-6);
    EXPECT_NEAR(g.rotations[1].z, 0, 1e-6);
  }
}

TEST(SpzTest, Versions2To4AreRead) {
  const model::TestFolder folder;
  expect_spz_pair(write(folder / "2.spz", testing::spz(testing::spz_pair(2))), 2);
  expect_spz_pair(write(folder / "3.spz", testing::spz(testing::spz_pair(3))), 3);
  expect_spz_pair(write(folder / "4.spz", testing::spz4(testing::spz_pair(4))), 4);
}

TEST(SpzTest, WithoutHarmonicsTheirColumnIsMissing) {
  const model::TestFolder folder;
  SpzContent content = testing::spz_pair(3);
  content.degree = 0;
  content.columns.pop_back();
  content.flags = 1;
  for (const bool clear : {false, true}) {
    const auto path = write(folder / "a.spz", clear ? testing::spz4(content) : testing::spz(content));
    EXPECT_TRUE(GaussianReader::open(path)->traits().antialiased);
    EXPECT_EQ(testing::read_whole(path).harmonics.size(), 6u);
  }
}

TEST(SpzTest, DegreeFourIsRead) {
  const model::TestFolder folder;
  SpzContent content = testing::spz_pair(4);
  content.degree = 4;
  content.columns.back() = std::string(144, '\xc0');
  const Gaussians g = testing::read_whole(write(folder / "a.spz", testing::spz4(content)));
  ASSERT_EQ(g.harmonics.size(), 150u);
  EXPECT_EQ(g.harmonics[149], 0.5F);
}

TEST(SpzTest, PortionsAndASecondReadingAreTheWhole) {
  const model::TestFolder folder;
  SpzContent content;
  content.count = 5000;
  for (const size_t width : {9, 1, 3, 3, 4}) {
    std::string column(width * content.count, '\0');
    std::mt19937 random(static_cast<unsigned>(width));
    for (char& c : column) c = static_cast<char>(random());
    content.columns.push_back(column);
  }
  for (const bool clear : {false, true}) {
    const auto path = write(folder / "a.spz", clear ? testing::spz4(content) : testing::spz(content));
    const Gaussians whole = testing::read_whole(path);
    Result<GaussianReader> reader = GaussianReader::open(path);
    ASSERT_TRUE(reader);
    for (int round = 0; round < 2; ++round, reader->rewind()) {
      Gaussians all;
      while (reader->position() < 5000) {
        const Result<Gaussians> part = reader->read(777);
        ASSERT_TRUE(part) << part.error().message;
        all.positions.insert(all.positions.end(), part->positions.begin(), part->positions.end());
        all.rotations.insert(all.rotations.end(), part->rotations.begin(), part->rotations.end());
      }
      EXPECT_EQ(all.positions, whole.positions);
      EXPECT_EQ(all.rotations, whole.rotations);
      EXPECT_EQ(reader->read(10)->size(), 0u);
    }
  }
}

TEST(SpzTest, EveryTruncationFails) {
  const model::TestFolder folder;
  for (const std::string& whole :
       {testing::spz(testing::spz_pair(2)), testing::spz(testing::spz_pair(3)), testing::spz4(testing::spz_pair(4))}) {
    for (size_t size = 0; size < whole.size(); ++size) {
      EXPECT_NE(fault_of(write(folder / "a.spz", whole.substr(0, size))), "") << size;
    }
  }
}

TEST(SpzTest, ACountBeyondTheFileFailsAtOnce) {
  const model::TestFolder folder;
  SpzContent content = testing::spz_pair(3);
  content.count = 4000000000;
  const auto path = write(folder / "a.spz", testing::spz(content));
  const Result<GaussianReader> packed = GaussianReader::open(path);
  ASSERT_FALSE(packed);
  EXPECT_THAT(packed.error().message, AllOf(HasSubstr("a.spz"), HasSubstr("states 4000000000 Gaussians")));
  content.count = 3;
  EXPECT_THAT(fault_of(write(folder / "b.spz", testing::spz(content))), HasSubstr("truncated"));
  EXPECT_THAT(fault_of(write(folder / "c.spz", testing::spz4(content))), HasSubstr("not that of 3 Gaussians"));
}

TEST(SpzTest, WhatIsNotReadIsNamed) {
  const model::TestFolder folder;
  const auto fault = [&](SpzContent content) { return fault_of(write(folder / "a.spz", testing::spz(content))); };
  SpzContent content = testing::spz_pair(3);
  content.version = 1;
  EXPECT_THAT(fault(content), HasSubstr("SPZ version 1; 2 to 4 are read"));
  content.version = 5;
  EXPECT_THAT(fault(content), HasSubstr("SPZ version 5"));
  content = testing::spz_pair(3);
  content.degree = 9;
  EXPECT_THAT(fault(content), HasSubstr("harmonics of degree 9"));
  content = testing::spz_pair(3);
  content.count = 0;
  EXPECT_THAT(fault(content), HasSubstr("has no Gaussians"));
  content = testing::spz_pair(4);
  content.columns.pop_back();
  EXPECT_THAT(fault_of(write(folder / "a.spz", testing::spz4(content))), HasSubstr("5 streams for 6 columns"));
}

TEST(SpzTest, ExtensionsThatChangeNothingArePassedOver) {
  const model::TestFolder folder;
  SpzContent content = testing::spz_pair(4);
  content.flags = 2;
  const auto record = [](uint32_t type, const std::string& payload) {
    testing::Bytes bytes;
    bytes.add<uint32_t>(type).add<uint32_t>(static_cast<uint32_t>(payload.size())).add_text(payload);
    return bytes.text();
  };
  const auto limits = [](float min, float max) {
    testing::Bytes bytes("\5\4");
    return bytes.add<float>(min).add<float>(max).text();
  };
  const std::string camera = record(0xadbe0002, std::string(12, '\0'));
  expect_spz_pair(write(folder / "a.spz", testing::spz4(content, camera + record(0xadbe0001, limits(-1, 1)))), 4);
  EXPECT_THAT(fault_of(write(folder / "b.spz", testing::spz4(content, record(0xadbe0001, limits(-2, 1))))),
              HasSubstr("limits of their own"));
  EXPECT_THAT(fault_of(write(folder / "c.spz", testing::spz4(content, camera.substr(0, 14)))), HasSubstr("cut off"));
  content = testing::spz_pair(3);
  content.flags = 2;
  content.columns.push_back(camera);
  expect_spz_pair(write(folder / "d.spz", testing::spz(content)), 3);
  content.columns.pop_back();
  content.columns.insert(content.columns.begin(), camera);
  EXPECT_THAT(fault_of(write(folder / "e.spz", testing::spz(content))), HasSubstr("extensions before the columns"));
}

void expect_sog_pair(const std::filesystem::path& path) {
  const Result<GaussianReader> reader = GaussianReader::open(path);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(reader->traits().degree, 1);
  EXPECT_TRUE(reader->traits().antialiased);
  EXPECT_GT(reader->held_bytes(), 0u);
  const Gaussians g = testing::read_whole(path);
  ASSERT_EQ(g.size(), 2u);
  // Codes 0, 65535 and 32768 between the logarithmic ends -1..1, 0..2 and -2..0.
  EXPECT_EQ(g.positions[0].x, static_cast<float>(1 - std::exp(1.0)));
  EXPECT_EQ(g.positions[0].y, static_cast<float>(std::exp(2.0) - 1));
  EXPECT_NEAR(g.positions[0].z, 1 - std::exp(2 - 2 * 32768 / 65535.0), 1e-6);
  EXPECT_NEAR(g.scales[0].y, std::exp(-8 + 32 * 0.03125), 1e-6);
  // Alpha is an opacity: colours are not multiplied by it, not even by 0.
  EXPECT_NEAR(g.opacities[0], 17 / 255.0, 1e-7);
  EXPECT_EQ(g.harmonics[0], -2 + 169 * 0.015625F);
  EXPECT_EQ(g.harmonics[2], -2 + 110 * 0.015625F);
  EXPECT_EQ(g.opacities[1], 0.0F);
  EXPECT_EQ(g.harmonics[12 + 1], -2 + 2 * 0.015625F);
  // w is left out of the first, y of the second.
  const double big = std::sqrt(0.5);
  const double small = (2 * 128 / 255.0 - 1) * big;
  EXPECT_NEAR(g.rotations[0].x, big, 1e-6);
  EXPECT_NEAR(g.rotations[0].w, std::sqrt(0.5 - 2 * small * small), 1e-6);
  EXPECT_NEAR(g.rotations[1].x, -big, 1e-6);
  EXPECT_NEAR(g.rotations[1].z, small, 1e-6);
  // Entries 3 and 69 of the palette; 69 is in the second row.
  for (size_t k = 0; k < 9; ++k) {
    EXPECT_EQ(g.harmonics[3 + k], 0.5F * static_cast<float>(3 + k));
    EXPECT_EQ(g.harmonics[15 + k], 0.5F * static_cast<float>(69 + k));
  }
}

TEST(SogTest, FolderDescriptionAndArchiveAreRead) {
  const model::TestFolder folder;
  const SogContent content = testing::sog_pair();
  expect_sog_pair(testing::write_sog_folder(folder / "model", content));
  expect_sog_pair(folder / "model" / "meta.json");
  for (const bool deflated : {false, true}) {
    expect_sog_pair(write(folder / "a.sog", testing::sog_zip(content, deflated)));
    expect_sog_pair(write(folder / "b.zip", testing::sog_zip(content, deflated, "model/")));
  }
}

/// The fault of the pair with one file replaced; "meta.json" is the description.
std::string fault_with(const std::string& name, const std::string& text) {
  const model::TestFolder folder;
  SogContent content = testing::sog_pair();
  for (auto& [file, old] : content.files) {
    if (file == name) old = text;
  }
  if (name == "meta.json") content.meta = text;
  return fault_of(testing::write_sog_folder(folder / "model", content));
}

TEST(SogTest, LabelsBeyondThePaletteAreNamed) {
  const model::TestFolder folder;
  EXPECT_THAT(fault_of(testing::write_sog_folder(folder / "model", testing::sog_pair("2", 70))),
              AllOf(HasSubstr("meta.json"), HasSubstr("n.webp"), HasSubstr("label 70 beyond the palette of 70")));
}

TEST(SogTest, RotationsOfNoKnownKindAreNamed) {
  EXPECT_THAT(fault_with("q.webp", testing::webp(2, 1, {1, 2, 3, 252, 1, 2, 3, 251})),
              AllOf(HasSubstr("q.webp"), HasSubstr("rotation 1")));
}

TEST(SogTest, PicturesThatDoNotFitTheCountAreNamed) {
  const model::TestFolder folder;
  EXPECT_THAT(fault_of(testing::write_sog_folder(folder / "model", testing::sog_pair("5"))),
              AllOf(HasSubstr("l.webp"), HasSubstr("4 pixels are not those of 5 Gaussians")));
  const std::string large = testing::webp(1000, 1000, std::vector<uint8_t>(4000000));  // some hundred bytes
  EXPECT_THAT(fault_with("u.webp", large), HasSubstr("1000000 pixels"));
  EXPECT_THAT(fault_with("p.webp", large), HasSubstr("70 palette entries"));
}

TEST(SogTest, DecodedPicturesStayWithinTheLimit) {
  const model::TestFolder folder;
  const auto path = write(folder / "a.sog", testing::sog_zip(testing::sog_pair(), true));
  EXPECT_THAT(fault_of(path, {1000}), HasSubstr("a.sog"));
  EXPECT_EQ(fault_of(path, {100000}), "");
}

TEST(SogTest, LossyAndDamagedPicturesAreNamed) {
  const std::vector<uint8_t> pixels(4 * 16 * 16, 100);
  EXPECT_THAT(fault_with("s.webp", testing::webp(16, 16, pixels, false)), HasSubstr("not a lossless picture"));
  EXPECT_THAT(fault_with("s.webp", "no picture"), AllOf(HasSubstr("s.webp"), HasSubstr("not a WebP picture")));
  const std::string whole = testing::webp(2, 2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16});
  for (size_t size = 0; size < whole.size() - 1; size += 3) {
    EXPECT_NE(fault_with("s.webp", whole.substr(0, size)), "") << size;
  }
}

TEST(SogTest, BadDescriptionsAreNamed) {
  const std::string meta = testing::sog_pair().meta;
  const auto replaced = [&meta](const std::string& from, const std::string& to) {
    std::string text = meta;
    return fault_with("meta.json", text.replace(text.find(from), from.size(), to));
  };
  EXPECT_THAT(replaced("\"version\":2", "\"version\":3"), HasSubstr("SOG version 3; 2 is read"));
  EXPECT_THAT(replaced("\"version\":2,", ""), HasSubstr("SOG version 1"));
  EXPECT_THAT(replaced("\"count\":2", "\"count\":-2"), HasSubstr("count is missing or wrong"));
  EXPECT_THAT(replaced("\"count\":2", "\"count\":99999999999999"), HasSubstr("count is missing or wrong"));
  EXPECT_THAT(replaced("\"count\":2", "\"count\":0"), HasSubstr("has no Gaussians"));
  EXPECT_THAT(replaced("[-1,0,-2]", "[-1,null,-2]"), HasSubstr("means/mins"));
  EXPECT_THAT(replaced("[-8.0", "[-9.0,-8.0"), HasSubstr("scales/codebook"));
  EXPECT_THAT(replaced("\"bands\":1", "\"bands\":4"), HasSubstr("shN/bands"));
  EXPECT_THAT(replaced("[\"l.webp\",", "["), HasSubstr("means/files"));
  EXPECT_THAT(replaced("\"l.webp\"", "\"../l.webp\""), HasSubstr("not in its folder"));
  EXPECT_THAT(replaced("\"l.webp\"", "\"missing.webp\""), HasSubstr("missing.webp"));
  EXPECT_THAT(fault_with("meta.json", meta.substr(0, meta.size() - 1)), HasSubstr("damaged JSON"));
}

TEST(SogTest, FilesOfAnArchiveThatUnpackWithoutMeasureAreRefused) {
  const model::TestFolder folder;
  SogContent content = testing::sog_pair();
  content.meta += std::string(10000000, ' ');
  EXPECT_THAT(fault_of(write(folder / "a.sog", testing::sog_zip(content, true))),
              AllOf(HasSubstr("a.sog"), HasSubstr("meta.json"), HasSubstr("unpacks to far more")));
  EXPECT_EQ(fault_of(write(folder / "b.sog", testing::sog_zip(content, false))), "");
}

TEST(SogTest, DamagedArchivesFail) {
  const model::TestFolder folder;
  const std::string whole = testing::sog_zip(testing::sog_pair(), true);
  for (size_t size = 4; size < whole.size(); size += 7) {
    EXPECT_NE(fault_of(write(folder / "a.sog", whole.substr(0, size))), "") << size;
  }
  SogContent content = testing::sog_pair();
  content.files.erase(content.files.begin() + 3);
  EXPECT_THAT(fault_of(write(folder / "a.sog", testing::sog_zip(content, false))), HasSubstr("no file q.webp"));
}

TEST(GaussianReaderTest, DamagedFilesFailOrYieldGaussiansButNothingElse) {
  const model::TestFolder folder;
  std::mt19937 random(11);
  const std::vector<std::pair<const char*, std::string>> samples = {
      {"a.ply", testing::float_ply(testing::gaussian_properties(1), {testing::gaussian_row(1)})},
      {"a.ply", testing::compressed_ply({std::vector<float>(18, 1.0F)}, {{1, 2, 3, 4, std::vector<uint8_t>(9)}})},
      {"a.spz", testing::spz(testing::spz_pair(2))},
      {"a.spz", testing::spz4(testing::spz_pair(4))},
      {"a.sog", testing::sog_zip(testing::sog_pair(), false)}};
  for (const auto& [name, whole] : samples) {
    for (int round = 0; round < 300; ++round) {
      std::string text = whole;
      for (int i = 0; i < 3; ++i) text[random() % text.size()] = static_cast<char>(random());
      (void)fault_of(write(folder / name, text), {10000000});
    }
  }
}

TEST(GaussianReaderTest, OtherFilesAreNoGaussians) {
  const model::TestFolder folder;
  EXPECT_THAT(fault_of(write(folder / "a.ply", testing::float_ply({"x", "y", "z"}, {{1, 2, 3}}))),
              HasSubstr("not a model of Gaussians"));
  EXPECT_THAT(fault_of(write(folder / "b.spz", testing::gzip("something else"))), HasSubstr("not a model"));
  EXPECT_THAT(fault_of(write(folder / "c.json", "{\"a\": 1}")), HasSubstr("not a model"));
  EXPECT_THAT(fault_of(write(folder / "d.splat", "")), HasSubstr("the file is empty"));
}

}  // namespace
}  // namespace surfcast::gaussian
