#include "scan/copc_index.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_set>

#include "base/invalid_input.h"
#include "scan/scalar_type.h"
#include "scan/selection.h"

namespace surfcast::scan {
namespace {

constexpr size_t kRecordBytes = 160;
constexpr size_t kEntryBytes = 32;
/// Deeper than an octree of 32 bit coordinates can be.
constexpr int32_t kDeepest = 31;

struct Page {
  uint64_t offset = 0;
  uint64_t size = 0;
};

/// An entry of a page: a node, or (points -1) a page with the node and what is below it.
struct Entry {
  int32_t level = 0;
  glm::ivec3 place{0};
  uint64_t offset = 0;
  int32_t bytes = 0;
  int32_t points = 0;
};

Entry load_entry(const std::byte* at) {
  return {load<int32_t>(at),
          {load<int32_t>(at + 4), load<int32_t>(at + 8), load<int32_t>(at + 12)},
          load<uint64_t>(at + 16),
          load<int32_t>(at + 24),
          load<int32_t>(at + 28)};
}

/// The cube of the root.
struct Cube {
  glm::dvec3 low{0};
  double side = 0;

  /// The cell of a node, a little larger: its points were placed before they were rounded.
  [[nodiscard]] geometry::Box cell(const Entry& entry) const {
    const double step = std::ldexp(side, -entry.level);
    geometry::Box box;
    box.min = low + step * (glm::dvec3(entry.place) - 0.01);
    box.max = low + step * (glm::dvec3(entry.place) + 1.01);
    return box;
  }
};

class HierarchyWalk {
 public:
  HierarchyWalk(std::span<const std::byte> file, const Cube& cube, const geometry::Zone& zone)
      : file_(file), cube_(cube), zone_(zone) {}

  Result<CopcNodes> run(const Page& root) {
    pages_.push_back(root);
    while (!pages_.empty()) {
      const Page page = pages_.back();
      pages_.pop_back();
      if (Status status = read(page); !status) return fail(status.error());
    }
    std::sort(nodes_.chunks.begin(), nodes_.chunks.end(),
              [](const laz::Chunk& a, const laz::Chunk& b) { return a.offset < b.offset; });
    return std::move(nodes_);
  }

 private:
  Status read(const Page& page) {
    if (page.offset > file_.size() || page.size > file_.size() - page.offset) {
      return invalid_input("truncated: a page of the COPC hierarchy lies beyond the end of the file");
    }
    if (page.size % kEntryBytes != 0) return invalid_input("a page of the COPC hierarchy has a size that cannot be");
    if (!seen_.insert(page.offset).second) return invalid_input("a page of the COPC hierarchy is within itself");
    nodes_.page_bytes += page.size;
    for (uint64_t at = page.offset; at < page.offset + page.size; at += kEntryBytes) {
      if (Status status = take(load_entry(&file_[at])); !status) return status;
    }
    return {};
  }

  Status take(const Entry& entry) {
    if (entry.level < 0 || entry.level > kDeepest || entry.points < -1 || entry.bytes < 0) {
      return invalid_input("an entry of the COPC hierarchy is damaged");
    }
    if (entry.points == 0 || !geometry::may_meet(zone_, cube_.cell(entry))) return {};
    if (entry.points == -1) {
      pages_.push_back({entry.offset, static_cast<uint64_t>(entry.bytes)});
    } else {
      nodes_.chunks.push_back({0, static_cast<uint64_t>(entry.points), entry.offset, static_cast<size_t>(entry.bytes)});
    }
    return {};
  }

  std::span<const std::byte> file_;
  Cube cube_;
  const geometry::Zone& zone_;
  std::vector<Page> pages_;
  std::unordered_set<uint64_t> seen_;
  CopcNodes nodes_;
};

}  // namespace

Result<CopcNodes> read_copc_nodes(std::span<const std::byte> file, std::span<const std::byte> record,
                                  const geometry::Zone& zone) {
  if (record.size() < kRecordBytes) return invalid_input("the COPC record is too short");
  const auto half = load<double>(&record[24]);
  const glm::dvec3 centre(load<double>(record.data()), load<double>(&record[8]), load<double>(&record[16]));
  if (!(half > 0) || !std::isfinite(half)) return invalid_input("the COPC record states no size of the root");
  const Page root{load<uint64_t>(&record[40]), load<uint64_t>(&record[48])};
  return HierarchyWalk(file, {centre - half, 2 * half}, zone).run(root);
}

}  // namespace surfcast::scan
