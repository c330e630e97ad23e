#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "base/atomic_file.h"
#include "base/json_text.h"
#include "exporter/even_sample.h"
#include "exporter/las_bytes.h"
#include "exporter/new_folder.h"
#include "exporter/node_pages.h"
#include "exporter/octree_files.h"
#include "scan/json_access.h"
#include "scan/las_reader.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;
using scan::Json;

constexpr size_t kPositionBytes = 12;
constexpr size_t kEntryBytes = 22;  // of a node in hierarchy.bin
/// Levels of a page of the hierarchy as Potree writes them; its readers go by the links in the pages.
constexpr int kStepSize = 4;

enum class NodeType : uint8_t { kInner = 0, kLeaf = 1, kLink = 2 };

/// An attribute of all points, of one or more columns of the records.
struct Attribute {
  std::string name;
  scan::ScalarType type;
  size_t first = 0;  ///< number of its first column
  size_t elements = 1;

  [[nodiscard]] size_t bytes() const { return elements * scan::size_of(type); }
};

/// The names of Potree for the fields of LAS.
std::string attribute_name(std::string column) {
  if (column == "gps_time") return "gps-time";
  std::ranges::replace(column, '_', ' ');
  return column;
}

/// All columns but the coordinates. The three of the colour are one attribute.
std::vector<Attribute> attributes_of(const std::vector<scan::ColumnInfo>& columns) {
  std::vector<Attribute> attributes;
  for (size_t i = 3; i < columns.size(); ++i) {
    const scan::ColumnInfo& column = columns[i];
    if (column.name == "red" && column.reserved) {
      attributes.push_back({"rgb", column.type, i, 3});
      i += 2;
      continue;
    }
    attributes.push_back({column.reserved ? attribute_name(column.name) : column.name, column.type, i});
  }
  return attributes;
}

std::string type_name(scan::ScalarType type) {
  if (scan::is_floating(type)) return scan::size_of(type) == sizeof(float) ? "float" : "double";
  const bool is_signed = scan::with_type(type, [](auto zero) { return std::is_signed_v<decltype(zero)>; });
  return (is_signed ? "int" : "uint") + std::to_string(8 * scan::size_of(type));
}

/// The least and the largest value of a column.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// A node whose points are in octree.bin.
struct WrittenNode {
  uint64_t points = 0;
  uint64_t offset = 0;
  uint64_t bytes = 0;
};

/// Numbers of nodes by their places.
using NodeNumbers = std::map<std::array<uint32_t, 4>, size_t>;

std::array<uint32_t, 4> place_of(const ldc::OctreeKey& key) {
  return {key.depth, key.x, key.y, key.z};
}

/// The octant of Potree's digit: bit 2 is x, bit 1 y, bit 0 z.
ldc::OctreeKey child_of_digit(const ldc::OctreeKey& key, uint32_t digit) {
  return key.child((digit >> 2 & 1) | (digit & 2) | (digit & 1) << 2);
}

/// Numbers of the children of a node, by Potree's digits.
using Children = std::array<std::optional<size_t>, 8>;

uint8_t mask_of(const Children& children) {
  uint32_t mask = 0;
  for (size_t digit = 0; digit < children.size(); ++digit) mask |= uint32_t{children[digit].has_value()} << digit;
  return static_cast<uint8_t>(mask);
}

class PotreeFolder : public NodeBatch {
 public:
  PotreeFolder(NewFolder folder, AtomicFile points, LasHead head, uint64_t most_bytes, size_t most_entries)
      : NodeBatch(most_bytes),
        folder_(std::move(folder)),
        file_(std::move(points)),
        record_length_(head.record_length),
        header_(header_of(std::move(head))),
        columns_(scan::las_columns(header_)),
        attributes_(attributes_of(columns_)),
        ranges_(columns_.size()),
        most_entries_(most_entries) {}

  Result<uint64_t> finish(const OctreeFacts& facts) override {
    Status status = write_waiting();
    uint64_t bytes = file_.position();
    if (status) status = file_.commit_unflushed();
    if (!status) return fail(status);
    const Bytes hierarchy = hierarchy_of_nodes();
    const std::string text = json_text(description(facts), 1);
    status = folder_.write("hierarchy.bin", hierarchy);
    if (status) status = folder_.write("metadata.json", std::as_bytes(std::span(text)));
    if (status) status = folder_.put_in_place();
    if (!status) return fail(status);
    bytes += hierarchy.size() + text.size();
    return bytes;
  }

 private:
  Status write(std::vector<OctreeNode> nodes) override {
    std::vector<Bytes> rows(nodes.size());
    std::vector<std::vector<Range>> ranges(nodes.size(), std::vector<Range>(columns_.size()));
    oneapi::tbb::parallel_for(size_t{0}, nodes.size(),
                              [&](size_t i) { rows[i] = rows_of(nodes[i].records, ranges[i]); });
    for (size_t i = 0; i < nodes.size(); ++i) {
      for (size_t column = 0; column < columns_.size(); ++column) {
        ranges_[column].low = std::min(ranges_[column].low, ranges[i][column].low);
        ranges_[column].high = std::max(ranges_[column].high, ranges[i][column].high);
      }
      keys_.push_back(nodes[i].key);
      nodes_.push_back({nodes[i].records.size() / record_length_, file_.position(), rows[i].size()});
      if (Status status = file_.append(rows[i]); !status) return status;
    }
    return {};
  }

  /// Points in the encoding DEFAULT: one after another, each with its position on the lattice and its attributes.
  [[nodiscard]] Bytes rows_of(const Bytes& records, std::vector<Range>& ranges) const {
    const size_t count = records.size() / record_length_;
    const scan::PointTable table = scan::las_table(records.data(), count, header_);
    size_t stride = kPositionBytes;
    for (const Attribute& attribute : attributes_) stride += attribute.bytes();
    Bytes rows(count * stride);
    for (size_t i = 0; i < count; ++i) std::memcpy(&rows[i * stride], &records[i * record_length_], kPositionBytes);
    size_t at = kPositionBytes;
    for (const Attribute& attribute : attributes_) {
      for (size_t k = 0; k < attribute.elements; ++k, at += scan::size_of(attribute.type)) {
        Range& range = ranges[attribute.first + k];
        scan::for_each_value(table.columns[attribute.first + k], count, [&](size_t i, auto value) {
          std::memcpy(&rows[i * stride + at], &value, sizeof(value));
          range.include(static_cast<double>(value));
        });
      }
    }
    return rows;
  }

  /// The pages one after another, that of the root first. A page has its nodes breadth first, and links to the pages
  /// of nodes that are in others.
  [[nodiscard]] Bytes hierarchy_of_nodes() {
    const std::vector<NodePage> pages = make_pages(keys_, most_entries_);
    NodeNumbers numbers;
    for (size_t i = 0; i < keys_.size(); ++i) numbers[place_of(keys_[i])] = i;
    std::vector<size_t> page_of_top(keys_.size(), 0);  // of the topmost node of another page than the first
    std::vector<uint64_t> offsets{0};
    for (size_t i = 0; i < pages.size(); ++i) {
      page_of_top[pages[i].nodes.front()] = i;
      offsets.push_back(offsets.back() + kEntryBytes * (pages[i].nodes.size() + pages[i].subpages.size()));
    }
    first_page_bytes_ = offsets[1];
    Bytes hierarchy;
    for (const NodePage& page : pages) {
      std::vector<size_t> queue{page.nodes.front()};
      for (size_t next = 0; next < queue.size(); ++next) {
        const size_t node = queue[next];
        const Children children = children_of(node, numbers);
        const size_t own_page = next == 0 ? 0 : page_of_top[node];
        for (const std::optional<size_t>& child : children) {
          if (own_page == 0 && child) queue.push_back(*child);
        }
        add_entry(node, children, own_page, offsets, hierarchy);
      }
    }
    return hierarchy;
  }

  [[nodiscard]] Children children_of(size_t node, const NodeNumbers& numbers) const {
    Children children{};
    for (uint32_t digit = 0; digit < 8; ++digit) {
      const auto child = numbers.find(place_of(child_of_digit(keys_[node], digit)));
      if (child != numbers.end()) children[digit] = child->second;
    }
    return children;
  }

  /// `page`: of the node, if it is another one; 0: it is in this one.
  void add_entry(size_t node, const Children& children, size_t page, const std::vector<uint64_t>& offsets,
                 Bytes& hierarchy) const {
    const WrittenNode& written = nodes_[node];
    const uint8_t mask = mask_of(children);
    const NodeType type = page != 0 ? NodeType::kLink : mask == 0 ? NodeType::kLeaf : NodeType::kInner;
    add(hierarchy, static_cast<uint8_t>(type));
    add(hierarchy, mask);
    add(hierarchy, static_cast<uint32_t>(written.points));
    add(hierarchy, page != 0 ? offsets[page] : written.offset);
    add(hierarchy, page != 0 ? offsets[page + 1] - offsets[page] : written.bytes);
  }

  [[nodiscard]] Json description(const OctreeFacts& facts) const {
    const auto numbers = [](const glm::dvec3& p) { return Json{p.x, p.y, p.z}; };
    const geometry::Box bounds = bounds_of(header_.grid, facts.counts);
    Json position = attribute_json("position", scan::ScalarType::kInt32, 3);
    position["min"] = numbers(bounds.min);
    position["max"] = numbers(bounds.max);
    Json attributes = Json::array({std::move(position)});
    for (const Attribute& attribute : attributes_) {
      Json json = attribute_json(attribute.name, attribute.type, attribute.elements);
      for (size_t k = 0; k < attribute.elements; ++k) {
        json["min"].push_back(ranges_[attribute.first + k].low);
        json["max"].push_back(ranges_[attribute.first + k].high);
      }
      attributes.push_back(std::move(json));
    }
    int depth = 0;
    for (const ldc::OctreeKey& key : keys_) depth = std::max(depth, int{key.depth});
    return {{"version", "2.0"},
            {"name", folder_.name()},
            {"description", ""},
            {"points", facts.counts.points},
            {"projection", header_.crs},
            {"hierarchy", {{"firstChunkSize", first_page_bytes_}, {"stepSize", kStepSize}, {"depth", depth}}},
            {"offset", numbers(header_.grid.offset)},
            {"scale", numbers(header_.grid.scale)},
            {"spacing", facts.cube.side * kSampleSpacing},
            {"boundingBox", {{"min", numbers(facts.cube.min)}, {"max", numbers(facts.cube.min + facts.cube.side)}}},
            {"encoding", "DEFAULT"},
            {"attributes", attributes}};
  }

  static Json attribute_json(const std::string& name, scan::ScalarType type, size_t elements) {
    return {{"name", name},
            {"description", ""},
            {"size", elements * scan::size_of(type)},
            {"numElements", elements},
            {"elementSize", scan::size_of(type)},
            {"type", type_name(type)},
            {"min", Json::array()},
            {"max", Json::array()}};
  }

  NewFolder folder_;
  AtomicFile file_;  ///< octree.bin
  size_t record_length_;
  scan::LasHeader header_;
  std::vector<scan::ColumnInfo> columns_;
  std::vector<Attribute> attributes_;
  std::vector<Range> ranges_;  ///< of the columns
  size_t most_entries_;
  std::vector<ldc::OctreeKey> keys_;
  std::vector<WrittenNode> nodes_;
  uint64_t first_page_bytes_ = 0;
};

}  // namespace

Result<std::unique_ptr<NodeBatch>> create_potree(const fs::path& target, LasHead head, uint64_t most_bytes,
                                                 size_t most_entries) {
  Result<NewFolder> folder = NewFolder::create(target);
  if (!folder) return fail(folder);
  Result<AtomicFile> points = AtomicFile::create(folder->unfinished() / "octree.bin");
  if (!points) return fail(points);
  return std::make_unique<PotreeFolder>(std::move(*folder), std::move(*points), std::move(head), most_bytes,
                                        most_entries);
}

}  // namespace surfcast::exporter
