#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "base/byte_source.h"

namespace surfcast {

/// Bytes in memory, which must outlive it.
class MemorySource : public ByteSource {
 public:
  explicit MemorySource(std::span<const std::byte> bytes, std::string name = {})
      : bytes_(bytes), name_(std::move(name)) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] Status read(uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset > bytes_.size() || bytes.size() > bytes_.size() - offset) {
      return fail(ErrorKind::kInvalidInput, "truncated");
    }
    std::ranges::copy(bytes_.subspan(offset, bytes.size()), bytes.begin());
    return {};
  }
  void prefetch(std::span<const ByteRange> /*ranges*/) const override {}

 private:
  std::span<const std::byte> bytes_;
  std::string name_;
};

}  // namespace surfcast
