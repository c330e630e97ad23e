#include "protocol/profile_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace surfcast::protocol {
namespace {

using Column = google::protobuf::RepeatedField<double>;

/// The shortest text that is read back as the same number.
void append_number(double value, std::string& text) {
  if (!std::isfinite(value)) return;
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

/// Quoted where the text has a character with a meaning.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_header(const wire::Profile& profile) {
  std::string text = "x,y,z,along,across";
  if (profile.color_bits() > 0) text += ",red,green,blue";
  for (const wire::AttributeColumn& attribute : profile.attributes()) text += "," + csv_field(attribute.attribute());
  return text + "\r\n";
}

// ---- LAS 1.4 ----

constexpr size_t kHeaderBytes = 375;       // table 3
constexpr size_t kVariableHeader = 54;     // table 6
constexpr size_t kExtraDescription = 192;  // table 24
constexpr uint8_t kExtraDouble = 10;       // table 25
constexpr uint16_t kExtraRecord = 4;

template <typename T>
void put(std::string& bytes, size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

/// A field of point formats 6 and 7 (table 15), of whole numbers: bits of one byte, or whole bytes.
struct LasField {
  const char* name;
  size_t offset;
  int bytes = 1;
  int shift = 0;
  double least = 0;
  double largest = 255;
};
constexpr std::array kLasFields{
    LasField{"intensity", 12, 2, 0, 0, 65535},
    LasField{"return_number", 14, 1, 0, 0, 15},
    LasField{"number_of_returns", 14, 1, 4, 0, 15},
    LasField{"classification_flags", 15, 1, 0, 0, 15},
    LasField{"scanner_channel", 15, 1, 4, 0, 3},
    LasField{"scan_direction_flag", 15, 1, 6, 0, 1},
    LasField{"edge_of_flight_line", 15, 1, 7, 0, 1},
    LasField{"classification", 16},
    LasField{"user_data", 17},
    LasField{"scan_angle", 18, 2, 0, -32768, 32767},
    LasField{"point_source_id", 20, 2, 0, 0, 65535},
};
constexpr size_t kGpsTime = 22;
constexpr size_t kColor = 30;

const LasField* las_field(const std::string& name) {
  const auto found =
      std::find_if(kLasFields.begin(), kLasFields.end(), [&](const LasField& field) { return field.name == name; });
  return found == kLasFields.end() ? nullptr : &*found;
}

/// The lattice of one axis in a file.
struct Axis {
  double scale = 1;
  double offset = 0;
  double low = 0;
  double high = 0;

  [[nodiscard]] double step_of(double value) const { return std::round((value - offset) / scale); }
};

/// The profile's lattice if 32 bits hold the indices, if need be from its lowest point on; else a coarser one.
Axis axis_of(const Column& values, double scale, double offset) {
  Axis axis{scale > 0 ? scale : 1, offset, 0, 0};
  if (values.empty()) return axis;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  axis.low = *low;
  axis.high = *high;
  constexpr double kMax = std::numeric_limits<int32_t>::max();
  const auto fits = [&] { return std::abs(axis.step_of(axis.low)) < kMax && std::abs(axis.step_of(axis.high)) < kMax; };
  if (fits()) return axis;
  axis.offset += axis.step_of(axis.low) * axis.scale;
  if (fits()) return axis;
  axis.offset = axis.low;
  axis.scale = (axis.high - axis.low) / (kMax - 1);
  return axis;
}

/// The layout of a file.
struct LasLayout {
  std::array<Axis, 3> axes;
  bool colored = false;
  std::vector<const wire::AttributeColumn*> extra;  ///< attributes without a field of their own

  [[nodiscard]] size_t core_bytes() const { return colored ? 36 : 30; }
  [[nodiscard]] size_t record_bytes() const { return core_bytes() + sizeof(double) * extra.size(); }
  [[nodiscard]] size_t extra_bytes() const {
    return extra.empty() ? 0 : kVariableHeader + kExtraDescription * extra.size();
  }
};

LasLayout layout_of(const wire::Profile& profile) {
  LasLayout layout;
  layout.axes = {axis_of(profile.x(), profile.scale().x(), profile.offset().x()),
                 axis_of(profile.y(), profile.scale().y(), profile.offset().y()),
                 axis_of(profile.z(), profile.scale().z(), profile.offset().z())};
  layout.colored = profile.color_bits() > 0;
  // A record's length has 16 bits, and so has that of the descriptions.
  constexpr size_t kMaxExtra = std::numeric_limits<uint16_t>::max() / kExtraDescription;
  for (const wire::AttributeColumn& attribute : profile.attributes()) {
    const bool known = las_field(attribute.attribute()) != nullptr || attribute.attribute() == "gps_time";
    if (!known && layout.extra.size() < kMaxExtra) layout.extra.push_back(&attribute);
  }
  return layout;
}

std::string las_header(const LasLayout& layout, uint64_t count) {
  std::string header(kHeaderBytes, '\0');
  header.replace(0, 4, "LASF");
  put(header, 6, uint16_t{16});  // coordinate systems are WKT, as formats from 6 on demand
  put(header, 24, uint8_t{1});
  put(header, 25, uint8_t{4});
  header.replace(58, 8, "surfcast");
  put(header, 94, static_cast<uint16_t>(kHeaderBytes));
  put(header, 96, static_cast<uint32_t>(kHeaderBytes + layout.extra_bytes()));
  put(header, 100, uint32_t{layout.extra.empty() ? 0U : 1U});
  put(header, 104, static_cast<uint8_t>(layout.colored ? 7 : 6));
  put(header, 105, static_cast<uint16_t>(layout.record_bytes()));
  for (size_t i = 0; i < layout.axes.size(); ++i) {
    const Axis& axis = layout.axes[i];
    put(header, 131 + 8 * i, axis.scale);
    put(header, 155 + 8 * i, axis.offset);
    put(header, 179 + 16 * i, axis.high);
    put(header, 187 + 16 * i, axis.low);
  }
  put(header, 247, count);
  return header;
}

/// The record that names the extra bytes.
std::string extra_bytes_record(const LasLayout& layout) {
  if (layout.extra.empty()) return {};
  std::string record(layout.extra_bytes(), '\0');
  record.replace(2, 9, "LASF_Spec");
  put(record, 18, kExtraRecord);
  put(record, 20, static_cast<uint16_t>(kExtraDescription * layout.extra.size()));
  for (size_t i = 0; i < layout.extra.size(); ++i) {
    const size_t at = kVariableHeader + i * kExtraDescription;
    put(record, at + 2, kExtraDouble);
    const std::string name = layout.extra[i]->attribute().substr(0, 31);
    record.replace(at + 4, name.size(), name);
  }
  return record;
}

/// Sets a whole number, clamped to the range of its field.
void put_field(const LasField& field, double value, std::string& record) {
  const double whole = std::isfinite(value) ? std::clamp(std::round(value), field.least, field.largest) : 0;
  const auto bits = static_cast<uint16_t>(static_cast<int32_t>(whole));
  if (field.bytes == 2) return put(record, field.offset, bits);
  record[field.offset] = static_cast<char>(static_cast<uint8_t>(record[field.offset]) | bits << field.shift);
}

void put_attributes(const wire::Profile& profile, int point, std::string& record) {
  for (const wire::AttributeColumn& attribute : profile.attributes()) {
    const double value = attribute.values(point);
    if (attribute.attribute() == "gps_time") put(record, kGpsTime, value);
    const LasField* field = las_field(attribute.attribute());
    if (field != nullptr) put_field(*field, value, record);
  }
}

std::string las_record(const wire::Profile& profile, const LasLayout& layout, int point) {
  std::string record(layout.record_bytes(), '\0');
  const std::array<double, 3> position{profile.x(point), profile.y(point), profile.z(point)};
  for (size_t i = 0; i < 3; ++i) put(record, 4 * i, static_cast<int32_t>(layout.axes[i].step_of(position[i])));
  put_attributes(profile, point, record);
  if (layout.colored) {
    const uint32_t factor = profile.color_bits() == 8 ? 257 : 1;
    const std::array<uint32_t, 3> color{profile.red(point), profile.green(point), profile.blue(point)};
    for (size_t i = 0; i < 3; ++i) put(record, kColor + 2 * i, static_cast<uint16_t>(color[i] * factor));
  }
  for (size_t i = 0; i < layout.extra.size(); ++i) {
    put(record, layout.core_bytes() + 8 * i, layout.extra[i]->values(point));
  }
  return record;
}

}  // namespace

std::string profile_csv(const wire::Profile& profile) {
  std::string text = csv_header(profile);
  const auto number = [&text](double value) {
    text += ',';
    append_number(value, text);
  };
  for (int i = 0; i < profile.x_size(); ++i) {
    append_number(profile.x(i), text);
    for (const double value : {profile.y(i), profile.z(i), profile.along(i), profile.across(i)}) number(value);
    if (profile.color_bits() > 0) {
      for (const uint32_t value : {profile.red(i), profile.green(i), profile.blue(i)}) number(value);
    }
    for (const wire::AttributeColumn& attribute : profile.attributes()) number(attribute.values(i));
    text += "\r\n";
  }
  return text;
}

std::string profile_las(const wire::Profile& profile) {
  const LasLayout layout = layout_of(profile);
  std::string file = las_header(layout, static_cast<uint64_t>(profile.x_size())) + extra_bytes_record(layout);
  file.reserve(file.size() + layout.record_bytes() * static_cast<size_t>(profile.x_size()));
  for (int i = 0; i < profile.x_size(); ++i) file += las_record(profile, layout, i);
  return file;
}

std::string profile_file(const wire::Profile& profile, ProfileFormat format) {
  return format == ProfileFormat::kLas ? profile_las(profile) : profile_csv(profile);
}

std::string_view media_type(ProfileFormat format) {
  return format == ProfileFormat::kLas ? "application/vnd.las" : "text/csv; charset=utf-8";
}

std::string_view extension_of(ProfileFormat format) {
  return format == ProfileFormat::kLas ? "las" : "csv";
}

}  // namespace surfcast::protocol
