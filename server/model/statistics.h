#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "surfel/surfel_cloud.h"

namespace surfcast::model {

/// The values of a scalar attribute over the source's surfels; what is no number is left out.
struct AttributeRange {
  std::string attribute;
  double smallest = 0;
  double largest = 0;
  double low = 0;   ///< two surfels in a hundred are below; of intensity alone, otherwise `smallest`
  double high = 0;  ///< two surfels in a hundred are above; likewise
};

/// Surfels of the source of one class.
struct ClassCount {
  uint32_t code = 0;
  uint64_t surfels = 0;
};

/// Figures of the attributes of surfels, collected block by block. The order of blocks does not matter.
class AttributeStatistics {
 public:
  AttributeStatistics() = default;
  AttributeStatistics(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members);

  /// Adds those of other surfels with the same attributes.
  void add(const AttributeStatistics& other);

  /// One for each attribute with numbers; `names` are those of all attributes, in order.
  [[nodiscard]] std::vector<AttributeRange> ranges(std::span<const std::string> names) const;
  /// By code, those that occur; nothing without a classification.
  [[nodiscard]] std::vector<ClassCount> classes() const;

 private:
  struct Extremes {
    double smallest = std::numeric_limits<double>::infinity();
    double largest = -std::numeric_limits<double>::infinity();
  };

  [[nodiscard]] double percentile(double share, const Extremes& bounds) const;

  std::vector<Extremes> extremes_;            ///< of each attribute
  std::map<uint16_t, uint64_t> intensities_;  ///< by the upper half of the ordered bits as float: within a hundredth
  std::array<uint64_t, 256> classes_{};
};

}  // namespace surfcast::model
