#pragma once

#include <string_view>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

inline constexpr int kMaxRegionBoxes = 64;
inline constexpr int kMaxCorridors = 64;
/// Of all corridors of a region.
inline constexpr int kMaxCorridorCorners = 1024;

/// Sets one field of a request for points from its text: `box` ("X,Y,Z,X,Y,Z;...", lower corners first), `corridor`
/// ("WIDTH,X,Y,X,Y;..." with "@LOW,HIGH" behind a corridor of limited height), `classes` ("2,6"), `every`, `format`,
/// `max_points`, `count`, `normals` or `coordinates` ("source", "world"). The error states the expected format; an
/// unknown name is kNotFound.
Status set_points_field(wire::GetPoints& points, std::string_view name, std::string_view text);

/// Checks a request for points as far as this is possible without the model.
Status check_points(const wire::GetPoints& points);

/// "las", "laz", "ply", "csv" or "npy", also in capitals.
Result<wire::PointFormat> parse_point_format(std::string_view text);
/// The same the other way round; also the extension of files.
std::string_view name_of(wire::PointFormat format);

/// Parses the query of a URL for points ("box=0,0,0,9,9,9&format=laz"). Without a format: CSV. An unknown, repeated or
/// malformed parameter is an error.
Result<wire::GetPoints> parse_points_query(std::string_view model, std::string_view query);

}  // namespace surfcast::protocol
