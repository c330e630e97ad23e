#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <string_view>

namespace surfcast::net {

/// How often something took how long: in bins of which each is twice as long as
/// the one before.
class Histogram {
 public:
  static constexpr size_t kBins = 16;
  /// The end of a bin, seconds: 0.001 to 32.768.
  static double bound(size_t bin);

  void add(double seconds);
  /// Values up to the end of a bin.
  [[nodiscard]] uint64_t count_to(size_t bin) const;
  [[nodiscard]] uint64_t count() const { return count_; }
  [[nodiscard]] double sum() const { return sum_; }

 private:
  std::array<uint64_t, kBins> counts_{};  ///< within each bin
  uint64_t count_ = 0;                    ///< those beyond the last bin too
  double sum_ = 0;
};

/// Writes figures as Prometheus reads them: its own text format, version 0.0.4,
/// or OpenMetrics 1.0.
class Exposition {
 public:
  enum class Format { kPrometheus, kOpenMetrics };

  explicit Exposition(Format format) : format_(format) {}

  /// Begins a family of samples. The names of counters end in "_total".
  void begin(std::string_view name, std::string_view type, std::string_view help);
  /// `label`: empty, or a name and a value, `stage="draw"`.
  void add(std::string_view name, std::string_view label, double value);
  void add(std::string_view name, std::string_view label, uint64_t value);
  void add(std::string_view name, std::string_view label, const Histogram& histogram);
  /// A family of one sample.
  void value(std::string_view name, std::string_view type, std::string_view help, uint64_t value);
  /// All of it.
  [[nodiscard]] std::string text() const;

 private:
  Format format_;
  std::ostringstream out_;
};

/// What a client that sends this header `Accept` gets.
Exposition::Format exposition_format(std::string_view accept);
/// Of an answer in that format.
std::string_view media_type(Exposition::Format format);

/// `name="text"`, with the three characters escaped that both formats want
/// escaped.
std::string label_of(std::string_view name, std::string_view text);

}  // namespace surfcast::net
