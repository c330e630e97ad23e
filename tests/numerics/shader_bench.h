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
/// A body is GLSL that sees `in_[k]`, the case's vec4 numbers k, and sets `out_[k]`; all of the filter's functions and
/// the frame's constants are there for it.
class ShaderBench {
 public:
  ShaderBench();

  /// `inputs` holds `ins` vectors for each case; the answer `outs` for each.
  std::vector<glm::vec4> run(const std::string& body, const layout::FrameConstants& frame, int ins, int outs,
                             std::span<const glm::vec4> inputs);

 private:
  std::unique_ptr<gl::EglContext> context_;
};

/// Constants of a frame of that eta and size; all else is zero.
layout::FrameConstants frame_of(float eta, float width, float height);

}  // namespace surfcast::testing
