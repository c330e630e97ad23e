#pragma once

#include <string>
#include <string_view>

namespace surfcast {

/// The absolute path of a program of this build, or of a file or folder of the checkout: one of those that
/// surfcast_test_paths (CMake) names for the test program. Any other name stops the program.
std::string path_of(std::string_view name);

}  // namespace surfcast
