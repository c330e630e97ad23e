#pragma once

#include <algorithm>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "scan/scan_points.h"

namespace surfcast::testing {

/// Builds the content of a file number by number.
class Bytes {
 public:
  explicit Bytes(std::string_view text = {}) : text_(text) {}

  template <typename T>
  Bytes& add(T value, bool big_endian = false) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big_endian) std::reverse(raw, raw + sizeof(T));
    text_.append(raw, sizeof(T));
    return *this;
  }
  Bytes& add_text(std::string_view text) {
    text_ += text;
    return *this;
  }
  template <typename T>
  Bytes& set(size_t offset, T value) {
    if (text_.size() < offset + sizeof(T)) text_.resize(offset + sizeof(T));
    std::memcpy(text_.data() + offset, &value, sizeof(T));
    return *this;
  }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return std::as_bytes(std::span(text_)); }

 private:
  std::string text_;
};

inline std::span<const std::byte> as_bytes(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// The values of a scalar attribute when it has exactly that type, else nothing.
template <typename T>
std::vector<T> scalar_values(const scan::ScanPoints& points, std::string_view name) {
  for (const surfel::ScalarAttribute& scalar : points.scalars) {
    if (scalar.name != name) continue;
    if (const auto* values = std::get_if<std::vector<T>>(&scalar.values)) return *values;
  }
  return {};
}

}  // namespace surfcast::testing
