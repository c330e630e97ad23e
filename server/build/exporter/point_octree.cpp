#include "exporter/point_octree.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "base/hash.h"
#include "exporter/node_sample.h"
#include "exporter/record_parts.h"
#include "exporter/record_places.h"

namespace surfcast::exporter {
namespace {

using ldc::OctreeKey;
using Bytes = std::vector<std::byte>;

/// Where a point lies, and what tells it from others there. Both are the same in whatever order points come.
struct PointKey {
  uint64_t code = 0;
  uint64_t hash = 0;  ///< of its record

  friend bool operator<(const PointKey& a, const PointKey& b) {
    return a.code != b.code ? a.code < b.code : a.hash < b.hash;
  }
};

/// Points in the order of their keys, and their records.
struct SortedPoints {
  std::vector<PointKey> keys;
  Bytes records;
};

/// A node in memory and those below it.
struct PartNode {
  OctreeKey key;
  std::vector<uint32_t> points;  ///< numbers of points of the part, in ascending order
  std::vector<PartNode> children;
};

/// A cell whose nodes are written, but for its own: the node above it may take points of it.
struct OpenCell {
  OctreeKey key;
  SortedPoints points;
  bool has_nodes = false;  ///< below it
};

class OctreeDivider {
 public:
  OctreeDivider(const LasHead& head, const geometry::RootCube& cube, const OctreeOptions& options, NodeWriter& writer)
      : places_(head, cube),
        record_bytes_(head.record_length),
        options_(within_limits(options)),
        writer_(writer),
        parts_(places_, {std::max(options_.leaf_points, options_.memory / 4 / record_bytes_), kDeepestNode}) {}

  Status write(RecordSpool& spool, const std::filesystem::path& target) {
    if (Status status = parts_.divide(spool, target); !status) return status;
    Result<OpenCell> root = write_below({}, 0, parts().size());
    if (!root) return fail(root);
    return write_node(root->key, std::move(root->points.records));
  }

 private:
  /// Nodes with others below them have as many points as node_sample needs.
  static OctreeOptions within_limits(OctreeOptions options) {
    options.leaf_points = std::max<uint64_t>(options.leaf_points, kDeepestNode + 1);
    return options;
  }
  [[nodiscard]] const std::vector<RecordPart>& parts() const { return parts_.parts(); }

  // Cells that are made of several parts.

  /// Writes the nodes below a cell.
  Result<OpenCell> write_below(const OctreeKey& key, size_t first_part, size_t last_part) {
    if (parts()[first_part].key == key) return write_part(first_part);
    std::vector<OpenCell> children;
    const uint64_t step = codes_of_cell(key.depth + 1);
    const uint64_t first = parts()[first_part].first / codes_of_cell(key.depth) * codes_of_cell(key.depth);
    for (uint32_t octant = 0; octant < 8; ++octant) {
      const auto end = std::ranges::lower_bound(parts(), first + (octant + 1) * step, {}, &RecordPart::first);
      const auto next = std::min(static_cast<size_t>(end - parts().begin()), last_part);
      if (next == first_part) continue;
      Result<OpenCell> child = write_below(key.child(octant), first_part, next);
      if (!child) return child;
      children.push_back(std::move(*child));
      first_part = next;
    }
    return join(key, children);
  }

  /// Takes the sample of a cell out of its children, and writes their nodes.
  Result<OpenCell> join(const OctreeKey& key, std::vector<OpenCell>& children) {
    std::vector<SamplePoint> candidates;
    std::vector<ChildPoints> ranges;
    for (const OpenCell& child : children) {
      ranges.push_back({candidates.size(), child.points.keys.size(), child.has_nodes});
      add_candidates(child.points, key, candidates);
    }
    const std::vector<uint32_t> sample = node_sample(candidates, ranges, key.depth);
    OpenCell cell{key, {}, false};
    for (size_t i = 0; i < children.size(); ++i) {
      Bytes rest = split_off(children[i].points, sample, ranges[i].first, cell.points);
      cell.has_nodes = cell.has_nodes || !rest.empty();
      if (Status status = write_node(children[i].key, std::move(rest)); !status) return fail(status);
    }
    return cell;
  }

  void add_candidates(const SortedPoints& points, const OctreeKey& key, std::vector<SamplePoint>& candidates) const {
    for (size_t i = 0; i < points.keys.size(); ++i) candidates.push_back(candidate(points, i, key));
  }

  /// Appends those points of a child to `sample` that are in the sample of its parent, and returns the records of the
  /// others. `before`: the number of its first point there.
  [[nodiscard]] Bytes split_off(const SortedPoints& child, std::span<const uint32_t> chosen, size_t before,
                                SortedPoints& sample) const {
    Bytes rest;
    auto next = std::ranges::lower_bound(chosen, before);
    for (size_t i = 0; i < child.keys.size(); ++i) {
      const bool taken = next != chosen.end() && *next == before + i;
      if (taken) ++next;
      if (taken) sample.keys.push_back(child.keys[i]);
      append_record(child, i, taken ? sample.records : rest);
    }
    return rest;
  }

  Status write_node(const OctreeKey& key, Bytes records) {
    return records.empty() ? Status() : writer_.take(key, std::move(records));
  }

  void append_record(const SortedPoints& points, size_t point, Bytes& records) const {
    const auto first = points.records.begin() + static_cast<ptrdiff_t>(point * record_bytes_);
    records.insert(records.end(), first, first + static_cast<ptrdiff_t>(record_bytes_));
  }

  [[nodiscard]] SamplePoint candidate(const SortedPoints& points, size_t i, const OctreeKey& key) const {
    return {places_.place_in(key, &points.records[i * record_bytes_]), points.keys[i].hash};
  }

  // Parts.

  Result<OpenCell> write_part(size_t number) {
    Result<Bytes> records = parts_.take(number);
    if (!records) return fail(records);
    const SortedPoints points = sorted(std::move(*records));
    const PartNode node = make_node(points, parts()[number].key, 0, points.keys.size());
    if (Status status = write_children(points, node); !status) return fail(status);
    OpenCell cell{node.key, {}, !node.children.empty()};
    cell.points.records = records_of(points, node);
    for (const uint32_t i : node.points) cell.points.keys.push_back(points.keys[i]);
    return cell;
  }

  [[nodiscard]] SortedPoints sorted(Bytes records) const {
    struct Place {
      PointKey key;
      uint32_t row = 0;
      bool operator<(const Place& other) const { return key < other.key; }
    };
    const std::vector<uint64_t> codes = places_.codes(records);
    std::vector<Place> places(codes.size());
    oneapi::tbb::parallel_for(size_t{0}, codes.size(), [&](size_t i) {
      const auto record = std::span(records).subspan(i * record_bytes_, record_bytes_);
      places[i] = {{codes[i], hash_of(record)}, static_cast<uint32_t>(i)};
    });
    oneapi::tbb::parallel_sort(places.begin(), places.end());
    SortedPoints points{std::vector<PointKey>(places.size()), Bytes(records.size())};
    oneapi::tbb::parallel_for(size_t{0}, places.size(), [&](size_t i) {
      points.keys[i] = places[i].key;
      std::copy_n(&records[places[i].row * record_bytes_], record_bytes_, &points.records[i * record_bytes_]);
    });
    return points;
  }

  [[nodiscard]] bool is_leaf(const SortedPoints& points, const OctreeKey& key, size_t first, size_t last) const {
    return last - first <= options_.leaf_points || key.depth == kDeepestNode ||
           points.keys[first].code == points.keys[last - 1].code;
  }

  /// The nodes of the points from `first` to `last`, which are those in a cell.
  [[nodiscard]] PartNode make_node(const SortedPoints& points, const OctreeKey& key, size_t first, size_t last) const {
    PartNode node{key, {}, {}};
    if (is_leaf(points, key, first, last)) {
      node.points.resize(last - first);
      std::iota(node.points.begin(), node.points.end(), static_cast<uint32_t>(first));
      return node;
    }
    const std::array<size_t, 9> ends = split(points, key, first, last);
    std::array<PartNode, 8> children;
    oneapi::tbb::parallel_for(0U, 8U, [&](uint32_t octant) {
      if (ends[octant] == ends[octant + 1]) return;
      children[octant] = make_node(points, key.child(octant), ends[octant], ends[octant + 1]);
    });
    for (PartNode& child : children) {
      if (!child.points.empty()) node.children.push_back(std::move(child));
    }
    take_sample(points, node);
    return node;
  }

  [[nodiscard]] static std::array<size_t, 9> split(const SortedPoints& points, const OctreeKey& key, size_t first,
                                                   size_t last) {
    std::array<size_t, 9> ends{};
    ends[0] = first;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      const auto begin = points.keys.begin() + static_cast<ptrdiff_t>(ends[octant]);
      const auto end = std::partition_point(
          begin, points.keys.begin() + static_cast<ptrdiff_t>(last),
          [&](const PointKey& point) { return ldc::octant_of_code(point.code, key.depth) <= octant; });
      ends[octant + 1] = static_cast<size_t>(end - points.keys.begin());
    }
    return ends;
  }

  /// Moves the sample of a node out of its children.
  void take_sample(const SortedPoints& points, PartNode& node) const {
    std::vector<uint32_t> numbers;
    std::vector<ChildPoints> ranges;
    for (const PartNode& child : node.children) {
      ranges.push_back({numbers.size(), child.points.size(), !child.children.empty()});
      numbers.insert(numbers.end(), child.points.begin(), child.points.end());
    }
    std::vector<SamplePoint> candidates(numbers.size());
    for (size_t i = 0; i < numbers.size(); ++i) candidates[i] = candidate(points, numbers[i], node.key);
    for (const uint32_t i : node_sample(candidates, ranges, node.key.depth)) node.points.push_back(numbers[i]);
    for (PartNode& child : node.children) {
      std::vector<uint32_t> rest;
      std::ranges::set_difference(child.points, node.points, std::back_inserter(rest));
      child.points = std::move(rest);
    }
    std::erase_if(node.children, [](const PartNode& child) { return child.points.empty(); });
  }

  /// Writes the nodes below a node: those farther below come first.
  Status write_children(const SortedPoints& points, const PartNode& node) {
    for (const PartNode& child : node.children) {
      if (Status status = write_children(points, child); !status) return status;
    }
    for (const PartNode& child : node.children) {
      if (Status status = write_node(child.key, records_of(points, child)); !status) return status;
    }
    return {};
  }

  [[nodiscard]] Bytes records_of(const SortedPoints& points, const PartNode& node) const {
    Bytes records;
    records.reserve(node.points.size() * record_bytes_);
    for (const uint32_t i : node.points) append_record(points, i, records);
    return records;
  }

  RecordPlaces places_;
  size_t record_bytes_;
  OctreeOptions options_;
  NodeWriter& writer_;
  RecordParts parts_;
};

}  // namespace

Status write_octree(RecordSpool& spool, const LasHead& head, const geometry::RootCube& cube,
                    const std::filesystem::path& target, const OctreeOptions& options, NodeWriter& writer) {
  return OctreeDivider(head, cube, options, writer).write(spool, target);
}

}  // namespace surfcast::exporter
