#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace surfcast::laz {

/// Probabilities of symbols are fractions of 2^15.
constexpr int kSymbolShift = 15;
/// The probability of a zero bit is a fraction of 2^13.
constexpr int kBitShift = 13;

/// The adaptive probability that a bit is zero. As in all models of LASzip, occurrences are counted continuously, and
/// the probability is updated in growing intervals (Said 2004, "Introduction to Arithmetic Coding", FastAC).
class BitModel {
 public:
  [[nodiscard]] uint32_t zero_probability() const { return zero_probability_; }

  void count(bool bit) {
    if (!bit) ++zeros_;
    if (--until_renewal_ == 0) renew();
  }

 private:
  [[gnu::noinline]] void renew() {
    constexpr uint32_t kMaxBits = 1U << kBitShift;
    constexpr uint32_t kLongestInterval = 64;
    bits_ += interval_;
    if (bits_ > kMaxBits) {
      bits_ = (bits_ + 1) / 2;
      zeros_ = (zeros_ + 1) / 2;
      if (zeros_ == bits_) ++bits_;
    }
    zero_probability_ = (zeros_ * (0x80000000U / bits_)) >> (31 - kBitShift);
    interval_ = std::min(interval_ * 5 / 4, kLongestInterval);
    until_renewal_ = interval_;
  }

  uint32_t zeros_ = 1;
  uint32_t bits_ = 2;
  uint32_t zero_probability_ = 1U << (kBitShift - 1);
  uint32_t interval_ = 4;
  uint32_t until_renewal_ = 4;
};

/// How many of `kCount` ascending numbers are at most `limit`. Compares all of them, without a branch that could be
/// mispredicted; compilers emit a few vector instructions.
template <size_t kCount>
uint32_t count_up_to(const uint16_t* numbers, uint16_t limit) {
  uint16_t count = 0;
  for (size_t i = 0; i < kCount; ++i) count = static_cast<uint16_t>(count + (numbers[i] <= limit ? 1 : 0));
  return count;
}

/// The adaptive probabilities of `kSymbols` symbols, initially equal.
template <uint32_t kSymbols>
class SymbolModel {
 public:
  SymbolModel() {
    lower_.fill(kBeyond);
    group_lower_.fill(kBeyond);
    counts_.fill(1);
    spread(kSymbols);
    interval_ = until_renewal_ = (kSymbols + 6) / 2;
  }

  /// Sum of the probabilities of all symbols before this one.
  [[nodiscard]] uint32_t lower(uint32_t symbol) const { return lower_[symbol]; }
  /// The symbol whose range contains `target`: the last one with `lower` at most `target`.
  [[nodiscard]] uint32_t find(uint16_t target) const {
    if constexpr (kFlat) return count_up_to<kPadded>(lower_.data(), target) - 1;
    const uint32_t group = count_up_to<kGroups>(group_lower_.data(), target) - 1;
    return group * kGroup + count_up_to<kGroup>(&lower_[group * kGroup], target) - 1;
  }

  void count(uint32_t symbol) {
    ++counts_[symbol];
    if (--until_renewal_ == 0) renew();
  }

 private:
  static constexpr uint32_t round_up(uint32_t number, uint32_t step) { return (number + step - 1) / step * step; }
  static constexpr uint32_t kLane = 8;
  static constexpr uint32_t kGroup = 16;
  static constexpr bool kFlat = kSymbols <= 64;
  static constexpr uint32_t kPadded = round_up(kSymbols, kFlat ? kLane : kGroup);
  static constexpr uint32_t kGroups = round_up(kPadded / kGroup, kLane);
  static constexpr uint16_t kBeyond = 0xFFFF;  ///< padding: larger than any target

  [[gnu::noinline]] void renew() {
    constexpr uint32_t kMaxCounts = 1U << kSymbolShift;
    constexpr uint32_t kLongestInterval = (kSymbols + 6) * 8;
    total_ += interval_;
    if (total_ > kMaxCounts) {
      total_ = 0;
      for (uint16_t& n : counts_) total_ += n = static_cast<uint16_t>((n + 1) / 2);
    }
    spread(total_);
    interval_ = std::min(interval_ * 5 / 4, kLongestInterval);
    until_renewal_ = interval_;
  }

  void spread(uint32_t total) {
    const uint32_t scale = 0x80000000U / total;
    uint32_t sum = 0;
    for (uint32_t i = 0; i < kSymbols; ++i) {
      lower_[i] = static_cast<uint16_t>((scale * sum) >> (31 - kSymbolShift));
      sum += counts_[i];
    }
    if constexpr (kFlat) return;
    for (uint32_t i = 0; i < kPadded / kGroup; ++i) group_lower_[i] = lower_[i * kGroup];
  }

  std::array<uint16_t, kPadded> lower_;
  std::array<uint16_t, kFlat ? 0 : kGroups> group_lower_;  ///< of the first symbol of each group
  std::array<uint16_t, kSymbols> counts_;
  uint32_t total_ = kSymbols;
  uint32_t interval_;
  uint32_t until_renewal_;
};

}  // namespace surfcast::laz
