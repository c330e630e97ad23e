#include "scan/merge_scans.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "scan/scalar_type.h"

namespace surfcast {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

using Scans = std::vector<ScanPoints>;

size_t total_size(const Scans& scans) {
  size_t total = 0;
  for (const ScanPoints& scan : scans) total += scan.size();
  return total;
}

/// One member of all scans in a row; a scan without it contributes `missing`. Frees what it takes.
template <typename T>
std::vector<T> join(Scans& scans, std::vector<T> ScanPoints::*member, const std::vector<size_t>& sizes, T missing) {
  if (std::all_of(scans.begin(), scans.end(), [member](const ScanPoints& s) { return (s.*member).empty(); })) return {};
  std::vector<T> joined = std::move(scans[0].*member);
  joined.resize(sizes[0], missing);
  for (size_t i = 1; i < scans.size(); ++i) {
    std::vector<T> part = std::exchange(scans[i].*member, {});
    part.resize(sizes[i], missing);
    joined.insert(joined.end(), part.begin(), part.end());
  }
  return joined;
}

/// Colours of any depth in `bits`: 257 takes 255 to 65535.
void append_colors(const ColorAttribute& from, int bits, std::vector<glm::u16vec3>& to) {
  const int factor = from.bits < bits ? 257 : 1;
  for (const glm::u16vec3& c : from.values) to.push_back(c * static_cast<uint16_t>(factor));
}

std::optional<ColorAttribute> join_colors(Scans& scans, size_t total, std::vector<std::string>& notes) {
  int bits = 0;
  for (const ScanPoints& scan : scans) {
    if (scan.colors) bits = std::max(bits, scan.colors->bits);
  }
  if (bits == 0) return std::nullopt;
  if (scans.size() == 1) return std::move(scans[0].colors);
  ColorAttribute joined{bits, {}};
  joined.values.reserve(total);
  const auto grey = static_cast<uint16_t>(1 << (bits - 1));
  for (ScanPoints& scan : scans) {
    if (scan.colors) {
      append_colors(*scan.colors, bits, joined.values);
      scan.colors.reset();
    } else {
      joined.values.resize(joined.values.size() + scan.size(), glm::u16vec3(grey));
      notes.push_back(scan.name + ": no colour, filled with grey");
    }
  }
  return joined;
}

const ScalarAttribute* find_scalar(const ScanPoints& scan, const std::string& name) {
  const auto it = std::find_if(scan.scalars.begin(), scan.scalars.end(),
                               [&name](const ScalarAttribute& s) { return s.name == name; });
  return it == scan.scalars.end() ? nullptr : &*it;
}

/// The smallest type that holds all values of both; doubles where none does.
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

template <typename T>
void append_scalars(const ScalarAttribute* from, size_t count, std::vector<T>& to) {
  if (from == nullptr) {
    to.resize(to.size() + count, T{0});
    return;
  }
  std::visit(
      [&to](const auto& values) {
        for (const auto v : values) to.push_back(static_cast<T>(v));
      },
      from->values);
}

ScalarAttribute join_scalar(const Scans& scans, const std::string& name, size_t total,
                            std::vector<std::string>& notes) {
  std::optional<ScalarType> type;
  for (const ScanPoints& scan : scans) {
    const ScalarAttribute* scalar = find_scalar(scan, name);
    if (scalar != nullptr) type = type ? common_type(*type, type_of(scalar->values)) : type_of(scalar->values);
    if (scalar == nullptr) notes.push_back(scan.name + ": no " + name + ", filled with 0");
  }
  ScalarAttribute joined{name, empty_values(*type)};
  std::visit(
      [&](auto& values) {
        values.reserve(total);
        for (const ScanPoints& scan : scans) append_scalars(find_scalar(scan, name), scan.size(), values);
      },
      joined.values);
  return joined;
}

std::vector<ScalarAttribute> join_scalars(Scans& scans, size_t total, std::vector<std::string>& notes) {
  if (scans.size() == 1) return std::move(scans[0].scalars);
  std::vector<std::string> names;
  for (const ScanPoints& scan : scans) {
    for (const ScalarAttribute& scalar : scan.scalars) {
      if (std::find(names.begin(), names.end(), scalar.name) == names.end()) names.push_back(scalar.name);
    }
  }
  std::vector<ScalarAttribute> joined;
  joined.reserve(names.size());
  for (const std::string& name : names) joined.push_back(join_scalar(scans, name, total, notes));
  return joined;
}

}  // namespace

SurfelCloud merge_scans(std::vector<ScanPoints> scans, std::vector<std::string>& notes) {
  SurfelCloud cloud;
  if (scans.empty()) return cloud;
  const size_t total = total_size(scans);
  std::vector<size_t> sizes;
  size_t first = 0;
  cloud.z_up = false;
  for (const ScanPoints& scan : scans) {
    cloud.sources.push_back({scan.name, first, scan.size(), scan.grid});
    cloud.z_up = cloud.z_up || scan.z_up;
    sizes.push_back(scan.size());
    first += scan.size();
  }
  cloud.colors = join_colors(scans, total, notes);
  cloud.scalars = join_scalars(scans, total, notes);
  cloud.normals = join(scans, &ScanPoints::normals, sizes, glm::vec3(kMissing));
  cloud.radii = join(scans, &ScanPoints::radii, sizes, kMissing);
  cloud.positions = join(scans, &ScanPoints::positions, sizes, glm::dvec3(0));
  return cloud;
}

}  // namespace surfcast
