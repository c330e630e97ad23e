#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.h"

namespace surfcast::scan {

/// The pages of an E57 file (ASTM E2807-11, 9.1 to 9.3). The last four bytes of each are a checksum; without them the
/// pages make up the logical file. Offsets in the file are physical unless they are said to be logical.
class E57Pages {
 public:
  /// Reads the file header. `file` must outlive this object.
  static Result<E57Pages> open(std::span<const std::byte> file);

  [[nodiscard]] uint64_t xml_offset() const { return xml_offset_; }   ///< physical
  [[nodiscard]] uint64_t xml_size() const { return xml_size_; }       ///< logical
  [[nodiscard]] uint64_t size() const { return pages_ * payload(); }  ///< of the logical file

  /// The logical offset of a physical one. Fails if that lies beyond the file or in a checksum.
  [[nodiscard]] Result<uint64_t> logical(uint64_t physical) const;
  /// Copies a part of the logical file. Fails beyond its end, and if the checksum of one of its pages is wrong.
  [[nodiscard]] Status read(uint64_t logical, std::span<std::byte> to) const;

 private:
  explicit E57Pages(std::span<const std::byte> file) : file_(file) {}
  [[nodiscard]] uint64_t payload() const { return page_size_ - sizeof(uint32_t); }
  [[nodiscard]] Status check_page(uint64_t page) const;

  std::span<const std::byte> file_;
  uint64_t page_size_ = 1024;
  uint64_t pages_ = 0;  ///< complete ones
  uint64_t xml_offset_ = 0;
  uint64_t xml_size_ = 0;
};

}  // namespace surfcast::scan
