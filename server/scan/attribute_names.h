#pragma once

#include <string>
#include <string_view>

namespace surfcast::scan {

/// The name an attribute goes by in Surfcast: one of the well-known names when `name` is a spelling of it
/// ("ReturnNumber", "scalar_intensity", "normal_x", "diffuse_red"), else `name` itself.
std::string canonical_attribute_name(std::string_view name);

}  // namespace surfcast::scan
