#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// Parses the query of a picture URL ("resolution=640,480&position=1,2,3") into a request for `model`. An unknown,
/// repeated or malformed parameter is an error.
Result<wire::DrawPicture> parse_picture_query(std::string_view model, std::string_view query);

/// The same for a pick request. The parameter `pixel` ("X,Y") is required.
Result<wire::PickSurfel> parse_pick_query(std::string_view model, std::string_view query);

}  // namespace surfcast::protocol
