#pragma once

#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "scan/bytes.h"
#include "scan/crc32c.h"
#include "scan/e57_file.h"

namespace surfcast::testing {

template <typename T>
std::string raw(std::initializer_list<T> values) {
  Bytes bytes;
  for (const T value : values) bytes.add(value);
  return bytes.text();
}

inline std::string scan_xml(size_t section, size_t count, const std::string& fields, const std::string& more = {}) {
  return "<vectorChild type='Structure'>" + more + "<points type='CompressedVector' fileOffset='" +
         std::to_string(section) + "' recordCount='" + std::to_string(count) + "'><prototype type='Structure'>" +
         fields + "</prototype></points></vectorChild>";
}

inline std::string root_xml(const std::string& scans, const std::string& more = {}) {
  return "<?xml version='1.0' encoding='UTF-8'?><e57Root type='Structure'>" + more + "<data3D type='Vector'>" + scans +
         "</data3D></e57Root>";
}

inline constexpr const char* kCartesian =
    "<cartesianX type='Float'/><cartesianY type='Float'/><cartesianZ type='Float' precision='single'/>";
inline constexpr const char* kPose =
    "<pose><rotation><w>0.7071067811865476</w><x/><y/><z>0.7071067811865476</z></rotation>"
    "<translation><x>100</x><y>200</y><z>300</z></translation></pose>";

/// A scan whose integers of 19 bits run on from packet to packet, turned by 90 degrees and moved; and a scan in
/// spherical coordinates without colours.
inline std::string two_scans() {
  std::vector<uint64_t> xs, colors;
  for (uint64_t i = 0; i < 40; ++i) xs.push_back(200000 + 10 * i), colors.push_back(i * 1000);
  const std::string x = packed(xs, 19), y = packed(std::vector<uint64_t>(40, 200100), 19);
  const std::string state = packed({0, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                                    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                   2);
  const std::string color = packed(colors, 16);
  E57File file;
  const size_t first =
      file.add_points({{x.substr(0, 33), y.substr(0, 50), y, state, color.substr(0, 7), "", color, color},
                       {x.substr(33), y.substr(50), "", "", color.substr(7), "", "", ""}});
  const std::string field = " type='ScaledInteger' minimum='-200000' maximum='324287' scale='0.5' offset='1'/>";
  const std::string of_color = " type='Integer' minimum='0' maximum='65535'/>";
  const std::string fields = "<cartesianX" + field + "<cartesianY" + field + "<cartesianZ" + field +
                             "<cartesianInvalidState type='Integer' minimum='0' maximum='2'/><colorRed" + of_color +
                             "<rowIndex type='Integer' minimum='7' maximum='7'/><colorGreen" + of_color + "<colorBlue" +
                             of_color;
  const double half_turn = std::acos(-1.0);
  const size_t second = file.add_points({{raw({2.0, 3.0}), raw({0.0, half_turn}), raw({half_turn / 2, 0.0})}});
  const std::string spherical =
      "<sphericalRange type='Float'/><sphericalAzimuth type='Float'/><sphericalElevation type='Float'/>";
  return file.text(root_xml(scan_xml(first, 40, fields, kPose) + scan_xml(second, 2, spherical),
                            "<coordinateMetadata type='String'>EPSG:32632</coordinateMetadata>"));
}

/// The checksum of the page at `at`, made right again.
inline void mend(std::string& file, size_t at) {
  const uint32_t sum = scan::crc32c(as_bytes(std::string_view(file).substr(at, E57File::kPage - 4)));
  file.replace(at + E57File::kPage - 4, 4, Bytes().add(sum, true).text());
}

}  // namespace surfcast::testing
