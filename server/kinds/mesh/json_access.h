#pragma once

#include "scan/json_access.h"

namespace surfcast::mesh {

using scan::element;
using scan::flag_of;
using scan::integer_of;
using scan::Json;
using scan::member;
using scan::number_of;
using scan::numbers_of;
using scan::text_of;

}  // namespace surfcast::mesh
