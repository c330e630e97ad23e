#include "model/write_model.h"

#include <cmath>
#include <csignal>
#include <limits>

#include <sys/resource.h>

#include "model/round_trip.h"

namespace surfcast::model {
namespace {

TEST(WriteModel, RefusesAnEmptyCloud) {
  const TestFolder folder;
  const Result<WriteReport> report = write_model({}, folder / "model.surf", {});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().kind, ErrorKind::kInvalidInput);
  EXPECT_TRUE(folder.empty());
}

TEST(WriteModel, RefusesValuesThatNoModelHolds) {
  const TestFolder folder;
  const auto refused = [&](auto spoil) {
    surfel::SurfelCloud cloud = sphere_cloud(10);
    spoil(cloud);
    const Result<WriteReport> report = write_model(cloud, folder / "model.surf", {});
    return !report && report.error().kind == ErrorKind::kInvalidInput && folder.empty();
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(refused([&](surfel::SurfelCloud& cloud) { cloud.positions[3].y = nan; }));
  EXPECT_TRUE(refused([&](surfel::SurfelCloud& cloud) { cloud.positions[3].z = 1e300; }));
  EXPECT_TRUE(refused([&](surfel::SurfelCloud& cloud) { cloud.normals[3] = glm::vec3(0); }));
  EXPECT_TRUE(refused([&](surfel::SurfelCloud& cloud) { cloud.normals[3].x = nan; }));
  EXPECT_TRUE(refused([&](surfel::SurfelCloud& cloud) { cloud.radii[3] = 0; }));
  EXPECT_TRUE(refused([&](surfel::SurfelCloud& cloud) { cloud.radii[3] = infinity; }));
  EXPECT_TRUE(refused([&](surfel::SurfelCloud& cloud) { cloud.weights[3] = -1; }));
}

TEST(WriteModel, NamesTheFolderThatIsMissing) {
  const TestFolder folder;
  const Result<WriteReport> report = write_model(sphere_cloud(10), folder / "absent/model.surf", {});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().kind, ErrorKind::kIo);
  EXPECT_NE(report.error().message.find("absent/model.surf"), std::string::npos);
}

/// Limits the size of files that this process writes during the lifetime of the object, like a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_limit_{};
  void (*old_handler_)(int);
};

TEST(WriteModel, LeavesNothingBehindOnAFullDisk) {
  const TestFolder folder;
  const surfel::SurfelCloud cloud = sphere_cloud(40000);
  for (const rlim_t limit : {rlim_t{10}, rlim_t{1000}, rlim_t{50000}}) {
    const FileSizeLimit full_disk(limit);
    const Result<WriteReport> report = write_model(cloud, folder / "model.surf", {});
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().kind, ErrorKind::kIo);
    EXPECT_TRUE(folder.empty());
  }
}

TEST(WriteModel, ReportsWhatItWroteAndHowFarItIs) {
  const TestFolder folder;
  std::vector<double> parts;
  const Result<WriteReport> report = write_model(sphere_cloud(40000), folder / "model.surf",
                                                 {.progress = [&](double part) { parts.push_back(part); }});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->surfels, 40000u);
  EXPECT_EQ(report->bytes, std::filesystem::file_size(folder / "model.surf"));
  ASSERT_EQ(parts.size(), report->blocks);
  EXPECT_TRUE(std::is_sorted(parts.begin(), parts.end()));
  EXPECT_EQ(parts.back(), 1);
}

TEST(WriteModel, TakesFewBytesForGreyColorsAndConstantAttributes) {
  const TestFolder folder;
  surfel::SurfelCloud cloud = sphere_cloud(20000);
  cloud.colors.reset();
  write_and_open(cloud, folder / "plain.surf");
  cloud.colors.emplace();
  cloud.colors->values.assign(cloud.size(), glm::u16vec3(128, 128, 128));
  cloud.scalars.push_back({"gps_time", std::vector<double>(cloud.size(), 123456.789)});
  write_and_open(cloud, folder / "constant.surf");
  EXPECT_LT(std::filesystem::file_size(folder / "constant.surf"),
            std::filesystem::file_size(folder / "plain.surf") + 500);
}

}  // namespace
}  // namespace surfcast::model
