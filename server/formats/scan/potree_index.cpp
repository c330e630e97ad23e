#include "scan/potree_index.h"

#include <algorithm>
#include <deque>
#include <set>

#include "base/invalid_input.h"
#include "scan/scalar_type.h"
#include "scan/text_tokens.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;

/// Levels below the root, more than coordinates of 32 bits have.
constexpr size_t kDeepestPotree = 40;

bool is_node_name(std::string_view name) {
  return name.size() <= kDeepestPotree && name.starts_with('r') &&
         std::all_of(name.begin() + 1, name.end(), [](char c) { return c >= '0' && c <= '7'; });
}

/// Chooses the nodes that may have points of a selection.
class Chooser {
 public:
  Chooser(const geometry::Box& cube, const Selection& selection) : cube_(cube), selection_(selection) {}

  [[nodiscard]] bool wants(const std::string& name) const {
    if (selection_.zone.everywhere()) return true;
    geometry::Box cell = potree_cube(cube_, name);
    const glm::dvec3 margin = 0.01 * cell.size();
    cell.min -= margin;
    cell.max += margin;
    return geometry::may_meet(selection_.zone, cell);
  }

 private:
  const geometry::Box& cube_;
  const Selection& selection_;
};

void sort_nodes(std::vector<PotreeNode>& nodes) {
  std::sort(nodes.begin(), nodes.end(), [](const PotreeNode& a, const PotreeNode& b) {
    return a.name.size() != b.name.size() ? a.name.size() < b.name.size() : a.name < b.name;
  });
}

/// Up to version 1.4: in the description.
Result<std::vector<PotreeNode>> listed_nodes(const Json& list, const Chooser& chooser) {
  std::vector<PotreeNode> nodes;
  for (const Json& entry : list) {
    const Json& name = element(entry, 0);
    const auto points = integer_of(element(entry, 1));
    if (!name.is_string() || !points || !is_node_name(name.get<std::string>())) {
      return invalid_input("the Potree hierarchy is damaged");
    }
    if (*points > 0 && chooser.wants(name.get<std::string>())) {
      nodes.push_back({name.get<std::string>(), *points, 0, 0});
    }
  }
  return nodes;
}

/// Calls `use` with the names of the children of a mask.
template <typename Use>
void for_each_child(const std::string& name, uint8_t mask, const Use& use) {
  for (int child = 0; child < 8; ++child) {
    if (mask >> child & 1) use(name + static_cast<char>('0' + child));
  }
}

/// A file of version 1.5 and later with the nodes below one, breadth first, 5 bytes each: children, points.
Status read_hrc(const TileFile& file, const std::string& top, uint64_t step, const Chooser& chooser,
                std::vector<PotreeNode>& nodes, std::vector<std::string>& files) {
  constexpr size_t kEntryBytes = 5;
  std::deque<std::string> queue{top};
  for (size_t at = 0; at + kEntryBytes <= file.bytes().size() && !queue.empty(); at += kEntryBytes) {
    const std::string name = std::move(queue.front());
    queue.pop_front();
    const auto mask = load<uint8_t>(&file.bytes()[at]);
    const auto points = load<uint32_t>(&file.bytes()[at + 1]);
    if (name.size() > kDeepestPotree) return file.error("is nested too deeply");
    const bool last_level = name.size() > top.size() && (name.size() - 1) % step == 0;
    if (last_level) {
      // The file of its own states the node again.
      if (mask != 0 && chooser.wants(name)) files.push_back(name);
      if (mask != 0) continue;
    } else {
      for_each_child(name, mask, [&queue](std::string child) { queue.push_back(std::move(child)); });
    }
    if (points > 0 && chooser.wants(name)) nodes.push_back({name, points, 0, 0});
  }
  return {};
}

}  // namespace

geometry::Box potree_cube(const geometry::Box& root, const std::string& name) {
  geometry::Box cube = root;
  for (const char digit : std::string_view(name).substr(1)) {
    const glm::dvec3 half = 0.5 * cube.size();
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (digit - '0') >> (2 - axis) & 1;
      (upper ? cube.min : cube.max)[axis] = upper ? cube.min[axis] + half[axis] : cube.max[axis] - half[axis];
    }
  }
  return cube;
}

std::string potree1_file(const std::string& node, uint64_t step, const char* extension) {
  std::string path = "r/";
  for (size_t at = 1; at + step <= node.size(); at += step) path += node.substr(at, step) + '/';
  return path + node + extension;
}

Result<std::vector<PotreeNode>> potree1_nodes(const fs::path& folder, const Json& description,
                                              const geometry::Box& cube, const Selection& selection) {
  const Chooser chooser(cube, selection);
  if (member(description, "hierarchy").is_array()) {
    Result<std::vector<PotreeNode>> nodes = listed_nodes(member(description, "hierarchy"), chooser);
    if (nodes) sort_nodes(*nodes);
    return nodes;
  }
  const uint64_t step = integer_of(description, "hierarchyStepSize").value_or(0);
  if (step == 0 || step > kDeepestPotree) return invalid_input("the Potree hierarchy is missing");
  std::vector<PotreeNode> nodes;
  std::vector<std::string> files{"r"};
  while (!files.empty()) {
    const std::string top = std::move(files.back());
    files.pop_back();
    const Result<TileFile> file =
        TileFile::open(folder, text_of(description, "octreeDir") + '/' + potree1_file(top, step, ".hrc"));
    if (!file) return fail(file);
    if (Status status = read_hrc(*file, top, step, chooser, nodes, files); !status) return fail(status);
  }
  sort_nodes(nodes);
  return nodes;
}

Result<std::vector<PotreeNode>> potree2_nodes(const fs::path& folder, const Json& description,
                                              const geometry::Box& cube, const Selection& selection) {
  constexpr size_t kEntryBytes = 22;
  constexpr uint8_t kLink = 2;
  struct Page {
    std::string top;
    uint64_t offset = 0;
    uint64_t bytes = 0;
  };
  const Chooser chooser(cube, selection);
  const Result<TileFile> file = TileFile::open(folder, "hierarchy.bin");
  if (!file) return fail(file);
  std::vector<PotreeNode> nodes;
  std::vector<Page> pages{{"r", 0, integer_of(member(description, "hierarchy"), "firstChunkSize").value_or(0)}};
  std::set<uint64_t> seen;
  while (!pages.empty()) {
    const Page page = std::move(pages.back());
    pages.pop_back();
    const uint64_t size = file->bytes().size();
    if (page.offset > size || page.bytes > size - page.offset) return file->error("truncated");
    if (!seen.insert(page.offset).second) return file->error("has a page within itself");
    std::deque<std::string> queue{page.top};
    for (uint64_t at = page.offset; at + kEntryBytes <= page.offset + page.bytes && !queue.empty(); at += kEntryBytes) {
      const std::byte* entry = &file->bytes()[at];
      const std::string name = std::move(queue.front());
      queue.pop_front();
      if (name.size() > kDeepestPotree) return file->error("is nested too deeply");
      const PotreeNode node{name, load<uint32_t>(entry + 2), load<uint64_t>(entry + 6), load<uint64_t>(entry + 14)};
      if (load<uint8_t>(entry) == kLink) {
        if (chooser.wants(name)) pages.push_back({name, node.offset, node.bytes});
        continue;
      }
      for_each_child(name, load<uint8_t>(entry + 1),
                     [&queue](std::string child) { queue.push_back(std::move(child)); });
      if (node.points > 0 && node.bytes > 0 && chooser.wants(name)) nodes.push_back(node);
    }
  }
  sort_nodes(nodes);
  return nodes;
}

}  // namespace surfcast::scan
