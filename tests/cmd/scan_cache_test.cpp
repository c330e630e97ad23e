#include "cmd/scan_cache.h"

#include <array>
#include <fstream>
#include <set>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cmd/cache_eviction.h"
#include "model/model_file.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(FilesToEvictTest, AreThoseUsedLeastRecentlyAndNoMoreThanNeeded) {
  const std::vector<CachedFile> files{{"second", 10, 2}, {"fourth", 10, 4}, {"first", 10, 1}, {"third", 10, 3}};
  EXPECT_THAT(files_to_evict(files, 40), IsEmpty());
  EXPECT_THAT(files_to_evict(files, 39), ElementsAre("first"));
  EXPECT_THAT(files_to_evict(files, 20), ElementsAre("first", "second"));
  EXPECT_THAT(files_to_evict(files, 0), ElementsAre("first", "second", "third", "fourth"));
}

TEST(FilesToEvictTest, AreNoneThatIsInUseThoughItCounts) {
  const std::vector<CachedFile> files{{"first", 10, 1, true}, {"second", 10, 2}, {"third", 10, 3}};
  EXPECT_THAT(files_to_evict(files, 20), ElementsAre("second"));
  EXPECT_THAT(files_to_evict(files, 5), ElementsAre("second", "third"));
}

TEST(DefaultCacheBytesTest, LeavesHalfOfASmallDisk) {
  constexpr uint64_t kGibibyte = uint64_t{1} << 30;
  EXPECT_EQ(default_cache_bytes(1000 * kGibibyte, 0), 20 * kGibibyte);
  EXPECT_EQ(default_cache_bytes(8 * kGibibyte, 0), 4 * kGibibyte);
  EXPECT_EQ(default_cache_bytes(4 * kGibibyte, 4 * kGibibyte), 4 * kGibibyte) << "does not shrink as the cache fills";
}

/// A cache, and scans of different content.
class ScanCacheTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("scan_cache_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    for (const std::string name : {"a", "b", "c"}) {
      std::ofstream scan(folder_ / (name + ".xyz"));
      for (int i = 0; i < 100; ++i) scan << i % 10 << ' ' << i / 10 << ' ' << int{name[0]} << '\n';
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] CachedModel model(const std::string& scan, std::optional<uint64_t> bytes = {}) const {
    Result<CachedModel> found = model_of_scan(folder_ / (scan + ".xyz"), {.folder = cache_, .bytes = bytes});
    EXPECT_TRUE(found);
    return found ? std::move(*found) : CachedModel{};
  }
  /// As if the file had been used at that time.
  static void set_used(const fs::path& path, time_t second) {
    const std::array<timespec, 2> times{timespec{second, 0}, timespec{0, UTIME_OMIT}};
    ASSERT_EQ(::utimensat(AT_FDCWD, path.c_str(), times.data(), 0), 0);
  }
  static time_t used(const fs::path& path) {
    struct stat status {};
    EXPECT_EQ(::stat(path.c_str(), &status), 0);
    return status.st_atim.tv_sec;
  }
  static uint64_t bytes_of(const std::vector<fs::path>& paths) {
    uint64_t bytes = 0;
    for (const fs::path& path : paths) bytes += fs::file_size(path);
    return bytes;
  }

  fs::path folder_;
  fs::path cache_ = fs::path(::testing::TempDir()) /
                    ("scan_cache_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) +
                     "_" + std::to_string(::getpid())) /
                    "cache";
};

TEST_F(ScanCacheTest, TheModelUsedLeastRecentlyGoesFirst) {
  const fs::path a = model("a").path;
  const fs::path b = model("b").path;
  const fs::path c = model("c").path;
  set_used(b, 100);
  set_used(a, 200);
  set_used(c, 300);
  limit_cache(cache_, bytes_of({a, c}));
  EXPECT_TRUE(fs::exists(a) && fs::exists(c));
  EXPECT_FALSE(fs::exists(b));
  limit_cache(cache_, bytes_of({a, c}) - 1);
  EXPECT_FALSE(fs::exists(a));
  EXPECT_TRUE(fs::exists(c));
}

TEST_F(ScanCacheTest, EveryPolicyOfRadiiHasAModelOfItsOwn) {
  std::set<fs::path> paths;
  for (const auto radii :
       {estimation::RadiusPolicy::kAuto, estimation::RadiusPolicy::kKeep, estimation::RadiusPolicy::kEstimate}) {
    for (int times = 0; times < 2; ++times) {
      const Result<CachedModel> model = model_of_scan(folder_ / "a.xyz", {.folder = cache_, .radii = radii});
      ASSERT_TRUE(model);
      paths.insert(model->path);
    }
  }
  EXPECT_EQ(paths.size(), 3U);
  limit_cache(cache_, 0);
  for (const fs::path& path : paths) EXPECT_FALSE(fs::exists(path)) << "each counts as a model of the cache";
}

TEST_F(ScanCacheTest, EverySpacingOfAMeshHasAModelOfItsOwn) {
  std::ofstream(folder_ / "square.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const auto surfels = [&](double spacing) {
    const Result<CachedModel> model = model_of_scan(folder_ / "square.obj", {.folder = cache_, .meshes = {spacing}});
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return model ? model::ModelFile::open(model->path)->info().surfels : 0;
  };
  EXPECT_NEAR(static_cast<double>(surfels(0.1)), 100, 30);
  EXPECT_NEAR(static_cast<double>(surfels(0.05)), 400, 60);
}

TEST_F(ScanCacheTest, UseIsNotedAndKeepsTheTimeOfWriting) {
  const fs::path a = model("a").path;
  const fs::path b = model("b").path;
  set_used(a, 100);
  set_used(b, 200);
  const auto written = fs::last_write_time(a);
  (void)model("a");
  EXPECT_GT(used(a), 1'000'000'000);
  EXPECT_EQ(fs::last_write_time(a), written) << "a server would take it for another model";
  limit_cache(cache_, bytes_of({a}));
  EXPECT_TRUE(fs::exists(a));
  EXPECT_FALSE(fs::exists(b));
}

TEST_F(ScanCacheTest, TheEndOfUseIsNotedToo) {
  CachedModel a = model("a");
  set_used(a.path, 100);
  a.in_use.reset();
  EXPECT_GT(used(a.path), 1'000'000'000);
}

TEST_F(ScanCacheTest, LookingForWhatToEvictIsNoUse) {
  const fs::path a = model("a").path;
  const fs::path b = model("b").path;
  set_used(a, 100);
  set_used(b, 200);
  limit_cache(cache_, bytes_of({b}));
  EXPECT_FALSE(fs::exists(a));
  EXPECT_EQ(used(b), 200);
}

TEST_F(ScanCacheTest, AModelInUseStaysBeyondTheLimitAndGoesLater) {
  CachedModel a = model("a", 1);
  const CachedModel b = model("b", 1);
  set_used(a.path, 100);
  limit_cache(cache_, 1);
  EXPECT_TRUE(fs::exists(a.path) && fs::exists(b.path));
  a.in_use.reset();
  limit_cache(cache_, 1);
  EXPECT_FALSE(fs::exists(a.path));
  EXPECT_TRUE(fs::exists(b.path));
}

TEST_F(ScanCacheTest, ANewModelTakesThePlaceOfAnOldOne) {
  const fs::path a = model("a").path;
  const CachedModel b = model("b", fs::file_size(a) + 10);
  EXPECT_FALSE(fs::exists(a));
  EXPECT_TRUE(fs::exists(b.path));
}

TEST_F(ScanCacheTest, AnEvictedModelIsBuiltAgain) {
  const fs::path a = model("a").path;
  limit_cache(cache_, 1);
  ASSERT_FALSE(fs::exists(a));
  EXPECT_EQ(model("a").path, a);
  EXPECT_TRUE(fs::exists(a));
}

TEST_F(ScanCacheTest, ForeignAndDamagedFilesAreLeftAloneAndDoNotCount) {
  const fs::path a = model("a").path;
  const std::string damaged = "0.1.0-0123456789abcdef0123456789abcdef.surf";
  const std::string link = "0.1.0-00000000000000000000000000000000.surf";
  std::set<std::string> others{"notes.txt", "church.surf", "0.1.0-abc.surf", damaged, a.filename().string() + ".tmp"};
  for (const std::string& name : others) std::ofstream(cache_ / name) << std::string(100'000, 'x');
  fs::create_symlink(a, cache_ / link);
  others.insert(link);
  set_used(cache_ / damaged, 1);
  limit_cache(cache_, fs::file_size(a));
  EXPECT_TRUE(fs::exists(a));
  limit_cache(cache_, 1);
  EXPECT_FALSE(fs::exists(a));
  for (const std::string& name : others)
    EXPECT_TRUE(fs::is_symlink(cache_ / name) || fs::exists(cache_ / name)) << name;
}

TEST_F(ScanCacheTest, ADamagedModelOfTheScanIsReplaced) {
  const fs::path a = model("a").path;
  const auto bytes = fs::file_size(a);
  fs::resize_file(a, 10);
  EXPECT_EQ(model("a").path, a);
  EXPECT_EQ(fs::file_size(a), bytes);
}

TEST_F(ScanCacheTest, AFolderThatCannotBeWrittenStillServesWhatItHas) {
  const fs::path a = model("a").path;
  fs::permissions(cache_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(model("a").path, a);
  fs::permissions(cache_, fs::perms::owner_all);
}

/// A volume whose samples are in a file of their own.
class DetachedGridTest : public ScanCacheTest {
 protected:
  void write_samples(char sample) const {
    std::ofstream(folder_ / "all.raw") << std::string(1000, sample) << "abcdefgh";
  }
  [[nodiscard]] Result<CachedModel> model() const { return model_of_scan(folder_ / "grid.mhd", {.folder = cache_}); }
  void SetUp() override {
    ScanCacheTest::SetUp();
    std::ofstream(folder_ / "grid.mhd") << "ObjectType = Image\nNDims = 3\nDimSize = 12 12 7\n"
                                           "ElementType = MET_UCHAR\nElementDataFile = all.raw\n";
    write_samples('a');
  }
};

TEST_F(DetachedGridTest, AChangeOfItsSamplesGivesAnotherModel) {
  const Result<CachedModel> first = model();
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(model()->path, first->path);
  write_samples('b');
  const Result<CachedModel> second = model();
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_NE(second->path, first->path);
  write_samples('a');
  EXPECT_EQ(model()->path, first->path) << "whatever the time of the file";
}

TEST_F(DetachedGridTest, WithoutItsSamplesIsAFailureThatNamesThem) {
  fs::remove(folder_ / "all.raw");
  EXPECT_NE(model().error().message.find("all.raw"), std::string::npos);
}

}  // namespace
}  // namespace surfcast::cmd
