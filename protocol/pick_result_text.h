#pragma once

#include <string>

#include "surfcast.pb.h"

namespace surfcast::protocol {

/// Lines of `name: value` for a person; numbers are written so that they read back to the last bit.
std::string pick_result_text(const wire::PickResult& result);
/// {"hit": true, "position": [x, y, z], ...}
std::string pick_result_json(const wire::PickResult& result);

}  // namespace surfcast::protocol
