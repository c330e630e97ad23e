#pragma once

#include <cstdint>
#include <optional>

#include "grid/vtk_block_stream.h"
#include "scan/scalar_type.h"
#include "stream/mapped_stream.h"

namespace surfcast::grid {

/// Where the numbers of an array are in a VTK file, and how they are coded.
struct StoredNumbers {
  stream::FilePtr file;
  uint64_t begin = 0;
  uint64_t size = 0;  ///< bytes of the file that they may take
  bool text = false;
  bool base64 = false;
  bool headed = true;  ///< bytes are behind a header, as in XML
  VtkBlockCoding coding;
  scan::ScalarType type = scan::ScalarType::kUint8;
  uint64_t values = 0;

  [[nodiscard]] uint64_t bytes() const;  ///< of all values
  /// True if the bytes are in the byte order that is not this machine's.
  [[nodiscard]] bool swapped() const { return !text && coding.swapped; }
  [[nodiscard]] Result<stream::StreamPtr> open() const;
  /// Where the bytes of the values are in the file; none if they have to be decoded.
  [[nodiscard]] Result<std::optional<uint64_t>> in_file() const;
};

/// An error if the stream cannot hold so many bytes.
[[nodiscard]] Status check_holds(const stream::ByteStream& stream, uint64_t bytes);

}  // namespace surfcast::grid
