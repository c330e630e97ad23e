#include "net/service_manager.h"

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace surfcast::net {
namespace {

TEST(ServiceManagerTest, IsToldTheStateOfTheService) {
  const std::string path =
      (std::filesystem::path(::testing::TempDir()) / ("manager_" + std::to_string(::getpid()) + ".socket")).string();
  ::unlink(path.c_str());
  const int manager = ::socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(manager, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
  notify_manager("READY=1");
  ::unsetenv("NOTIFY_SOCKET");
  std::array<char, 64> told{};
  const ssize_t count = ::recv(manager, told.data(), told.size(), MSG_DONTWAIT);
  EXPECT_EQ(std::string(told.data(), count > 0 ? static_cast<size_t>(count) : 0), "READY=1");
  notify_manager("READY=1");  // nobody listens
  EXPECT_LT(::recv(manager, told.data(), told.size(), MSG_DONTWAIT), 0);
  ::close(manager);
  ::unlink(path.c_str());
}

TEST(ServiceManagerTest, WantsSignsOfLifeTwiceInItsTime) {
  EXPECT_FALSE(watchdog_interval());
  ::setenv("WATCHDOG_USEC", "3000000", 1);
  EXPECT_EQ(watchdog_interval(), std::chrono::microseconds(1'500'000));
  ::setenv("WATCHDOG_PID", "1", 1);
  EXPECT_FALSE(watchdog_interval()) << "of another process";
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  EXPECT_TRUE(watchdog_interval());
  ::unsetenv("WATCHDOG_USEC");
  ::unsetenv("WATCHDOG_PID");
}

TEST(ServiceManagerTest, PassesNoSocketToAProcessThatItDoesNotName) {
  EXPECT_EQ(inherited_listener(), -1);
  ::setenv("LISTEN_FDS", "1", 1);
  ::setenv("LISTEN_PID", "1", 1);
  EXPECT_EQ(inherited_listener(), -1);
  ::unsetenv("LISTEN_FDS");
  ::unsetenv("LISTEN_PID");
}

}  // namespace
}  // namespace surfcast::net
