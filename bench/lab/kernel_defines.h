#pragma once

#include <string>

namespace surfcast::lab {

/// Text before the shaders (RendererConfig::shader_defines) that gives the kernel another standard deviation, in radii,
/// and leaves its other constants (shaders/shared/kernel.h) as they are.
std::string kernel_defines(double sigma);

}  // namespace surfcast::lab
