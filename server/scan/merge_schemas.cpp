#include "scan/merge_schemas.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "scan/scalar_type.h"
#include "surfel/opacity.h"

namespace surfcast::scan {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// The smallest type that holds all values of both types; double if none does.
ScalarType common_type(ScalarType a, ScalarType b) {
  if (a == b) return a;
  const auto holds = [](ScalarType wide, ScalarType narrow) {
    return with_type(wide, [narrow](auto w) {
      return with_type(narrow, [](auto n) {
        using Wide = std::numeric_limits<decltype(w)>;
        using Narrow = std::numeric_limits<decltype(n)>;
        return Wide::digits >= Narrow::digits && (Wide::is_signed || !Narrow::is_signed) &&
               (!Wide::is_integer || Narrow::is_integer);
      });
    });
  };
  for (int type = 0; type <= static_cast<int>(ScalarType::kFloat64); ++type) {
    const auto candidate = static_cast<ScalarType>(type);
    if (holds(candidate, a) && holds(candidate, b)) return candidate;
  }
  return ScalarType::kFloat64;
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
      merged[static_cast<size_t>(known - merged.begin())].type = common_type(known->type, field.type);
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

surfel::ScalarValues convert(surfel::ScalarValues values, ScalarType type) {
  if (type_of(values) == type) return values;
  return with_type(type, [&](auto zero) {
    using T = decltype(zero);
    return std::visit(
        [](const auto& from) {
          std::vector<T> to(from.size());
          std::transform(from.begin(), from.end(), to.begin(), [](auto v) { return static_cast<T>(v); });
          return surfel::ScalarValues(std::move(to));
        },
        values);
  });
}

/// Opacities in the unit of another type.
surfel::ScalarValues convert_opacities(const surfel::ScalarValues& values, ScalarType type) {
  return with_type(type, [&values](auto zero) {
    using T = decltype(zero);
    std::vector<T> to(surfel::value_count(values));
    for (size_t i = 0; i < to.size(); ++i) {
      to[i] = surfel::opacity_as<T>(surfel::opacity_at(values, i));
    }
    return surfel::ScalarValues(std::move(to));
  });
}

/// What stands for an attribute that a scan lacks: full opacity, or 0.
surfel::ScalarValues filling(const ScalarField& field, size_t count) {
  return with_type(field.type, [&](auto zero) {
    using T = decltype(zero);
    const bool opacity = field.name == surfel::kOpacityAttribute;
    const T value = opacity ? surfel::opacity_as<T>(1) : zero;
    return surfel::ScalarValues(std::vector<T>(count, value));
  });
}

void conform_scalars(const std::vector<ScalarField>& fields, ScanPoints& points) {
  std::vector<surfel::ScalarAttribute> conformed;
  for (const ScalarField& field : fields) {
    const auto own = find_named(points.scalars, field.name);
    if (own == points.scalars.end()) {
      conformed.push_back({field.name, filling(field, points.size())});
      continue;
    }
    auto& values = points.scalars[static_cast<size_t>(own - points.scalars.begin())].values;
    const bool rescaled = field.name == surfel::kOpacityAttribute && type_of(values) != field.type;
    conformed.push_back(
        {field.name, rescaled ? convert_opacities(values, field.type) : convert(std::move(values), field.type)});
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
