#pragma once

#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gl/egl_context.h"
#include "gl/objects.h"
#include "shared/frame_layout.h"

namespace surfcast::testing {

/// Runs shader functions on the device, one invocation for each case.
///
/// A body is GLSL code that reads `in_[k]`, the vec4 inputs of the case, and sets `out_[k]`. It can use all functions
/// of the filter and the constants of the frame.
class ShaderBench {
 public:
  ShaderBench();

  /// `inputs` has `ins` vectors per case; the result has `outs` vectors per case. `files`: further shader files whose
  /// functions the body uses.
  std::vector<glm::vec4> run(const std::string& body, const layout::FrameConstants& frame, int ins, int outs,
                             std::span<const glm::vec4> inputs, std::span<const char* const> files = {});

 private:
  std::unique_ptr<gl::EglContext> context_;
};

/// Frame constants with this eta and size; all other values are zero.
layout::FrameConstants frame_of(float eta, float width, float height);

}  // namespace surfcast::testing
