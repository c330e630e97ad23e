#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "model/byte_stream.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::model {

/// The range of a scalar attribute over the source's surfels, without infinite values and NaNs.
struct AttributeRange {
  std::string attribute;
  double smallest = 0;
  double largest = 0;
  double low = 0;   ///< second percentile of intensity; `smallest` for other attributes
  double high = 0;  ///< 98th percentile of intensity; `largest` for other attributes
};

/// Number of source surfels of one class.
struct ClassCount {
  uint32_t code = 0;
  uint64_t surfels = 0;
};

/// Statistics of the attributes of surfels, collected block by block. The order of blocks does not matter.
class AttributeStatistics {
 public:
  AttributeStatistics() = default;
  AttributeStatistics(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members);

  /// What the tables of a model say about the surfels of its leaves: all but the frequencies of intensities. `names`
  /// are the names of all attributes, in order.
  AttributeStatistics(std::span<const std::string> names, std::span<const AttributeRange> ranges,
                      std::span<const ClassCount> classes);

  /// Takes away the classes of surfels that are among these.
  void take_classes(const AttributeStatistics& of);
  /// Adds the intensities of a sample that stands for so many times its surfels.
  void add_intensities(const AttributeStatistics& sample, double times);

  /// Adds the statistics of other surfels with the same attributes.
  void add(const AttributeStatistics& other);

  void write(ByteWriter& bytes) const;
  /// What `write` wrote; the reader is not ok if it is anything else.
  static AttributeStatistics read(ByteReader& bytes);

  /// One range for each attribute with finite values. `names` are the names of all attributes, in order.
  [[nodiscard]] std::vector<AttributeRange> ranges(std::span<const std::string> names) const;
  /// The classes that occur, sorted by code; empty without a classification.
  [[nodiscard]] std::vector<ClassCount> classes() const;

 private:
  struct Extremes {
    double smallest = std::numeric_limits<double>::infinity();
    double largest = -std::numeric_limits<double>::infinity();
  };

  [[nodiscard]] double percentile(double share, const Extremes& bounds) const;

  std::vector<Extremes> extremes_;  ///< of each attribute
  std::map<uint16_t, uint64_t>
      intensities_;  ///< counts by the upper 16 ordered bits of the value as a float: a resolution of 1 %
  std::array<uint64_t, 256> classes_{};
};

}  // namespace surfcast::model
