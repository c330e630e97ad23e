#pragma once

#include <string_view>

#include "picture/picture.h"

namespace surfcast::render {

/// The time of drawing a frame whose blocks are there, milliseconds.
inline double drawing_ms(const picture::Frame& frame) {
  const auto loads = [](std::string_view name) { return name == "load" || name == "decode" || name == "upload"; };
  double sum = 0;
  for (const picture::StageTime& stage : frame.stats.stages) {
    if (!loads(stage.name)) sum += stage.milliseconds;
  }
  return sum;
}

}  // namespace surfcast::render
