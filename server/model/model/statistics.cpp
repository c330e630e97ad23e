#include "model/statistics.h"

#include <algorithm>
#include <cmath>

#include "model/scalar_bits.h"

namespace surfcast::model {
namespace {

/// Share of the surfels below `low` and above `high`: large enough to exclude outliers and bright reflectors.
constexpr double kExtremeTail = 0.02;

/// Calls `use` with those of the members' values that are finite.
template <typename Use>
void for_each_number(const surfel::ScalarValues& values, std::span<const uint32_t> members, const Use& use) {
  std::visit(
      [&](const auto& column) {
        for (const uint32_t member : members) {
          const auto value = static_cast<double>(column[member]);
          if (std::isfinite(value)) use(value);
        }
      },
      values);
}

uint16_t bucket_of(double value) {
  return static_cast<uint16_t>(to_ordered_bits(static_cast<float>(value)) >> 16);
}

std::map<uint16_t, uint64_t> count_buckets(const surfel::ScalarValues& values, std::span<const uint32_t> members) {
  std::vector<uint32_t> counts(size_t{1} << 16U);
  for_each_number(values, members, [&counts](double value) { ++counts[bucket_of(value)]; });
  std::map<uint16_t, uint64_t> buckets;
  for (size_t bucket = 0; bucket < counts.size(); ++bucket) {
    if (counts[bucket] > 0) buckets.emplace_hint(buckets.end(), static_cast<uint16_t>(bucket), counts[bucket]);
  }
  return buckets;
}

}  // namespace

AttributeStatistics::AttributeStatistics(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members) {
  for (const surfel::ScalarAttribute& scalar : cloud.scalars) {
    Extremes& extremes = extremes_.emplace_back();
    for_each_number(scalar.values, members, [&extremes](double value) {
      extremes.smallest = std::min(extremes.smallest, value);
      extremes.largest = std::max(extremes.largest, value);
    });
    if (scalar.name == "intensity") {
      intensities_ = count_buckets(scalar.values, members);
    } else if (scalar.name == "classification") {
      for_each_number(scalar.values, members, [this](double value) {
        ++classes_[static_cast<size_t>(std::lround(std::clamp(value, 0.0, 255.0)))];
      });
    }
  }
}

AttributeStatistics::AttributeStatistics(std::span<const std::string> names, std::span<const AttributeRange> ranges,
                                         std::span<const ClassCount> classes) {
  for (const std::string& name : names) {
    Extremes& extremes = extremes_.emplace_back();
    const auto range = std::ranges::find(ranges, name, &AttributeRange::attribute);
    if (range != ranges.end()) extremes = {range->smallest, range->largest};
  }
  for (const ClassCount& count : classes) classes_.at(count.code) = count.surfels;
}

void AttributeStatistics::take_classes(const AttributeStatistics& of) {
  for (size_t code = 0; code < classes_.size(); ++code) classes_[code] -= std::min(classes_[code], of.classes_[code]);
}

void AttributeStatistics::add_intensities(const AttributeStatistics& sample, double times) {
  for (const auto& [bucket, count] : sample.intensities_) {
    intensities_[bucket] += static_cast<uint64_t>(std::llround(times * static_cast<double>(count)));
  }
}

void AttributeStatistics::add(const AttributeStatistics& other) {
  extremes_.resize(std::max(extremes_.size(), other.extremes_.size()));
  for (size_t i = 0; i < other.extremes_.size(); ++i) {
    extremes_[i].smallest = std::min(extremes_[i].smallest, other.extremes_[i].smallest);
    extremes_[i].largest = std::max(extremes_[i].largest, other.extremes_[i].largest);
  }
  for (const auto& [bucket, count] : other.intensities_) intensities_[bucket] += count;
  for (size_t code = 0; code < classes_.size(); ++code) classes_[code] += other.classes_[code];
}

void AttributeStatistics::write(ByteWriter& bytes) const {
  bytes.put_varint(extremes_.size());
  for (const Extremes& extremes : extremes_) {
    bytes.put(extremes.smallest);
    bytes.put(extremes.largest);
  }
  bytes.put_varint(intensities_.size());
  for (const auto& [bucket, count] : intensities_) {
    bytes.put(bucket);
    bytes.put_varint(count);
  }
  for (const uint64_t count : classes_) bytes.put_varint(count);
}

AttributeStatistics AttributeStatistics::read(ByteReader& bytes) {
  AttributeStatistics statistics;
  for (uint64_t left = bytes.get_varint(); left > 0 && bytes.ok(); --left) {
    Extremes& extremes = statistics.extremes_.emplace_back();
    extremes.smallest = bytes.get<double>();
    extremes.largest = bytes.get<double>();
  }
  for (uint64_t left = bytes.get_varint(); left > 0 && bytes.ok(); --left) {
    const auto bucket = bytes.get<uint16_t>();
    statistics.intensities_[bucket] = bytes.get_varint();
  }
  for (uint64_t& count : statistics.classes_) count = bytes.get_varint();
  return statistics;
}

/// The intensity below which this share of the surfels lies, to the resolution of a bucket.
double AttributeStatistics::percentile(double share, const Extremes& bounds) const {
  uint64_t total = 0;
  for (const auto& [bucket, count] : intensities_) total += count;
  const double wanted = share * static_cast<double>(total);
  uint64_t below = 0;
  for (const auto& [bucket, count] : intensities_) {
    below += count;
    if (static_cast<double>(below) < wanted) continue;
    const double value = double{from_ordered_bits<float>(static_cast<uint32_t>(bucket) << 16)};
    return std::clamp(value, bounds.smallest, bounds.largest);
  }
  return bounds.largest;
}

std::vector<AttributeRange> AttributeStatistics::ranges(std::span<const std::string> names) const {
  std::vector<AttributeRange> ranges;
  for (size_t i = 0; i < std::min(names.size(), extremes_.size()); ++i) {
    const Extremes& extremes = extremes_[i];
    if (!(extremes.smallest <= extremes.largest)) continue;
    AttributeRange range{names[i], extremes.smallest, extremes.largest, extremes.smallest, extremes.largest};
    if (names[i] == "intensity") {
      range.low = percentile(kExtremeTail, extremes);
      range.high = percentile(1 - kExtremeTail, extremes);
    }
    ranges.push_back(std::move(range));
  }
  return ranges;
}

std::vector<ClassCount> AttributeStatistics::classes() const {
  std::vector<ClassCount> counts;
  for (uint32_t code = 0; code < classes_.size(); ++code) {
    if (classes_[code] > 0) counts.push_back({code, classes_[code]});
  }
  return counts;
}

}  // namespace surfcast::model
