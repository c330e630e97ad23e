#include "worker/worker_environment.h"

#include <gmock/gmock.h>

namespace surfcast::worker {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(WorkerEnvironment, HasWhatDriversAndLibrariesRead) {
  for (const char* name : {"PATH", "HOME", "LC_ALL", "LD_LIBRARY_PATH", "XDG_CACHE_HOME", "MESA_SHADER_CACHE_DIR",
                           "__EGL_VENDOR_LIBRARY_FILENAMES", "VK_ICD_FILENAMES", "NVIDIA_VISIBLE_DEVICES", "PROJ_DATA",
                           "SURFCAST_WORKER_TIMEOUT"}) {
    EXPECT_TRUE(is_for_worker(name)) << name;
  }
}

TEST(WorkerEnvironment, HasNothingThatMayBeASecret) {
  for (const char* name : {"AWS_SECRET_ACCESS_KEY", "AWS_SESSION_TOKEN", "SURFCAST_TOKEN",
                           "GOOGLE_APPLICATION_CREDENTIALS", "DATABASE_URL", "PATHS", "NOTIFY_SOCKET", ""}) {
    EXPECT_FALSE(is_for_worker(name)) << name;
  }
}

TEST(WorkerEnvironment, AddsVariablesThatAreNotInherited) {
  EXPECT_THAT(worker_environment({"PATH=/bin", "SURFCAST_TOKEN=a=b", "MESA_DEBUG="}, {"MESA_DEBUG=1", "MESA_LOG=2"}),
              ElementsAre("PATH=/bin", "MESA_DEBUG=", "MESA_LOG=2"));
  EXPECT_THAT(worker_environment({}, {}), IsEmpty());
}

}  // namespace
}  // namespace surfcast::worker
