#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace surfcast::surfel {

/// The values of one per-point attribute in the type of its source, so that they are preserved exactly.
using ScalarValues = std::variant<std::vector<uint8_t>, std::vector<int8_t>, std::vector<uint16_t>,
                                  std::vector<int16_t>, std::vector<uint32_t>, std::vector<int32_t>,
                                  std::vector<uint64_t>, std::vector<int64_t>, std::vector<float>, std::vector<double>>;

/// A named attribute beside position, normal, radius and colour. Well-known names: "intensity", "classification",
/// "alpha", "return_number", "number_of_returns", "gps_time", "point_source_id".
struct ScalarAttribute {
  std::string name;
  ScalarValues values;
};

[[nodiscard]] inline size_t value_count(const ScalarValues& values) {
  return std::visit([](const auto& v) { return v.size(); }, values);
}

}  // namespace surfcast::surfel
