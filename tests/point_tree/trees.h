#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/byte_source.h"
#include "point_tree/node_tree.h"

namespace surfcast::point_tree::testing {

/// The bytes of a file, kept by the source itself.
class OwnedSource : public ByteSource {
 public:
  explicit OwnedSource(std::string bytes, std::string version = "1") : bytes_(std::move(bytes)), version_(version) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] Status read(uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset > size() || bytes.size() > size() - offset) return fail(ErrorKind::kInvalidInput, "ends before");
    std::copy_n(reinterpret_cast<const std::byte*>(bytes_.data()) + offset, bytes.size(), bytes.begin());
    return {};
  }
  void prefetch(std::span<const ByteRange> /*ranges*/) const override {}
  [[nodiscard]] std::string version() const override { return version_; }

 private:
  std::string bytes_;
  std::string version_;
  std::string name_ = "tree.copc.laz";
};

inline std::unique_ptr<const ByteSource> source_of(std::string bytes) {
  return std::make_unique<const OwnedSource>(std::move(bytes));
}

inline Node node(uint8_t depth, uint32_t x, uint32_t y, uint32_t z, uint64_t points = 100) {
  Node made;
  made.key = {depth, x, y, z};
  made.points = points;
  return made;
}

}  // namespace surfcast::point_tree::testing
