#include "base/host_memory.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace surfcast {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;

constexpr uint64_t kMebibyte = uint64_t{1} << 20;

/// A machine with 8 GiB, 6 of them available, as its files state it.
class HostMemoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root_);
    write("proc/meminfo", "MemTotal:        8388608 kB\nMemFree:          100000 kB\nMemAvailable:    6291456 kB\n");
  }
  void TearDown() override { fs::remove_all(root_); }
  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }
  [[nodiscard]] HostMemory read() const { return read_host_memory(root_); }

  fs::path root_ = fs::path(::testing::TempDir()) /
                   ("memory_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
                    std::to_string(::getpid()));
};

TEST_F(HostMemoryTest, WithoutALimitItIsTheMachines) {
  EXPECT_EQ(read().total, 8192 * kMebibyte);
  EXPECT_EQ(read().available, 6144 * kMebibyte);
}

TEST_F(HostMemoryTest, AGroupOfVersion2LimitsIt) {
  write("proc/self/cgroup", "0::/system.slice/surfcast.service\n");
  write("sys/fs/cgroup/system.slice/surfcast.service/memory.max", "1073741824\n");
  EXPECT_EQ(read().total, 1024 * kMebibyte);
  EXPECT_EQ(read().available, 1024 * kMebibyte);
}

TEST_F(HostMemoryTest, AGroupAboveLimitsItToo) {
  write("proc/self/cgroup", "0::/pod/container\n");
  write("sys/fs/cgroup/pod/container/memory.max", "max\n");
  write("sys/fs/cgroup/pod/memory.max", "2147483648\n");
  EXPECT_EQ(read().available, 2048 * kMebibyte);
}

TEST_F(HostMemoryTest, InAContainerTheTopmostGroupIsItsOwn) {
  write("proc/self/cgroup", "0::/\n");
  write("sys/fs/cgroup/memory.max", "536870912\n");
  EXPECT_EQ(read().available, 512 * kMebibyte);
}

TEST_F(HostMemoryTest, AGroupOfVersion1LimitsItAlsoWhereItsPathIsTheHosts) {
  write("proc/self/cgroup", "5:cpu,cpuacct:/docker/abc\n4:memory:/docker/abc\n0::/\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "3221225472\n");
  EXPECT_EQ(read().available, 3072 * kMebibyte);
  write("sys/fs/cgroup/memory/docker/abc/memory.limit_in_bytes", "268435456\n");
  EXPECT_EQ(read().available, 256 * kMebibyte);
}

TEST_F(HostMemoryTest, NoLimitOfVersion1IsAHugeNumber) {
  write("proc/self/cgroup", "4:memory:/\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(read().available, 6144 * kMebibyte);
}

TEST_F(HostMemoryTest, ALimitBelowWhatIsAvailableIsNotAddedToIt) {
  write("proc/self/cgroup", "0::/a\n");
  write("sys/fs/cgroup/a/memory.max", "7516192768\n");
  EXPECT_EQ(read().total, 7168 * kMebibyte);
  EXPECT_EQ(read().available, 6144 * kMebibyte);
}

TEST(MemoryLimitFilesTest, AreThoseOfTheGroupAndOfAllAbove) {
  EXPECT_THAT(memory_limit_files("0::/a/b\n"),
              ElementsAre("sys/fs/cgroup/a/b/memory.max", "sys/fs/cgroup/a/memory.max", "sys/fs/cgroup/memory.max"));
  EXPECT_THAT(memory_limit_files("7:hugetlb,memory:/x\n"), Contains("sys/fs/cgroup/memory/x/memory.limit_in_bytes"));
  EXPECT_TRUE(memory_limit_files("2:cpu:/x\nnonsense\n").empty());
}

TEST(HostMemoryOfThisMachineTest, IsStated) {
  const HostMemory memory = read_host_memory();
  EXPECT_GT(memory.total, 0U);
  EXPECT_GT(memory.available, 0U);
  EXPECT_LE(memory.available, memory.total);
}

}  // namespace
}  // namespace surfcast
