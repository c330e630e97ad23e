#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "laz/chunk_encoders.h"
#include "laz/laz_file.h"

namespace surfcast::laz::testing {

/// The compressed part of a LAZ file: what begins at the point data, and the record that describes it.
struct LazWriter {
  int point_format = 0;
  size_t record_length = 20;
  uint16_t layered_version = 3;     ///< of the items of formats 6 to 8
  bool offset_at_end = false;       ///< the chunk table's offset is in the last bytes of the file
  std::vector<size_t> chunk_sizes;  ///< points in each chunk, if `variable_chunks`
  bool variable_chunks = false;
  uint32_t chunk_size = 50;

  [[nodiscard]] LazPoints points(std::span<const std::byte> records) const {
    return {point_format, record_length, records.size() / record_length, 0};
  }
  [[nodiscard]] std::vector<std::byte> laszip_record() const;
  /// The point data of a file, at offset `data_offset` of it.
  [[nodiscard]] std::vector<std::byte> point_data(std::span<const std::byte> records, size_t data_offset = 0) const;

 private:
  [[nodiscard]] Coding coding() const;
};

}  // namespace surfcast::laz::testing
