#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/byte_source.h"
#include "base/result.h"

namespace surfcast::model {

/// A coordinate reference system, as a model file states it.
struct CoordinateSystem {
  std::string name;  ///< "ETRS89 / UTM zone 32N"
  std::string id;    ///< "EPSG:25832"; empty if no authority has it
  std::string wkt;   ///< WKT 2 (ISO 19162:2019)

  [[nodiscard]] bool known() const { return !wkt.empty(); }
  bool operator==(const CoordinateSystem&) const = default;
};

/// Where on the earth a model lies.
struct Georeference {
  CoordinateSystem system;  ///< of the positions in the file, with easting first; not known: none was stated
  CoordinateSystem source;  ///< in which people state places, longitude first; not known: in `system`, too

  [[nodiscard]] bool known() const { return system.known(); }
  bool operator==(const Georeference&) const = default;
};

/// The bytes of a georeference in a file: a checksum and six strings.
std::vector<std::byte> write_georeference(const Georeference& georeference);
Result<Georeference> read_georeference(std::span<const std::byte> bytes);

/// The georeference of a model file; not known if the file states none. It is read apart from the rest of the file,
/// because drawing does without it.
Result<Georeference> load_georeference(const std::filesystem::path& path);
Result<Georeference> load_georeference(const ByteSource& source);

}  // namespace surfcast::model
