#include "scan/copc_index.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_set>
#include <utility>

#include "base/invalid_input.h"
#include "scan/scalar_type.h"
#include "scan/selection.h"

namespace surfcast::scan {
namespace {

constexpr size_t kRecordBytes = 160;
constexpr size_t kCopcEntryBytes = 32;
/// Deeper than an octree of 32 bit coordinates can be.
constexpr int32_t kDeepestCopc = 31;

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

/// The cell of a node, a little larger: its points were placed before they were rounded.
geometry::Box copc_cell(const CopcInfo& info, const Entry& entry) {
  const double step = std::ldexp(info.side, -entry.level);
  geometry::Box box;
  box.min = info.low + step * (glm::dvec3(entry.place) - 0.01);
  box.max = info.low + step * (glm::dvec3(entry.place) + 1.01);
  return box;
}

class HierarchyWalk {
 public:
  HierarchyWalk(const ByteSource& file, const CopcInfo& info, const geometry::Zone& zone, uint64_t most_bytes)
      : file_(file), info_(info), zone_(zone), most_bytes_(most_bytes) {}

  Result<CopcNodes> run() {
    pages_.push_back(info_.root);
    while (!pages_.empty()) {
      const std::vector<ByteRange> pages = std::exchange(pages_, {});
      for (const ByteRange& page : pages) {
        if (Status status = check(page); !status) return fail(status);
      }
      file_.prefetch(pages);
      for (const ByteRange& page : pages) {
        if (Status status = read(page); !status) return fail(status);
      }
    }
    return std::move(nodes_);
  }

 private:
  Status check(const ByteRange& page) {
    if (page.offset > file_.size() || page.size > file_.size() - page.offset) {
      return invalid_input("truncated: a page of the COPC hierarchy lies beyond the end of the file");
    }
    if (page.size % kCopcEntryBytes != 0) {
      return invalid_input("a page of the COPC hierarchy has a size that cannot be");
    }
    if (!seen_.insert(page.offset).second) return invalid_input("a page of the COPC hierarchy is within itself");
    nodes_.page_bytes += page.size;
    if (nodes_.page_bytes > file_.size()) return invalid_input("pages of the COPC hierarchy overlap");
    if (nodes_.page_bytes <= most_bytes_) return {};
    return fail(ErrorKind::kLimit,
                "the COPC hierarchy has more than the " + std::to_string(most_bytes_) + " bytes that are allowed");
  }

  Status read(const ByteRange& page) {
    std::vector<std::byte> bytes(page.size);
    if (Status status = file_.read(page.offset, bytes); !status) return status;
    for (size_t at = 0; at < bytes.size(); at += kCopcEntryBytes) {
      if (Status status = take(load_entry(&bytes[at])); !status) return status;
    }
    return {};
  }

  Status take(const Entry& entry) {
    const bool sound = entry.level >= 0 && entry.level <= kDeepestCopc && entry.points >= -1 && entry.bytes >= 0;
    if (!sound || ((entry.place.x | entry.place.y | entry.place.z) >> entry.level) != 0) {
      return invalid_input("an entry of the COPC hierarchy is damaged");
    }
    if (!geometry::may_meet(zone_, copc_cell(info_, entry))) return {};
    const ByteRange range{entry.offset, static_cast<uint64_t>(entry.bytes)};
    if (entry.points == -1) {
      pages_.push_back(range);
    } else {
      nodes_.nodes.push_back({entry.level, entry.place, range, static_cast<uint64_t>(entry.points)});
    }
    return {};
  }

  const ByteSource& file_;
  const CopcInfo& info_;
  const geometry::Zone& zone_;
  uint64_t most_bytes_;
  std::vector<ByteRange> pages_;  ///< to be read next
  std::unordered_set<uint64_t> seen_;
  CopcNodes nodes_;
};

}  // namespace

Result<CopcInfo> read_copc_info(std::span<const std::byte> record) {
  if (record.size() < kRecordBytes) return invalid_input("the COPC record is too short");
  const auto half = load<double>(&record[24]);
  const glm::dvec3 centre(load<double>(record.data()), load<double>(&record[8]), load<double>(&record[16]));
  if (!(half > 0) || !std::isfinite(half)) return invalid_input("the COPC record states no size of the root");
  return CopcInfo{
      centre - half, 2 * half, load<double>(&record[32]), {load<uint64_t>(&record[40]), load<uint64_t>(&record[48])}};
}

Result<CopcNodes> read_copc_nodes(const ByteSource& file, const CopcInfo& info, const geometry::Zone& zone,
                                  uint64_t most_bytes) {
  return HierarchyWalk(file, info, zone, most_bytes).run();
}

}  // namespace surfcast::scan
