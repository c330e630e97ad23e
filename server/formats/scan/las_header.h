#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "scan/scalar_type.h"
#include "surfel/grid.h"

namespace surfcast::scan {

/// A per-point value that a LAS file declares in addition to its point format (LAS 1.4, table 24 "extra bytes").
struct LasExtraField {
  std::string name;
  ScalarType type = ScalarType::kUint8;
  size_t offset = 0;  ///< within the point record
  double scale = 1;   ///< value = raw * scale + shift
  double shift = 0;
};

/// The contents of the header and the variable length records of a LAS file that are needed to read the points.
struct LasHeader {
  int minor_version = 2;
  int point_format = 0;  ///< 0 to 10
  bool compressed = false;
  std::span<const std::byte> laszip_record;  ///< a part of the file: the coding of compressed points
  std::span<const std::byte> copc_record;    ///< a part of the file: where its hierarchy lies; empty if it is not COPC
  size_t record_length = 0;
  size_t data_offset = 0;
  uint64_t count = 0;
  surfel::Grid grid;
  std::string crs;  ///< coordinate system: WKT, or "EPSG:code" of GeoKeys; empty without
  std::vector<LasExtraField> extra_fields;
};

/// A record between the header and the points, or behind them, as a part of the file.
struct LasVariableRecord {
  std::string_view user;  ///< without its padding
  uint16_t id = 0;
  std::span<const std::byte> head;  ///< 54 bytes, or 60 of an extended record
  std::span<const std::byte> body;
};

/// All variable length records of a file with this header, as far as they lie before the points.
std::vector<LasVariableRecord> las_variable_records(std::span<const std::byte> bytes, const LasHeader& header);

/// All extended variable length records, as far as they lie within the file.
std::vector<LasVariableRecord> las_extended_records(std::span<const std::byte> bytes, const LasHeader& header);

/// Parses and checks the header. On success all `count` records lie within the file, unless they are compressed. Fails
/// with kInvalidInput or kUnsupported.
Result<LasHeader> parse_las_header(std::span<const std::byte> bytes);

/// Bytes of a point record of this format, without extra bytes.
size_t las_record_length(int point_format);

}  // namespace surfcast::scan
