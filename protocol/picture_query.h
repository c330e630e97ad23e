#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// The escapes of a part of a URL ("%2C") as the characters they stand for; a malformed escape or a NUL is an error.
Result<std::string> decode_escapes(std::string_view text);

/// The query of a picture's URL ("resolution=640,480&position=1,2,3") as a request for `model`. A parameter that is
/// unknown, given twice or malformed is an error.
Result<wire::DrawPicture> parse_picture_query(std::string_view model, std::string_view query);

/// The same with the parameter `pixel` ("X,Y"), which must be there.
Result<wire::PickSurfel> parse_pick_query(std::string_view model, std::string_view query);

}  // namespace surfcast::protocol
