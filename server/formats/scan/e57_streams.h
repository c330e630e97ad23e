#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/result.h"
#include "scan/e57_header.h"
#include "scan/e57_pages.h"

namespace surfcast::scan {

/// Where the streams of a scan lie (ASTM E2807-11, 9.3): each field has one, and every data packet has a part of each.
/// The parts of a stream belong together: a value may begin in one packet and end in the next.
class E57Streams {
 public:
  /// Reads the headers of all packets. Fails if a stream has fewer values than the scan has points.
  static Result<E57Streams> open(const E57Pages& pages, const E57Scan& scan);

  /// The bytes of a stream that hold values `first` to `first + count` - 1. The first of them begins at bit
  /// `first * bits % 8`. Seven bytes of zeros follow.
  [[nodiscard]] Result<std::vector<std::byte>> read(const E57Pages& pages, size_t field, int bits, uint64_t first,
                                                    uint64_t count) const;

 private:
  /// A part of a stream.
  struct Part {
    uint64_t end = 0;    ///< within the stream
    uint64_t place = 0;  ///< logical offset of its first byte
  };

  Status add_packet(const E57Pages& pages, uint64_t at, uint64_t size);

  std::vector<std::vector<Part>> parts_;  ///< of each field
};

}  // namespace surfcast::scan
