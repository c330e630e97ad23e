#include "exporter/point_octree.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "base/hash.h"
#include "base/spool_file.h"
#include "exporter/even_sample.h"
#include "scan/scalar_type.h"

namespace surfcast::exporter {
namespace {

using geometry::kMortonDepth;
using ldc::OctreeKey;
using Bytes = std::vector<std::byte>;

/// Depths of the cells in which points are counted before they are divided into parts.
constexpr std::array<int, 3> kCountDepths = {6, 10, kDeepestNode};

/// The number of Morton codes of a cell.
uint64_t codes_of_cell(int depth) {
  return uint64_t{1} << (3 * (kMortonDepth - depth));
}

/// Scale and offset of coordinates, from the header.
struct Lattice {
  glm::dvec3 scale{1};
  glm::dvec3 offset{0};

  explicit Lattice(const LasHead& head) {
    for (int axis = 0; axis < 3; ++axis) {
      scale[axis] = scan::load<double>(&head.header[131 + 8 * static_cast<size_t>(axis)]);
      offset[axis] = scan::load<double>(&head.header[155 + 8 * static_cast<size_t>(axis)]);
    }
  }
  [[nodiscard]] glm::dvec3 position(const std::byte* record) const {
    const glm::dvec3 index(scan::load<int32_t>(record), scan::load<int32_t>(record + 4),
                           scan::load<int32_t>(record + 8));
    return index * scale + offset;
  }
};

/// The points of a range of Morton codes.
struct CodeRange {
  uint64_t first = 0;  ///< code of the cell in which they were counted
  uint64_t count = 0;
  uint64_t low = UINT64_MAX;  ///< of their codes
  uint64_t high = 0;

  void add(uint64_t code) {
    ++count;
    low = std::min(low, code);
    high = std::max(high, code);
  }
  void add(const CodeRange& more) {
    count += more.count;
    low = std::min(low, more.low);
    high = std::max(high, more.high);
  }
};

/// A cell of the octree whose points are in memory together.
struct Part {
  OctreeKey key;
  uint64_t first = 0;  ///< code
  uint64_t count = 0;
};

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

/// The points of a child among those from which a sample is taken.
struct Candidates {
  size_t first = 0;
  size_t count = 0;
  bool has_nodes = false;  ///< below the child
};

/// The sample of a node among the points of its children. Many readers look for no nodes below an empty one. So of each
/// child that has nodes below it one point at least stays, and the sample has a point for each node from here up to the
/// root, even where points are too close together for that.
class NodeSample {
 public:
  NodeSample(std::span<const SamplePoint> points, std::span<const Candidates> children)
      : points_(points), children_(children), chosen_(even_sample(points)) {}

  /// The numbers of the points, in ascending order.
  std::vector<uint32_t> take(const OctreeKey& node) {
    for (const Candidates& child : children_) {
      if (is_emptied(child, 0)) chosen_.erase(last_to_choose(child));
    }
    if (chosen_.size() <= node.depth) top_up(size_t{node.depth} + 1);
    return std::move(chosen_);
  }

 private:
  std::vector<uint32_t>::iterator last_to_choose(const Candidates& child) {
    return std::ranges::max_element(from(child), to(child), {}, [this](uint32_t i) { return points_[i].hash; });
  }
  std::vector<uint32_t>::iterator from(const Candidates& child) {
    return std::ranges::lower_bound(chosen_, child.first);
  }
  std::vector<uint32_t>::iterator to(const Candidates& child) {
    return std::ranges::lower_bound(chosen_, child.first + child.count);
  }

  /// Whether a child that has nodes below it keeps no point if `more` of its points are taken.
  bool is_emptied(const Candidates& child, size_t more) {
    return child.has_nodes && static_cast<size_t>(to(child) - from(child)) + more == child.count;
  }

  void top_up(size_t least) {
    std::vector<uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [this](uint32_t i) { return points_[i].hash; });
    for (size_t i = 0; i < order.size() && chosen_.size() < least; ++i) {
      const auto child = std::ranges::upper_bound(children_, order[i], {}, &Candidates::first) - 1;
      const auto place = std::ranges::lower_bound(chosen_, order[i]);
      const bool taken = place != chosen_.end() && *place == order[i];
      if (!taken && !is_emptied(*child, 1)) chosen_.insert(place, order[i]);
    }
  }

  std::span<const SamplePoint> points_;
  std::span<const Candidates> children_;
  std::vector<uint32_t> chosen_;
};

class OctreeDivider {
 public:
  OctreeDivider(RecordSpool& spool, const LasHead& head, const geometry::RootCube& cube, std::filesystem::path target,
                const OctreeOptions& options, NodeWriter& writer)
      : spool_(spool),
        lattice_(head),
        record_bytes_(head.record_length),
        cube_(cube),
        target_(std::move(target)),
        options_(options),
        writer_(writer) {
    options_.leaf_points = std::max<uint64_t>(options_.leaf_points, kDeepestNode + 1);  // see NodeSample
  }

  Status write() {
    if (spool_.is_resident()) {
      resident_ = spool_.take_resident();
      parts_ = {{{}, 0, resident_.size() / record_bytes_}};
    } else if (Status status = divide_on_disk(); !status) {
      return status;
    }
    Result<OpenCell> root = write_below({}, 0, parts_.size());
    if (!root) return fail(std::move(root.error()));
    return write_node(root->key, std::move(root->points.records));
  }

 private:
  // Codes of records.

  [[nodiscard]] std::vector<uint64_t> codes_of(std::span<const std::byte> records) const {
    std::vector<uint64_t> codes(records.size() / record_bytes_);
    oneapi::tbb::parallel_for(size_t{0}, codes.size(), [&](size_t i) {
      codes[i] = geometry::morton_code(cube_, lattice_.position(&records[i * record_bytes_]));
    });
    return codes;
  }

  // Parts on disk.

  [[nodiscard]] uint64_t part_points() const {
    return std::max(options_.leaf_points, options_.memory / 4 / record_bytes_);
  }

  /// Too many points for a part, and not all in one place.
  [[nodiscard]] bool is_divided(const CodeRange& cell) const {
    return cell.count > part_points() && cell.low != cell.high;
  }

  /// Counts the points in cells of a depth, of all points or of those in some cells.
  Result<std::vector<CodeRange>> count_cells(int depth, const std::function<bool(uint64_t)>& wanted) {
    std::map<uint64_t, CodeRange> cells;
    const Status counted = spool_.for_each_batch(false, [&](std::span<const std::byte> records) -> Status {
      CodeRange* cell = nullptr;
      for (const uint64_t code : codes_of(records)) {
        if (!wanted(code)) continue;
        const uint64_t first = code / codes_of_cell(depth) * codes_of_cell(depth);
        if (cell == nullptr || cell->first != first) cell = &cells[first];
        cell->first = first;
        cell->add(code);
      }
      return {};
    });
    if (!counted) return fail(counted.error());
    std::vector<CodeRange> all;
    for (const auto& [first, cell] : cells) all.push_back(cell);
    return all;
  }

  /// Cells of a coarse grid, and of finer ones where those have too many points.
  Result<std::vector<CodeRange>> count_points() {
    Result<std::vector<CodeRange>> cells = count_cells(kCountDepths.front(), [](uint64_t) { return true; });
    for (size_t i = 1; cells && i < kCountDepths.size(); ++i) {
      if (Status status = refine(*cells, kCountDepths[i - 1], kCountDepths[i]); !status)
        return fail(std::move(status.error()));
    }
    return cells;
  }

  /// Replaces cells that have too many points by smaller ones.
  Status refine(std::vector<CodeRange>& cells, int depth, int finer_depth) {
    std::vector<uint64_t> full;
    for (const CodeRange& cell : cells) {
      if (is_divided(cell)) full.push_back(cell.first / codes_of_cell(depth));
    }
    if (full.empty()) return {};
    const auto is_full = [&](uint64_t code) {
      return std::binary_search(full.begin(), full.end(), code / codes_of_cell(depth));
    };
    const Result<std::vector<CodeRange>> finer = count_cells(finer_depth, is_full);
    if (!finer) return fail(finer.error());
    std::erase_if(cells, [&](const CodeRange& cell) { return is_full(cell.first); });
    cells.insert(cells.end(), finer->begin(), finer->end());
    std::ranges::sort(cells, {}, &CodeRange::first);
    return {};
  }

  /// The largest cells that can be parts.
  void choose_parts(std::span<const CodeRange> cells, const OctreeKey& key, uint64_t first) {
    if (cells.empty()) return;
    CodeRange all;
    for (const CodeRange& cell : cells) all.add(cell);
    if (!is_divided(all) || key.depth == kDeepestNode) {
      parts_.push_back({key, first, all.count});
      return;
    }
    const uint64_t step = codes_of_cell(key.depth + 1);
    for (uint32_t octant = 0; octant < 8; ++octant) {
      const uint64_t begin = first + octant * step;
      const auto from = std::ranges::lower_bound(cells, begin, {}, &CodeRange::first);
      const auto to = std::ranges::lower_bound(cells, begin + step, {}, &CodeRange::first);
      choose_parts({from, to}, key.child(octant), begin);
    }
  }

  [[nodiscard]] size_t part_of(uint64_t code) const {
    return static_cast<size_t>(std::ranges::upper_bound(parts_, code, {}, &Part::first) - parts_.begin()) - 1;
  }

  Status divide_on_disk() {
    const Result<std::vector<CodeRange>> cells = count_points();
    if (!cells) return fail(cells.error());
    choose_parts(*cells, {}, 0);
    extents_.resize(parts_.size());
    Result<SpoolFile> file = SpoolFile::create(target_);
    if (!file) return fail(std::move(file.error()));
    divided_ = std::move(*file);
    return spool_.for_each_batch(true, [this](std::span<const std::byte> records) { return distribute(records); });
  }

  /// Appends the records of a batch to the file, those of a part together.
  Status distribute(std::span<const std::byte> records) {
    const std::vector<uint64_t> codes = codes_of(records);
    std::vector<size_t> parts(codes.size());
    oneapi::tbb::parallel_for(size_t{0}, codes.size(), [&](size_t i) { parts[i] = part_of(codes[i]); });
    std::vector<size_t> ends(parts_.size());
    for (const size_t part : parts) ends[part] += record_bytes_;
    for (size_t part = 0, at = divided_->size(); part < ends.size(); at += ends[part++]) {
      if (ends[part] != 0) extents_[part].push_back({at, ends[part]});
    }
    for (size_t part = 0, end = 0; part < ends.size(); ++part) std::swap(ends[part], end), end += ends[part];
    Bytes sorted(records.size());
    for (size_t i = 0; i < parts.size(); ++i) {
      std::copy_n(&records[i * record_bytes_], record_bytes_, &sorted[ends[parts[i]]]);
      ends[parts[i]] += record_bytes_;
    }
    const Result<uint64_t> written = divided_->append(sorted);
    return written ? Status() : fail(written.error());
  }

  Result<Bytes> load_part(size_t number) {
    if (!divided_) return std::move(resident_);
    Bytes records(parts_[number].count * record_bytes_);
    size_t at = 0;
    for (const Extent& extent : extents_[number]) {
      const auto into = std::span(records).subspan(at, extent.size);
      if (Status status = divided_->read(extent.offset, into); !status) return fail(std::move(status.error()));
      divided_->release(extent.offset, extent.size);
      at += extent.size;
    }
    return records;
  }

  // Cells that are made of several parts.

  /// Writes the nodes below a cell.
  Result<OpenCell> write_below(const OctreeKey& key, size_t first_part, size_t last_part) {
    if (parts_[first_part].key == key) return write_part(first_part);
    std::vector<OpenCell> children;
    const uint64_t step = codes_of_cell(key.depth + 1);
    const uint64_t first = parts_[first_part].first / codes_of_cell(key.depth) * codes_of_cell(key.depth);
    for (uint32_t octant = 0; octant < 8; ++octant) {
      const auto end = std::ranges::lower_bound(parts_, first + (octant + 1) * step, {}, &Part::first);
      const auto next = std::min(static_cast<size_t>(end - parts_.begin()), last_part);
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
    std::vector<Candidates> ranges;
    for (const OpenCell& child : children) {
      ranges.push_back({candidates.size(), child.points.keys.size(), child.has_nodes});
      add_candidates(child.points, key, candidates);
    }
    const std::vector<uint32_t> sample = NodeSample(candidates, ranges).take(key);
    OpenCell cell{key, {}, false};
    for (size_t i = 0; i < children.size(); ++i) {
      Bytes rest = split_off(children[i].points, sample, ranges[i].first, cell.points);
      cell.has_nodes = cell.has_nodes || !rest.empty();
      if (Status status = write_node(children[i].key, std::move(rest)); !status) return fail(std::move(status.error()));
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
    const double side = std::ldexp(cube_.side, -key.depth);
    const glm::dvec3 low = cube_.min + side * glm::dvec3(key.x, key.y, key.z);
    return {glm::vec3((lattice_.position(&points.records[i * record_bytes_]) - low) / side), points.keys[i].hash};
  }

  // Parts.

  Result<OpenCell> write_part(size_t number) {
    Result<Bytes> records = load_part(number);
    if (!records) return fail(std::move(records.error()));
    const SortedPoints points = sorted(std::move(*records));
    const PartNode node = make_node(points, parts_[number].key, 0, points.keys.size());
    if (Status status = write_children(points, node); !status) return fail(std::move(status.error()));
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
    const std::vector<uint64_t> codes = codes_of(records);
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
    std::vector<Candidates> ranges;
    for (const PartNode& child : node.children) {
      ranges.push_back({numbers.size(), child.points.size(), !child.children.empty()});
      numbers.insert(numbers.end(), child.points.begin(), child.points.end());
    }
    std::vector<SamplePoint> candidates(numbers.size());
    for (size_t i = 0; i < numbers.size(); ++i) candidates[i] = candidate(points, numbers[i], node.key);
    for (const uint32_t i : NodeSample(candidates, ranges).take(node.key)) node.points.push_back(numbers[i]);
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

  struct Extent {
    uint64_t offset = 0;
    size_t size = 0;
  };

  RecordSpool& spool_;
  Lattice lattice_;
  size_t record_bytes_;
  geometry::RootCube cube_;
  std::filesystem::path target_;
  OctreeOptions options_;
  NodeWriter& writer_;
  Bytes resident_;  ///< all records, if they are in memory
  std::vector<Part> parts_;
  std::vector<std::vector<Extent>> extents_;  ///< of the parts, in `divided_`
  std::optional<SpoolFile> divided_;
};

}  // namespace

geometry::RootCube cube_of(const LasHead& head, const LasCounts& counts) {
  const Lattice lattice(head);
  const glm::dvec3 a = glm::dvec3(counts.low[0], counts.low[1], counts.low[2]) * lattice.scale + lattice.offset;
  const glm::dvec3 b = glm::dvec3(counts.high[0], counts.high[1], counts.high[2]) * lattice.scale + lattice.offset;
  const glm::dvec3 low = glm::min(a, b), size = glm::max(a, b) - low, steps = glm::abs(lattice.scale);
  // One step wider than the points, so that none lies on an upper face.
  return {low, std::max({size.x + steps.x, size.y + steps.y, size.z + steps.z})};
}

Status write_octree(RecordSpool& spool, const LasHead& head, const geometry::RootCube& cube,
                    const std::filesystem::path& target, const OctreeOptions& options, NodeWriter& writer) {
  return OctreeDivider(spool, head, cube, target, options, writer).write();
}

}  // namespace surfcast::exporter
