#pragma once

#include <string_view>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// The most points of the line of a profile.
inline constexpr int kMaxProfileLine = 1024;

/// Sets one field of a profile request from its text: `line` ("X,Y,Z;X,Y,Z;..."), `width` or `max_points`. The error
/// states the expected format; an unknown name is kNotFound.
Status set_profile_field(wire::GetProfile& profile, std::string_view name, std::string_view text);

/// Checks a profile request as far as this is possible without the model.
Status check_profile(const wire::GetProfile& profile);

/// Checks that the columns of an answer have the same length and positions are finite, as the writers of files rely
/// on.
Status check_profile_answer(const wire::Profile& profile);

/// A file that holds the points of a profile.
enum class ProfileFormat { kCsv, kLas };

/// "csv" or "las", also in capitals.
Result<ProfileFormat> parse_profile_format(std::string_view text);

/// What a profile URL asks for ("line=1,2,3;4,5,6&width=2&format=las"). Without a format: CSV.
struct ProfileQuery {
  wire::GetProfile profile;
  ProfileFormat format = ProfileFormat::kCsv;
};
/// Parses the query of a profile URL. An unknown, repeated, malformed or missing parameter is an error.
Result<ProfileQuery> parse_profile_query(std::string_view model, std::string_view query);

}  // namespace surfcast::protocol
