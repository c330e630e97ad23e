#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include "gl/device_status.h"

namespace surfcast::gl {
namespace {

TEST(ResetStatusTest, TheThreeValuesOfTheSpecificationAreResetsAndNoOther) {
  for (const uint32_t reset : {GL_GUILTY_CONTEXT_RESET, GL_INNOCENT_CONTEXT_RESET, GL_UNKNOWN_CONTEXT_RESET}) {
    EXPECT_TRUE(is_reset(reset)) << reset;
  }
  for (const uint32_t other : {GL_NO_ERROR, GL_CONTEXT_LOST, GL_INVALID_ENUM, 0x92bb}) {
    EXPECT_FALSE(is_reset(other)) << other;
  }
}

}  // namespace
}  // namespace surfcast::gl
