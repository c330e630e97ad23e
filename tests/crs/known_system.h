#pragma once

#include <gtest/gtest.h>

#include "crs/coordinate_system.h"

namespace surfcast::crs {

/// A system that PROJ knows.
inline CoordinateSystem known_system(const char* text) {
  const Result<CoordinateSystem> system = read_system(text);
  EXPECT_TRUE(system) << text;
  return system.value_or(CoordinateSystem());
}

}  // namespace surfcast::crs
