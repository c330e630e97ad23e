#pragma once

#include <string>
#include <string_view>

namespace surfcast::scan {

/// A name without case, underscores and spaces, and without a leading "scalar".
std::string attribute_key(std::string_view name);

/// The canonical name of an attribute: a well-known name if `name` is a spelling of it ("ReturnNumber",
/// "scalar_intensity", "normal_x", "diffuse_red"), otherwise `name` itself.
std::string canonical_attribute_name(std::string_view name);

}  // namespace surfcast::scan
