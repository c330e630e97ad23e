#include "exporter/export_scan.h"

#include <cmath>
#include <csignal>
#include <fstream>
#include <glm/geometric.hpp>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "base/scratch_folder.h"
#include "laz/sample_records.h"
#include "scan/bytes.h"
#include "scan/las_file.h"
#include "scan/las_records.h"
#include "scan/whole_scan.h"
#include "support/file_content.h"
#include "support/path_of.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::LasFile;

class ExportScanTest : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& content) {
    std::ofstream(folder_->path() / name, std::ios::binary) << content;
    return folder_->path() / name;
  }
  [[nodiscard]] fs::path place(const std::string& name) const { return folder_->path() / name; }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_->path())) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

  Result<ScratchFolder> folder_ = ScratchFolder::create(fs::temp_directory_path(), "export-test-");
};

/// A record before the points.
std::string variable_record(const std::string& user, uint16_t id, const std::string& body) {
  testing::Bytes record(std::string(54, '\0'));
  for (size_t i = 0; i < user.size(); ++i) record.set(2 + i, user[i]);
  record.set(18, id).set(20, static_cast<uint16_t>(body.size())).add_text(body);
  return record.text();
}

/// A file with random records of a format, extra bytes that nothing describes, and a coordinate system.
LasFile sample_file(int format, size_t count = 700) {
  LasFile file;
  file.format = format;
  file.minor = format < 4 ? 2 : format < 6 ? 3 : 4;
  file.extra_bytes = 3;
  file.offset[0] = 500000;
  file.scale[2] = 0.25;
  file.variable_records = variable_record("LASF_Projection", 2112, "PROJCS[\"somewhere\"]") +
                          variable_record("somebody", 7, "something of theirs");
  file.variable_record_count = 2;
  const auto length = static_cast<size_t>(testing::las_record_bytes(format) + file.extra_bytes);
  const std::vector<std::byte> records = laz::testing::sample_records(length, count);
  for (size_t i = 0; i < count; ++i) {
    file.records.emplace_back(reinterpret_cast<const char*>(&records[i * length]), length);
  }
  return file;
}

/// The records of a file without wave packets.
std::string records_of(const LasFile& file) {
  const size_t packets[] = {0, 0, 0, 0, 28, 34, 0, 0, 0, 30, 38};
  std::string all;
  for (std::string record : file.records) {
    if (packets[file.format] != 0) record.erase(packets[file.format], 29);
    all += record;
  }
  return all;
}

std::string read_records(const fs::path& path) {
  const Result<scan::LasRecords> records = scan::LasRecords::open(path, {});
  EXPECT_TRUE(records) << records.error().message;
  std::string all;
  for (size_t piece = 0; records && piece < records->pieces(); ++piece) {
    const auto bytes = records->read(piece);
    EXPECT_TRUE(bytes) << bytes.error().message;
    if (bytes) all.append(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  }
  return all;
}

class ExportFormatTest : public ExportScanTest, public ::testing::WithParamInterface<int> {};
INSTANTIATE_TEST_SUITE_P(AllFormats, ExportFormatTest, ::testing::Range(0, 11));

TEST_P(ExportFormatTest, RecordsOfLasComeBackByteByByteFromLasAndLaz) {
  const LasFile file = sample_file(GetParam());
  const fs::path source = write("scan.las", file.text());
  for (const char* name : {"out.las", "out.laz"}) {
    ExportOptions options;
    options.encoding.chunk_size = 64;  // eleven chunks, the last of them with 60 points
    const auto report = export_scan(source, place(name), options);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->points, 700U);
    EXPECT_EQ(report->bytes, fs::file_size(place(name)));
    EXPECT_EQ(read_records(place(name)), records_of(file)) << name;
    const auto scan = scan::ScanStream::open(place(name));
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->schema().crs, "PROJCS[\"somewhere\"]");
    EXPECT_EQ(scan->schema().grid->scale, glm::dvec3(0.01, 0.01, 0.25));
    EXPECT_EQ(scan->schema().grid->offset.x, 500000);
    EXPECT_THAT(testing::file_content(place(name)), HasSubstr("something of theirs"));
  }
}

TEST_P(ExportFormatTest, TheHeaderStatesCountsReturnsAndBoundsOfWhatIsThere) {
  const LasFile file = sample_file(GetParam(), 100);
  const fs::path source = write("scan.las", file.text());
  ASSERT_TRUE(export_scan(source, place("out.laz"), {}));
  const std::string out = testing::file_content(place("out.laz"));
  const auto bytes = testing::as_bytes(out);
  const bool legacy = GetParam() < 6;
  uint64_t returns[15] = {};
  double low = INFINITY, high = -INFINITY;
  for (const std::string& record : file.records) {
    const int number = record[14] & (legacy ? 7 : 15);
    if (number > 0) ++returns[number - 1];
    const double x = scan::load<int32_t>(testing::as_bytes(record).data()) * 0.01 + 500000;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  EXPECT_EQ(scan::load<uint32_t>(&bytes[107]), legacy ? 100U : 0U);
  for (size_t i = 0; legacy && i < 5; ++i) EXPECT_EQ(scan::load<uint32_t>(&bytes[111 + 4 * i]), returns[i]);
  for (size_t i = 0; !legacy && i < 15; ++i) EXPECT_EQ(scan::load<uint64_t>(&bytes[255 + 8 * i]), returns[i]);
  EXPECT_EQ(scan::load<double>(&bytes[179]), high);
  EXPECT_EQ(scan::load<double>(&bytes[187]), low);
}

TEST_F(ExportScanTest, FilesOfOtherCodersAreCopiedToTheLastByte) {
  for (const char* name : {"indoor.laz", "lion.laz", "random-rgb-nir.laz"}) {
    const fs::path source = fs::path(path_of("tests/data")) / "laz" / name;
    ASSERT_TRUE(export_scan(source, place("plain.las"), {})) << name;
    ASSERT_TRUE(export_scan(place("plain.las"), place("again.laz"), {})) << name;
    EXPECT_EQ(read_records(place("plain.las")), read_records(source)) << name;
    EXPECT_EQ(read_records(place("again.laz")), read_records(source)) << name;
  }
}

TEST_F(ExportScanTest, AZoneAndClassesTakeThePointsThatAFilterOfOnesOwnTakes) {
  LasFile file;
  std::mt19937 random(3);
  std::string expected;
  for (int i = 0; i < 5000; ++i) {
    testing::Bytes record = file.record(static_cast<int32_t>(random() % 2000), static_cast<int32_t>(random() % 2000),
                                        static_cast<int32_t>(random() % 1000));
    record.set<uint8_t>(15, static_cast<uint8_t>(random() % 4));
    file.records.push_back(record.text());
    const auto* at = testing::as_bytes(file.records.back()).data();
    const double x = scan::load<int32_t>(at) * 0.01, y = scan::load<int32_t>(at + 4) * 0.01;
    const double z = scan::load<int32_t>(at + 8) * 0.01;
    // Within 2 of the line from (2, 5) to (18, 5), at heights from 1 to 6.
    const bool along = x >= 2 && x <= 18 && std::abs(y - 5) <= 2 && z >= 1 && z <= 6;
    if (along && (record.text()[15] == 1 || record.text()[15] == 3)) expected += record.text();
  }
  const fs::path source = write("scan.las", file.text());
  ExportOptions options;
  options.selection.zone.corridors = {{{{2, 5}, {18, 5}}, 2, 1, 6}};
  options.selection.classes = {1, 3};
  ASSERT_GT(expected.size(), 2000U);
  const auto report = export_scan(source, place("part.laz"), options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(read_records(place("part.laz")), expected);
}

TEST_F(ExportScanTest, ASelectionWithoutPointsIsSaidAndLeavesNoFile) {
  const fs::path las = write("scan.las", sample_file(1).text());
  const fs::path text = write("scan.csv", "x,y,z\n1,2,3\n4,5,6\n");
  ExportOptions options;
  options.selection.zone.boxes.push_back({glm::dvec3(-2e9), glm::dvec3(-1e9)});
  for (const fs::path& source : {las, text}) {
    const auto report = export_scan(source, place("out.las"), options);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().message, source.string() + ": has no points in the selection");
    EXPECT_FALSE(export_scan(source, place("out.copc.laz"), options));
  }
  EXPECT_THAT(files(), ::testing::ElementsAre("scan.csv", "scan.las"));
}

constexpr const char* kTable =
    "x,y,z,nx,ny,nz,red,green,blue,intensity,classification,quality\n"
    "1000.125,2000.5,-3.25,0,0,1,255,0,7,500,2,-1.5\n"
    "1001.25,2001.75,-4.5,1,0,0,1,2,3,65535,200,2.25\n";

TEST_F(ExportScanTest, AnyScanBecomesAnyFormatWithItsAttributes) {
  const fs::path source = write("scan.csv", kTable);
  for (const char* name : {"out.las", "out.laz", "out.ply", "out.csv"}) {
    const auto report = export_scan(source, place(name), {});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->points, 2U);
    const auto out = testing::whole(scan::ScanStream::open(place(name)));
    ASSERT_TRUE(out) << out.error().message;
    ASSERT_EQ(out->positions.size(), 2U) << name;
    EXPECT_LE(glm::length(out->positions[0] - glm::dvec3(1000.125, 2000.5, -3.25)), 1e-12) << name;
    EXPECT_LE(glm::length(out->positions[1] - glm::dvec3(1001.25, 2001.75, -4.5)), 1e-12) << name;
    EXPECT_THAT(out->normals, ::testing::ElementsAre(glm::vec3(0, 0, 1), glm::vec3(1, 0, 0))) << name;
    EXPECT_THAT(testing::scalar_values<uint16_t>(*out, "intensity"), ::testing::ElementsAre(500, 65535)) << name;
    EXPECT_THAT(testing::scalar_values<uint8_t>(*out, "classification"), ::testing::ElementsAre(2, 200)) << name;
    EXPECT_THAT(testing::scalar_values<double>(*out, "quality"), ::testing::ElementsAre(-1.5, 2.25)) << name;
    ASSERT_TRUE(out->colors) << name;
    const int factor = out->colors->bits == 8 ? 1 : 257;
    EXPECT_EQ(out->colors->values[0], glm::u16vec3(255 * factor, 0, 7 * factor)) << name;
  }
}

TEST_F(ExportScanTest, PointsOfVtkAreAScanToo) {
  const fs::path source =
      write("scan.vtk",
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n1 2 3 4 5 6\nPOINT_DATA 2\n"
            "SCALARS intensity unsigned_short\nLOOKUP_TABLE default\n7 8\n");
  const auto report = export_scan(source, place("out.las"), {});
  ASSERT_TRUE(report) << report.error().message;
  const auto out = testing::whole(scan::ScanStream::open(place("out.las")));
  ASSERT_TRUE(out) << out.error().message;
  EXPECT_THAT(out->positions, ::testing::ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(4, 5, 6)));
  EXPECT_THAT(testing::scalar_values<uint16_t>(*out, "intensity"), ::testing::ElementsAre(7, 8));
}

TEST_F(ExportScanTest, LasBecomesATableOfExactNumbers) {
  const LasFile file = sample_file(2, 200);
  const fs::path source = write("scan.las", file.text());
  const auto expected = testing::whole(scan::ScanStream::open(source));
  ASSERT_TRUE(expected);
  for (const char* name : {"out.ply", "out.csv"}) {
    ASSERT_TRUE(export_scan(source, place(name), {}));
    const auto out = testing::whole(scan::ScanStream::open(place(name)));
    ASSERT_TRUE(out) << out.error().message;
    EXPECT_EQ(out->positions, expected->positions) << name;
    EXPECT_EQ(out->scalars.size(), expected->scalars.size()) << name;
  }
}

TEST_F(ExportScanTest, OtherNamesAreRefusedWithTheFormatsThatAreWritten) {
  const fs::path source = write("scan.csv", kTable);
  const auto report = export_scan(source, place("out.e57"), {});
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message,
              HasSubstr("out.e57: its extension names none of the formats that are written: .las, .laz, .ply, .csv"));
}

TEST_F(ExportScanTest, AFolderThatIsNotThereIsOneLine) {
  const fs::path source = write("scan.csv", kTable);
  for (const char* name : {"none/out.las", "none/out.copc.laz", "none/out.ply", "none/out.csv"}) {
    const auto report = export_scan(source, place(name), {});
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().kind, ErrorKind::kIo);
    EXPECT_THAT(report.error().message, HasSubstr(place(name).string() + ": cannot create"));
  }
}

/// Files may not grow beyond a size, as on a disk that is full.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

TEST_F(ExportScanTest, ADiskThatIsFullIsOneLineAndLeavesTheFileThatWasThere) {
  const fs::path source = write("scan.las", sample_file(3, 20000).text());
  for (const char* name : {"out.las", "out.laz", "out.copc.laz", "out.ply", "out.csv"}) {
    write(name, "what was there");
    const FileSizeLimit limit(1000);
    const auto report = export_scan(source, place(name), {});
    ASSERT_FALSE(report) << name;
    EXPECT_EQ(report.error().kind, ErrorKind::kIo);
    EXPECT_THAT(report.error().message, HasSubstr(place(name).string() + ": cannot write"));
    EXPECT_EQ(testing::file_content(place(name)), "what was there");
  }
  EXPECT_EQ(files().size(), 6U);
}

}  // namespace
}  // namespace surfcast::exporter
