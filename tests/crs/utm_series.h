#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace surfcast::crs {

/// Easting and northing of the northern half of a UTM zone on GRS 80, metres, of a longitude and latitude in degrees:
/// by the series of Krueger (1912) in the third flattening to the sixth order, as Karney gives them ("Transverse
/// Mercator with an accuracy of a few nanometers", J. Geodesy 85, 2011, equation 35). Independent of PROJ.
glm::dvec2 utm_of(double longitude, double latitude, int zone);

/// Geocentric coordinates on GRS 80 of a longitude and latitude in degrees and a height in metres.
glm::dvec3 geocentric_of(double longitude, double latitude, double height);

}  // namespace surfcast::crs
