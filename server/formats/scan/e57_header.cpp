#include "scan/e57_header.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/ascii_text.h"
#include "base/invalid_input.h"
#include "scan/text_tokens.h"
#include "scan/xml_tree.h"

namespace surfcast::scan {
namespace {

/// A number in an attribute. Missing or empty: `otherwise`.
template <typename T>
Result<T> attribute_of(const XmlNode& node, std::string_view attribute, T otherwise) {
  const std::string* text = node.attribute(attribute);
  if (text == nullptr || trimmed(*text).empty()) return otherwise;
  const std::optional<T> number = parse_number<T>(trimmed(*text));
  if (number) return *number;
  return invalid_input("E57 element " + printable(node.name) + ": not a number: " + printable(*text));
}

/// The number that is the text of a child. Missing, empty or not a number: `otherwise`.
double child_number(const XmlNode& node, std::string_view name, double otherwise) {
  const XmlNode* child = node.child(name);
  if (child == nullptr) return otherwise;
  const double number = parse_number<double>(trimmed(child->text)).value_or(otherwise);
  return std::isfinite(number) ? number : otherwise;
}

Status read_limits(const XmlNode& node, E57Field& field) {
  using Limits = std::numeric_limits<int64_t>;
  const Result<int64_t> low = attribute_of<int64_t>(node, "minimum", Limits::min());
  const Result<int64_t> high = attribute_of<int64_t>(node, "maximum", Limits::max());
  if (!low) return fail(low);
  if (!high) return fail(high);
  if (*low > *high) return invalid_input("E57 field " + printable(node.name) + " has a minimum above its maximum");
  field.minimum = *low;
  field.maximum = *high;
  field.bits = static_cast<int>(std::bit_width(static_cast<uint64_t>(*high) - static_cast<uint64_t>(*low)));
  return {};
}

Status read_scale(const XmlNode& node, E57Field& field) {
  const Result<double> scale = attribute_of<double>(node, "scale", 1);
  const Result<double> offset = attribute_of<double>(node, "offset", 0);
  if (!scale) return fail(scale);
  if (!offset) return fail(offset);
  field.scale = *scale;
  field.offset = *offset;
  return {};
}

Result<E57Field> parse_field(const XmlNode& node) {
  E57Field field;
  field.name = node.name;
  const std::string* type = node.attribute("type");
  const std::string* precision = node.attribute("precision");
  if (type != nullptr && *type == "Float") {
    const bool single = precision != nullptr && *precision == "single";
    field.coding = single ? E57Coding::kFloat : E57Coding::kDouble;
    field.bits = single ? 32 : 64;
    return field;
  }
  if (type != nullptr && *type == "String") {
    field.coding = E57Coding::kString;
    return field;
  }
  const bool scaled = type != nullptr && *type == "ScaledInteger";
  if (type == nullptr || (!scaled && *type != "Integer")) {
    return fail(ErrorKind::kUnsupported, "E57 field " + printable(node.name) + " has a type that is not supported");
  }
  field.coding = scaled ? E57Coding::kScaled : E57Coding::kInteger;
  if (Status status = read_limits(node, field); !status) return fail(status);
  if (Status status = scaled ? read_scale(node, field) : Status(); !status) return fail(status);
  return field;
}

/// The rotation of a quaternion of any length but zero.
glm::dmat3 rotation_of(double w, double x, double y, double z) {
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(length > 0)) return glm::dmat3(1);
  w /= length, x /= length, y /= length, z /= length;
  glm::dmat3 matrix;
  matrix[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
  matrix[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
  matrix[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
  return matrix;
}

/// Missing parts are those of the identity.
E57Pose parse_pose(const XmlNode& node) {
  E57Pose pose;
  if (const XmlNode* turn = node.child("rotation")) {
    pose.rotation = rotation_of(child_number(*turn, "w", 0), child_number(*turn, "x", 0), child_number(*turn, "y", 0),
                                child_number(*turn, "z", 0));
  }
  if (const XmlNode* shift = node.child("translation")) {
    pose.translation = {child_number(*shift, "x", 0), child_number(*shift, "y", 0), child_number(*shift, "z", 0)};
  }
  return pose;
}

/// The stated limits, or those of the fields.
std::pair<double, double> color_limits(const XmlNode& node, const E57Scan& scan) {
  std::pair<double, double> limits{0, 255};
  const std::optional<size_t> red = scan.field("colorRed");
  if (red && scan.fields[*red].coding == E57Coding::kInteger) {
    limits = {static_cast<double>(scan.fields[*red].minimum), static_cast<double>(scan.fields[*red].maximum)};
  }
  if (const XmlNode* stated = node.child("colorLimits")) {
    limits = {child_number(*stated, "colorRedMinimum", 0), child_number(*stated, "colorRedMaximum", limits.second)};
  }
  return limits.second > limits.first ? limits : std::pair<double, double>{0, 255};
}

Result<E57Scan> parse_scan(const XmlNode& node) {
  const XmlNode* points = node.child("points");
  const XmlNode* prototype = points == nullptr ? nullptr : points->child("prototype");
  if (prototype == nullptr) return invalid_input("an E57 scan has no points");
  E57Scan scan;
  if (const XmlNode* name = node.child("name")) scan.name = printable(name->text);
  const Result<uint64_t> section = attribute_of<uint64_t>(*points, "fileOffset", 0);
  const Result<uint64_t> count = attribute_of<uint64_t>(*points, "recordCount", 0);
  if (!section) return fail(section);
  if (!count) return fail(count);
  scan.section = *section;
  scan.count = *count;
  for (const XmlNode& child : prototype->children) {
    Result<E57Field> field = parse_field(child);
    if (!field) return fail(field);
    scan.fields.push_back(std::move(*field));
  }
  if (const XmlNode* pose = node.child("pose")) scan.pose = parse_pose(*pose);
  scan.color_limits = color_limits(node, scan);
  return scan;
}

Result<XmlNode> read_xml(const E57Pages& pages) {
  const Result<uint64_t> at = pages.logical(pages.xml_offset());
  if (!at) return fail(at);
  if (pages.xml_size() > pages.size() - *at) return invalid_input("truncated: the E57 file ends within its XML");
  std::vector<std::byte> bytes(pages.xml_size());
  if (Status status = pages.read(*at, bytes); !status) return fail(status);
  return parse_xml(as_text(bytes));
}

}  // namespace

std::optional<size_t> E57Scan::field(std::string_view wanted) const {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [wanted](const E57Field& field) { return field.name == wanted; });
  if (found == fields.end() || found->coding == E57Coding::kString) return std::nullopt;
  return static_cast<size_t>(found - fields.begin());
}

Result<E57Header> parse_e57_header(const E57Pages& pages) {
  const Result<XmlNode> root = read_xml(pages);
  if (!root) return fail(root);
  E57Header header;
  if (const XmlNode* metadata = root->child("coordinateMetadata")) header.crs = trimmed(metadata->text);
  if (const XmlNode* images = root->child("images2D")) header.images = images->children.size();
  const XmlNode* scans = root->child("data3D");
  for (size_t i = 0; scans != nullptr && i < scans->children.size(); ++i) {
    Result<E57Scan> scan = parse_scan(scans->children[i]);
    if (!scan) return fail(scan);
    if (scan->count > 0) header.scans.push_back(std::move(*scan));
  }
  return header;
}

}  // namespace surfcast::scan
