#pragma once

#include <string>

#include "fuzz/targets.h"

namespace surfcast::fuzz {

/// The path of a file with these bytes. It is overwritten by the next input of that name.
std::string input_file(Bytes bytes, const char* name);

}  // namespace surfcast::fuzz
