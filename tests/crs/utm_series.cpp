#include "utm_series.h"

#include <array>
#include <cmath>
#include <numbers>

namespace surfcast::crs {
namespace {

constexpr double kEquator = 6'378'137;  // metres, of GRS 80
constexpr double kFlattening = 1 / 298.257222101;
constexpr double kDegree = std::numbers::pi / 180;

/// The sum of the coefficients times powers of n, the first power first.
double in_powers_of(double n, std::array<double, 6> coefficients) {
  double sum = 0;
  double power = 1;
  for (const double coefficient : coefficients) sum += coefficient * (power *= n);
  return sum;
}

}  // namespace

glm::dvec2 utm_of(double longitude, double latitude, int zone) {
  const double n = kFlattening / (2 - kFlattening);
  const double e = std::sqrt(kFlattening * (2 - kFlattening));
  const std::array<double, 6> alpha{
      in_powers_of(n, {1.0 / 2, -2.0 / 3, 5.0 / 16, 41.0 / 180, -127.0 / 288, 7891.0 / 37800}),
      in_powers_of(n, {0, 13.0 / 48, -3.0 / 5, 557.0 / 1440, 281.0 / 630, -1983433.0 / 1935360}),
      in_powers_of(n, {0, 0, 61.0 / 240, -103.0 / 140, 15061.0 / 26880, 167603.0 / 181440}),
      in_powers_of(n, {0, 0, 0, 49561.0 / 161280, -179.0 / 168, 6601661.0 / 7257600}),
      in_powers_of(n, {0, 0, 0, 0, 34729.0 / 80640, -3418889.0 / 1995840}),
      in_powers_of(n, {0, 0, 0, 0, 0, 212378941.0 / 319334400})};
  const double radius = kEquator / (1 + n) * (1 + n * n / 4 + std::pow(n, 4) / 64 + std::pow(n, 6) / 256);
  const double sine = std::sin(latitude * kDegree);
  const double t = std::sinh(std::atanh(sine) - e * std::atanh(e * sine));  // tangent of the conformal latitude
  const double lambda = (longitude - (6.0 * zone - 183)) * kDegree;
  const double xi = std::atan2(t, std::cos(lambda));
  const double eta = std::asinh(std::sin(lambda) / std::hypot(t, std::cos(lambda)));
  double x = eta;
  double y = xi;
  for (int j = 1; j <= 6; ++j) {
    const double a = alpha.at(static_cast<size_t>(j - 1));
    x += a * std::cos(2 * j * xi) * std::sinh(2 * j * eta);
    y += a * std::sin(2 * j * xi) * std::cosh(2 * j * eta);
  }
  return {500'000 + 0.9996 * radius * x, 0.9996 * radius * y};
}

glm::dvec3 geocentric_of(double longitude, double latitude, double height) {
  const double squared = kFlattening * (2 - kFlattening);
  const double sine = std::sin(latitude * kDegree);
  const double cosine = std::cos(latitude * kDegree);
  const double normal = kEquator / std::sqrt(1 - squared * sine * sine);
  return {(normal + height) * cosine * std::cos(longitude * kDegree),
          (normal + height) * cosine * std::sin(longitude * kDegree), (normal * (1 - squared) + height) * sine};
}

}  // namespace surfcast::crs
