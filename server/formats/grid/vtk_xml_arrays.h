#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/result.h"
#include "grid/vtk_arrays.h"
#include "grid/vtk_numbers.h"
#include "grid/vtk_xml_tree.h"
#include "scan/scalar_type.h"

namespace surfcast::grid {

/// The first and the last index of points along each axis.
struct VtkExtent {
  std::array<int64_t, 3> first{};
  std::array<int64_t, 3> last{};

  bool operator==(const VtkExtent&) const = default;
  /// Points along each axis.
  [[nodiscard]] std::array<uint64_t, 3> points() const;
};

/// "FIRST LAST FIRST LAST FIRST LAST"; an extent has a point at least.
Result<VtkExtent> parse_vtk_extent(std::string_view text);

/// What the attributes of an array and those of its section state.
VtkArray facts_of(const XmlFile& file, const XmlArray& array);

Result<scan::ScalarType> xml_type_of(const XmlArray& array);

/// The numbers of an array: as text, base64 or appended, as they are or compressed by zlib.
Result<StoredNumbers> find_numbers(const XmlFile& file, const XmlArray& array, const stream::FilePtr& source,
                                   uint64_t values);

}  // namespace surfcast::grid
