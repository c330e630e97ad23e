#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace surfcast::client {

/// The place of the chunk table of a LAZ file, which stands before its points. A server that sends a file piece by
/// piece does not know it beforehand: it writes -1 there and the place at the end, which LASzip allows and many
/// programs refuse. This finds out what to write where.
class ChunkTablePlace {
 public:
  struct Correction {
    size_t offset = 0;  ///< in the file
    std::string bytes;
  };

  /// The next bytes of the file.
  void add(std::string_view bytes);
  /// After the last bytes; nothing if the file is no LAZ, or states the place already.
  [[nodiscard]] std::optional<Correction> correction() const;

 private:
  std::string head_;  ///< the file up to the place; no more than that is kept
  std::string tail_;  ///< its last bytes
  size_t size_ = 0;
};

}  // namespace surfcast::client
