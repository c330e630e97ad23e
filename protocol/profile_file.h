#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "protocol/profile_query.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// The points of a profile as text: a line of names, then a line for each point with x, y, z, along, across, red,
/// green, blue (if there are colours) and all attributes. Numbers have as many digits as are needed to be read back
/// exactly; a value that is not a number is empty. Lines end with CR LF (RFC 4180).
std::string profile_csv(const wire::Profile& profile);

/// The points as LAS 1.4, point format 7, or 6 without colours. Coordinates are whole numbers on the profile's lattice,
/// so they are exact, unless the band is too large for 32 bits of its steps; the steps are then larger. Attributes of
/// LAS are in their fields, in the range of the field; all others are doubles in extra bytes. Colours of 8 bits are
/// scaled to 16.
std::string profile_las(const wire::Profile& profile);

/// The file of a format.
std::string profile_file(const wire::Profile& profile, ProfileFormat format);
/// "text/csv; charset=utf-8"
std::string_view media_type(ProfileFormat format);
/// "csv"
std::string_view extension_of(ProfileFormat format);

}  // namespace surfcast::protocol
