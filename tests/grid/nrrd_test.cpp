#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grid/grid_files.h"
#include "support/packing.h"

namespace surfcast::grid {
namespace {

using ::testing::AllOf;
using testing::expect_ramp;
using testing::fault_of;
using ::testing::HasSubstr;
using testing::ramp_bytes;
using testing::world;
using testing::write;

/// A header of the ramp with these additional lines.
std::string ramp_header(const std::string& lines) {
  return "NRRD0005\n# a comment\nkey:=value: with colon\ntype: short\ndimension: 3\nsizes: 3 2 2\n" + lines;
}

std::string with_ramp(const std::string& lines) {
  return ramp_header("endian: little\nencoding: raw\n" + lines) + "\n" + ramp_bytes();
}

template <typename T>
void expect_type(const std::string& type, const std::vector<T>& values) {
  const model::TestFolder folder;
  for (const bool big : {false, true}) {
    SCOPED_TRACE(type + (big ? " big" : " little"));
    const std::string text = "NRRD0001\nType: " + type + "\ndimension: 3\nsizes: 1 1 " + std::to_string(values.size()) +
                             "\nENDIAN: " + (big ? "big" : "little") + "\r\nencoding: raw\n\n" +
                             testing::packed_numbers(values, big);
    Result<GridReader> reader = GridReader::open(write(folder / "grid.nrrd", text));
    ASSERT_TRUE(reader) << reader.error().message;
    std::vector<T> read(values.size());
    ASSERT_TRUE(reader->read(std::as_writable_bytes(std::span(read))));
    EXPECT_EQ(read, values);
    ASSERT_TRUE(reader->seek(0));
    EXPECT_EQ(testing::read_values(*reader).value(), std::vector<double>(values.begin(), values.end()));
  }
}

TEST(NrrdTest, EveryTypeIsReadInBothByteOrders) {
  expect_type<int8_t>("signed char", {-128, 0, 127});
  expect_type<uint8_t>("uint8_t", {0, 200, 255});
  expect_type<int16_t>("short int", {-32768, 1, 258});
  expect_type<uint16_t>("unsigned short", {0, 258, 65535});
  expect_type<int32_t>("int", {-2147483647, 66051, 0});
  expect_type<uint32_t>("uint32", {4294967295U, 66051, 0});
  expect_type<int64_t>("long long int", {-1099511627776, 1, 0});
  expect_type<uint64_t>("uint64", {1099511627776, 1, 0});
  expect_type<float>("float", {-1.5F, 3e30F, 0});
  expect_type<double>("double", {-1.5, 3e300, 0.1});
}

TEST(NrrdTest, LineEndingsOfTwoCharactersAreRead) {
  const model::TestFolder folder;
  const std::string text =
      "NRRD0004\r\ntype: short\r\ndimension: 3\r\nsizes: 3 2 2\r\nendian: little\r\n"
      "encoding: raw\r\n\r\n" +
      ramp_bytes();
  expect_ramp(write(folder / "grid.nrrd", text));
}

TEST(NrrdTest, DetachedSamplesAreFoundInOneFileAListAndAPattern) {
  const model::TestFolder folder;
  const std::string bytes = ramp_bytes();
  write(folder / "all.raw", bytes);
  write(folder / "s08.raw", bytes.substr(0, 12));
  write(folder / "s10.raw", bytes.substr(12));
  const std::string header = ramp_header("endian: little\nencoding: raw\n");
  expect_ramp(write(folder / "one.nhdr", header + "data file: all.raw\n"));
  expect_ramp(write(folder / "list.nhdr", header + "datafile: LIST\ns08.raw\ns10.raw\n"));
  expect_ramp(write(folder / "pattern.nhdr", header + "data file: s%02d.raw 8 10 2\n"));
}

TEST(NrrdTest, EachOfSeveralPackedFilesIsUnpacked) {
  const model::TestFolder folder;
  const std::string bytes = ramp_bytes();
  write(folder / "1.gz", testing::gzip(bytes.substr(0, 12)));
  write(folder / "2.gz", testing::gzip(bytes.substr(12)));
  const std::string header = ramp_header("endian: little\nencoding: gzip\n");
  expect_ramp(write(folder / "grid.nhdr", header + "data file: %d.gz 1 2 1\n"));
}

TEST(NrrdTest, LinesAndBytesBeforeTheSamplesAreSkipped) {
  const model::TestFolder folder;
  const std::string lines = "a line\nanother\n";
  write(folder / "both.raw", lines + "xyz" + ramp_bytes());
  write(folder / "end.raw", lines + ramp_bytes());
  write(folder / "packed.raw", lines + testing::gzip("xyz" + ramp_bytes()));
  const auto header = [](const std::string& encoding, const std::string& more) {
    return ramp_header("endian: little\nencoding: " + encoding + "\n" + more);
  };
  expect_ramp(write(folder / "a.nhdr", header("raw", "line skip: 2\nbyte skip: 3\ndata file: both.raw\n")));
  expect_ramp(write(folder / "b.nhdr", header("raw", "byteskip: -1\ndata file: end.raw\n")));
  expect_ramp(write(folder / "c.nhdr", header("gz", "lineskip: 2\nbyte skip: 3\ndata file: packed.raw\n")));
}

TEST(NrrdTest, ObliqueAndReversedAxesPlaceSamplesInTheWorld) {
  const model::TestFolder folder;
  const GridHeader header = expect_ramp(
      write(folder / "grid.nrrd", with_ramp("space: right-anterior-superior\nspace units: \"mm\" \"mm\" \"mm\"\n"
                                            "sample units: HU\nspace directions: (0.5,0,0) (0.25, -1,0) (0,0,-3)\n"
                                            "space origin: (10,20,30)\n")));
  EXPECT_EQ(header.frame, WorldFrame::kRas);
  EXPECT_EQ(header.length_unit, "mm");
  EXPECT_EQ(header.sample_unit, "HU");
  EXPECT_EQ(world(header, 0, 0, 0), glm::dvec3(10, 20, 30));
  EXPECT_EQ(world(header, 2, 1, 1), glm::dvec3(11.25, 19, 27));
}

TEST(NrrdTest, SpacingsAndLimitsPlaceSamplesWithoutASpace) {
  const model::TestFolder folder;
  const GridHeader spaced = expect_ramp(write(folder / "a.nrrd", with_ramp("spacings: 2 -3 nan\naxis mins: 5 0 nan\n"
                                                                           "centers: cell node ???\n")));
  EXPECT_EQ(spaced.frame, WorldFrame::kUnstated);
  EXPECT_EQ(world(spaced, 0, 0, 0), glm::dvec3(6, 0, 0));
  EXPECT_EQ(world(spaced, 1, 1, 1), glm::dvec3(8, -3, 1));
  const GridHeader limited =
      expect_ramp(write(folder / "b.nrrd", with_ramp("axismins: 0 0 0\naxismaxs: 3 3 3\ncenters: cell node node\n")));
  EXPECT_EQ(world(limited, 0, 0, 0), glm::dvec3(0.5, 0, 0));
  EXPECT_EQ(world(limited, 1, 1, 1), glm::dvec3(1.5, 3, 3));
}

TEST(NrrdTest, APictureIsOneSliceAcrossItsAxes) {
  const model::TestFolder folder;
  const std::string text =
      "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 2 1\nencoding: raw\nspace dimension: 2\n"
      "space directions: (0,2) (3,0)\nspace origin: (1,1)\n\nAB";
  const Result<GridReader> reader = GridReader::open(write(folder / "grid.nrrd", text));
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(reader->header().size, (std::array<uint64_t, 3>{2, 1, 1}));
  EXPECT_EQ(world(reader->header(), 1, 0, 0), glm::dvec3(1, 3, 0));
  EXPECT_EQ(world(reader->header(), 0, 0, 1), glm::dvec3(1, 1, -1));
}

/// Two tensors along i of seven components each: 0 to 6 and 10 to 16.
std::string tensor_file(bool last, const std::string& kind = "3D-masked-symmetric-matrix") {
  std::vector<float> interleaved;
  std::vector<float> planar;
  for (int sample = 0; sample < 2; ++sample) {
    for (int c = 0; c < 7; ++c) interleaved.push_back(static_cast<float>(10 * sample + c));
  }
  for (int c = 0; c < 7; ++c) {
    for (int sample = 0; sample < 2; ++sample) planar.push_back(static_cast<float>(10 * sample + c));
  }
  const std::string space = "space space space";
  return "NRRD0005\ntype: float\ndimension: 4\nspace: LPS\nsizes: " + std::string(last ? "2 1 1 7" : "7 2 1 1") +
         "\nkinds: " + (last ? space + " " + kind : kind + " " + space) +
         "\nspace directions: " + (last ? "(1,0,0) (0,1,0) (0,0,1) none" : "none (1,0,0) (0,1,0) (0,0,1)") +
         "\nmeasurement frame: (0,1,0) (-1,0,0) (0,0,1)\nendian: little\nencoding: raw\n\n" +
         testing::packed_numbers(last ? planar : interleaved);
}

TEST(NrrdTest, TensorsAreReadWithTheirComponentsFirstOrLast) {
  const model::TestFolder folder;
  for (const bool last : {false, true}) {
    SCOPED_TRACE(last);
    Result<GridReader> reader = GridReader::open(write(folder / "grid.nrrd", tensor_file(last)));
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ(reader->header().kind, SampleKind::kMaskedSymmetricTensor);
    EXPECT_EQ(reader->header().frame, WorldFrame::kLps);
    ASSERT_TRUE(reader->header().measurement_frame);
    EXPECT_EQ((*reader->header().measurement_frame)[0], glm::dvec3(0, 1, 0));
    EXPECT_EQ((*reader->header().measurement_frame)[1], glm::dvec3(-1, 0, 0));
    EXPECT_THAT(testing::read_values(*reader).value(),
                ::testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 10, 11, 12, 13, 14, 15, 16));
  }
}

TEST(NrrdTest, PlanesOfComponentsLargerThanABufferAreBroughtTogether) {
  constexpr size_t kCount = 100000;  // floats of a plane: more than the reader's buffer
  const model::TestFolder folder;
  std::string text =
      "NRRD0004\ntype: float\ndimension: 4\nsizes: 100000 1 1 6\nendian: little\nencoding: gzip\n"
      "kinds: domain domain domain 3D-symmetric-matrix\n\n";
  std::vector<float> planes(6 * kCount);
  for (size_t i = 0; i < planes.size(); ++i) planes[i] = static_cast<float>(i);
  text += testing::gzip(testing::packed_numbers(planes));
  Result<GridReader> reader = GridReader::open(write(folder / "grid.nrrd", text));
  ASSERT_TRUE(reader) << reader.error().message;
  const std::vector<double> values = testing::read_values(*reader).value();
  for (size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(values[i], static_cast<double>(i % 6 * kCount + i / 6)) << i;
  }
}

TEST(NrrdTest, ComponentsThatAreNoTensorAreRefusedByName) {
  const model::TestFolder folder;
  const auto fault = [&](const std::string& sizes, const std::string& lines) {
    return fault_of(write(folder / "grid.nrrd", "NRRD0004\ntype: uchar\ndimension: 4\nsizes: " + sizes +
                                                    "\nencoding: raw\n" + lines + "\n" + std::string(240, 'x')));
  };
  EXPECT_THAT(fault("3 2 2 2", "kinds: RGB-color domain domain domain\n"), HasSubstr("3 components of kind rgb-color"));
  EXPECT_THAT(fault("3 2 2 2", "space directions: none (1,0,0) (0,1,0) (0,0,1)\n"), HasSubstr("no stated kind"));
  EXPECT_THAT(fault("2 2 2 3", "kinds: space space space time\n"), HasSubstr("of kind time"));
  EXPECT_THAT(fault("2 2 2 3", ""), HasSubstr("more than three axes"));
  EXPECT_THAT(fault("5 2 2 2", "kinds: 3D-symmetric-matrix space space space\n"), HasSubstr("5 components"));
  EXPECT_THAT(fault("2 6 2 2", "kinds: space 3D-symmetric-matrix space space\n"), HasSubstr("between"));
  EXPECT_EQ(fault("1 2 2 2", "kinds: vector domain domain domain\n"), "");  // one component is a scalar
  EXPECT_EQ(fault("2 2 2 1", ""), "");
}

TEST(NrrdTest, BadHeadersAreNamed) {
  const model::TestFolder folder;
  const auto fault = [&](const std::string& text) { return fault_of(write(folder / "grid.nrrd", text)); };
  const auto with = [](const std::string& sizes, const std::string& type = "short") {
    return "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: " + sizes + "\nendian: little\nencoding: raw\n\n" +
           ramp_bytes();
  };
  EXPECT_THAT(fault(with("3 2")), HasSubstr("not a size for each axis: 3 2"));
  EXPECT_THAT(fault(with("3 -2 2")), HasSubstr("3 -2 2"));
  EXPECT_THAT(fault(with("0 2 2")), HasSubstr("a size is 0"));
  EXPECT_THAT(fault(with("4294967296 4294967296 4294967296")), HasSubstr("overflow"));
  EXPECT_THAT(fault(with("9223372036854775808 2 1")), HasSubstr("overflow"));
  EXPECT_THAT(fault(with("3 2 3")), AllOf(HasSubstr("grid.nrrd"), HasSubstr("truncated"), HasSubstr("24 of 36")));
  EXPECT_THAT(fault(with("3 2 2", "block")), HasSubstr("unknown type of samples: block"));
  EXPECT_THAT(fault(with("3 2 2", "quaternion")), HasSubstr("unknown type"));
  EXPECT_THAT(fault(ramp_header("encoding: raw\n") + "\n" + ramp_bytes()), HasSubstr("no byte order"));
  EXPECT_THAT(fault(ramp_header("encoding: hex\n") + "\n" + ramp_bytes()), HasSubstr("encoding is not supported: hex"));
  EXPECT_THAT(fault(with_ramp("spacings: 1 0 1\n")), HasSubstr("do not span space"));
  EXPECT_THAT(fault(with_ramp("spacings: 1 inf 1\n")), HasSubstr("not finite"));
  EXPECT_THAT(fault(with_ramp("spacings: 1 2\n")), HasSubstr("not a number for each axis"));
  EXPECT_THAT(fault(with_ramp("space directions: (1,0,0) (2,0,0) (0,0,1)\n")), HasSubstr("do not span space"));
  EXPECT_THAT(fault(with_ramp("space directions: (1,0) (0,1) (0,0)\n")), HasSubstr("not a vector of the space"));
  EXPECT_THAT(fault(with_ramp("space directions: (1,0,0 (0,1,0) (0,0,1)\n")), HasSubstr("not a vector"));
  EXPECT_THAT(fault(with_ramp("space: right-anterior-superior-time\n")), HasSubstr("right-anterior-superior-time"));
  EXPECT_THAT(fault(with_ramp("a line without meaning\n")), HasSubstr("a line without meaning"));
  EXPECT_THAT(fault("NRRD0004\ntype: short\n"), HasSubstr("without an end"));
}

TEST(NrrdTest, DataFilesOutsideTheFolderAreRefused) {
  const model::TestFolder folder;
  const std::string header = ramp_header("endian: little\nencoding: raw\n");
  for (const std::string name : {"/etc/passwd", "../x.raw", "a/../../x.raw", "../%d.raw 1 2 1"}) {
    EXPECT_THAT(fault_of(write(folder / "grid.nhdr", header + "data file: " + name + "\n")),
                HasSubstr("not in its folder"))
        << name;
  }
  EXPECT_THAT(fault_of(write(folder / "grid.nhdr", header + "data file: missing.raw\n")), HasSubstr("missing.raw"));
  EXPECT_THAT(fault_of(write(folder / "grid.nhdr", header + "data file: x%d.raw 1 2000000000 1\n")),
              HasSubstr("cannot be divided"));
  EXPECT_THAT(fault_of(write(folder / "grid.nhdr", header + "data file: x%s.raw 1 2 1\n")), HasSubstr("x%s.raw"));
}

TEST(NrrdTest, AShortDataFileOfSeveralIsNamed) {
  const model::TestFolder folder;
  write(folder / "1.raw", ramp_bytes().substr(0, 12));
  write(folder / "2.raw", "short");
  const std::string header = ramp_header("endian: little\nencoding: raw\n");
  EXPECT_THAT(fault_of(write(folder / "grid.nhdr", header + "data file: %d.raw 1 2 1\n")),
              AllOf(HasSubstr("grid.nhdr"), HasSubstr("2.raw"), HasSubstr("truncated")));
}

TEST(NrrdTest, AGridLargerThanItsPackedBytesCanHoldFailsAtOnce) {
  const model::TestFolder folder;
  const std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 65536 65536 65536\nencoding: gzip\n\n" +
                           testing::gzip(std::string(1000000, '\0'));
  const Result<GridReader> reader = GridReader::open(write(folder / "grid.nrrd", text));
  ASSERT_FALSE(reader);
  EXPECT_THAT(reader.error().message, HasSubstr("of 281474976710656 bytes"));
}

}  // namespace
}  // namespace surfcast::grid
