#pragma once

#include <string>

#include "surfcast.pb.h"

namespace surfcast::protocol {

/// Lines of `name: value`. Numbers have enough digits to be read back exactly.
std::string pick_result_text(const wire::PickResult& result);
/// {"hit": true, "position": [x, y, z], ...}
std::string pick_result_json(const wire::PickResult& result);

}  // namespace surfcast::protocol
