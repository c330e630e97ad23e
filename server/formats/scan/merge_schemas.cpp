#include "scan/merge_schemas.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "scan/scalar_type.h"
#include "surfel/conform_scalars.h"
#include "surfel/opacity.h"

namespace surfcast::scan {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

uint8_t code_of(ScalarType type) {
  return static_cast<uint8_t>(type);
}

template <typename Named>
auto find_named(const std::vector<Named>& all, const std::string& name) {
  return std::find_if(all.begin(), all.end(), [&name](const Named& one) { return one.name == name; });
}

void merge_scalars(const std::vector<ScalarField>& more, std::vector<ScalarField>& merged) {
  for (const ScalarField& field : more) {
    const auto known = find_named(merged, field.name);
    if (known == merged.end()) {
      merged.push_back(field);
    } else {
      ScalarType& type = merged[static_cast<size_t>(known - merged.begin())].type;
      type = static_cast<ScalarType>(surfel::common_type(code_of(type), code_of(field.type)));
    }
  }
}

/// Converts colours to `bits` per channel. The factor 257 maps 255 to 65535.
void conform_colors(int bits, ScanPoints& points) {
  if (bits == 0) return;
  if (!points.colors) {
    const auto grey = static_cast<uint16_t>(1 << (bits - 1));
    points.colors = surfel::ColorAttribute{bits, std::vector<glm::u16vec3>(points.size(), glm::u16vec3(grey))};
  }
  if (points.colors->bits == bits) return;
  for (glm::u16vec3& color : points.colors->values) color *= uint16_t{257};
  points.colors->bits = bits;
}

void conform_scalars(const std::vector<ScalarField>& fields, ScanPoints& points) {
  std::vector<surfel::ScalarAttribute> conformed;
  for (const ScalarField& field : fields) {
    const auto own = find_named(points.scalars, field.name);
    if (own == points.scalars.end()) {
      conformed.push_back({field.name, surfel::filling(field.name, code_of(field.type), points.size())});
      continue;
    }
    auto& values = points.scalars[static_cast<size_t>(own - points.scalars.begin())].values;
    conformed.push_back({field.name, surfel::conformed(field.name, std::move(values), code_of(field.type))});
  }
  points.scalars = std::move(conformed);
}

}  // namespace

ScanSchema merge_schemas(std::span<const ScanSchema> scans) {
  ScanSchema cloud;
  cloud.z_up = false;
  for (const ScanSchema& scan : scans) {
    cloud.normals = cloud.normals || scan.normals;
    cloud.radii = cloud.radii || scan.radii;
    cloud.color_bits = std::max(cloud.color_bits, scan.color_bits);
    merge_scalars(scan.scalars, cloud.scalars);
    cloud.z_up = cloud.z_up || scan.z_up;
  }
  return cloud;
}

std::vector<std::string> describe_fillings(std::span<const ScanSchema> scans, const ScanSchema& cloud) {
  std::vector<std::string> notes;
  for (const ScanSchema& scan : scans) {
    for (const std::string& note : scan.notes) notes.push_back(scan.name + ": " + note);
    if (cloud.color_bits != 0 && scan.color_bits == 0) notes.push_back(scan.name + ": no colour, filled with grey");
  }
  for (const ScalarField& field : cloud.scalars) {
    for (const ScanSchema& scan : scans) {
      if (find_named(scan.scalars, field.name) == scan.scalars.end()) {
        const bool opacity = field.name == surfel::kOpacityAttribute;
        notes.push_back(scan.name + ": no " + field.name + (opacity ? ", opaque" : ", filled with 0"));
      }
    }
  }
  return notes;
}

ScanPoints conform(ScanPoints points, const ScanSchema& cloud) {
  if (cloud.normals) points.normals.resize(points.size(), glm::vec3(kMissing));
  if (cloud.radii) points.radii.resize(points.size(), kMissing);
  conform_colors(cloud.color_bits, points);
  conform_scalars(cloud.scalars, points);
  return points;
}

}  // namespace surfcast::scan
