#include "lab/leave_out.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

#include "base/hash.h"

namespace surfcast::lab {
namespace {

constexpr uint64_t kParts = 5;  ///< one of these parts is left out
constexpr int kMajority = 7;    ///< of the nine pixels

double share(uint64_t part, uint64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

bool left_out(const glm::dvec3& position) {
  const glm::dvec3 key = position + 0.0;  // -0 and 0 are one place
  return hash_of(std::as_bytes(std::span(&key, 1))) % kParts == 0;
}

DepthPicture::DepthPicture(int w, int h)
    : width(w), height(h), depths(static_cast<size_t>(w) * h, std::numeric_limits<float>::infinity()) {}

std::optional<Verdict> judge(const DepthPicture& picture, const glm::dvec2& pixel, double z, double tolerance) {
  if (!(pixel.x >= 1 && pixel.y >= 1 && pixel.x < picture.width - 1 && pixel.y < picture.height - 1)) return {};
  int nearer = 0;
  int farther = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const auto depth =
          double{picture.depths[picture.index(static_cast<int>(pixel.x) + dx, static_cast<int>(pixel.y) + dy)]};
      nearer += depth < z - tolerance ? 1 : 0;
      farther += depth > z + tolerance ? 1 : 0;
    }
  }
  if (nearer >= kMajority) return Verdict::kHidden;
  return farther >= kMajority ? Verdict::kMissing : Verdict::kSeen;
}

double depth_tolerance(double spacing, double z, double eta) {
  return 2 * spacing + z / eta;
}

void LeaveOutCounts::count(Verdict verdict, bool surface) {
  ++by_verdict[static_cast<size_t>(verdict)];
  off_surface += surface ? 0 : 1;
  surface_hidden += surface && verdict == Verdict::kHidden ? 1 : 0;
}

void LeaveOutCounts::add(const LeaveOutCounts& other) {
  for (size_t i = 0; i < by_verdict.size(); ++i) by_verdict[i] += other.by_verdict[i];
  off_surface += other.off_surface;
  surface_hidden += other.surface_hidden;
}

double LeaveOutCounts::percent(Verdict verdict) const {
  return share(by_verdict[static_cast<size_t>(verdict)], open());
}

double LeaveOutCounts::off_surface_percent() const {
  return share(off_surface, open());
}

double LeaveOutCounts::surface_hidden_percent() const {
  return share(surface_hidden, open() - off_surface);
}

void ColorErrors::add(const glm::u8vec3& pixel, const glm::u8vec3& point) {
  const glm::dvec3 d = glm::dvec3(pixel) - glm::dvec3(point);
  squares += glm::dot(d, d);
  ++points;
}

void ColorErrors::add(const ColorErrors& other) {
  points += other.points;
  squares += other.squares;
}

std::optional<double> ColorErrors::rms() const {
  if (points == 0) return std::nullopt;
  return std::sqrt(squares / (3 * static_cast<double>(points)));
}

}  // namespace surfcast::lab
