#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "laz/byte_access.h"
#include "laz/laz_writer.h"
#include "scan/bytes.h"
#include "scan/las_file.h"

namespace surfcast::testing {

struct CopcNode {
  int32_t level, x, y;
};

struct CopcShape {
  int32_t levels = 6;
  size_t node_points = 200;
  int32_t page_level = 3;  ///< nodes from here on have pages of their own
};

inline constexpr int32_t kCopcSide = 32000;  ///< of the root, steps of 0.01

/// A flat octree with as many points in every node: level by level.
inline std::vector<CopcNode> all_nodes(const CopcShape& shape = {}) {
  std::vector<CopcNode> nodes;
  for (int32_t level = 0; level < shape.levels; ++level) {
    for (int32_t i = 0; i < 1 << level * 2; ++i) nodes.push_back({level, i % (1 << level), i >> level});
  }
  return nodes;
}

inline std::vector<std::byte> records_of(const std::vector<CopcNode>& nodes, size_t node_points) {
  std::mt19937 random(4);
  std::vector<std::byte> records(nodes.size() * node_points * 30);
  std::byte* at = records.data();
  for (const CopcNode& node : nodes) {
    const int32_t side = kCopcSide >> node.level;
    for (size_t i = 0; i < node_points; ++i, at += 30) {
      laz::store(at, node.x * side + static_cast<int32_t>(random() % static_cast<uint32_t>(side)));
      laz::store(at + 4, node.y * side + static_cast<int32_t>(random() % static_cast<uint32_t>(side)));
      at[14] = std::byte{0x11};
      at[16] = static_cast<std::byte>(random() % 5);
    }
  }
  return records;
}

inline std::string variable_record(std::string_view user, uint16_t id, std::string_view body) {
  Bytes head(std::string(54, '\0'));
  head.set(18, id).set(20, static_cast<uint16_t>(body.size()));
  std::string text = head.text();
  text.replace(2, user.size(), user);
  return text + std::string(body);
}

inline std::string_view text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline std::string entry(const CopcNode& node, uint64_t offset, int32_t bytes, int32_t points) {
  return Bytes().add(node.level).add(node.x).add(node.y).add(int32_t{0}).add(offset).add(bytes).add(points).text();
}

/// The pages below one node each, and before them the root page, which ends up last in the file.
struct CopcHierarchy {
  std::string pages;
  uint64_t root = 0;
  uint64_t root_bytes = 0;
};

inline CopcHierarchy hierarchy_of(const CopcShape& shape, const std::vector<CopcNode>& nodes,
                                  std::span<const laz::Chunk> chunks, uint64_t place) {
  const auto line = [&](size_t i) {
    return entry(nodes[i], chunks[i].offset, static_cast<int32_t>(chunks[i].size),
                 static_cast<int32_t>(shape.node_points));
  };
  CopcHierarchy hierarchy;
  std::string root;
  for (size_t i = 0; i < nodes.size() && nodes[i].level < shape.page_level; ++i) root += line(i);
  for (const CopcNode& top : nodes) {
    if (top.level != shape.page_level) continue;
    std::string page;
    for (size_t i = 0; i < nodes.size(); ++i) {
      const int32_t down = nodes[i].level - shape.page_level;
      if (down >= 0 && nodes[i].x >> down == top.x && nodes[i].y >> down == top.y) page += line(i);
    }
    root += entry(top, place + hierarchy.pages.size(), static_cast<int32_t>(page.size()), -1);
    hierarchy.pages += page;
  }
  hierarchy.root = place + hierarchy.pages.size();
  hierarchy.root_bytes = root.size();
  hierarchy.pages += root;
  return hierarchy;
}

/// A COPC file. The info record is the first, as the specification has it.
inline std::string copc_file(const CopcShape& shape = {}) {
  const std::vector<CopcNode> nodes = all_nodes(shape);
  const std::vector<std::byte> records = records_of(nodes, shape.node_points);
  laz::testing::LazWriter writer;
  writer.point_format = 6;
  writer.record_length = 30;
  writer.variable_chunks = true;
  writer.chunk_sizes.assign(nodes.size(), shape.node_points);
  LasFile file;
  file.minor = 4;
  file.format = 6;
  file.variable_record_count = 2;
  const std::vector<std::byte> coding = writer.laszip_record();
  file.variable_records =
      variable_record("copc", 1, std::string(160, '\0')) + variable_record("laszip encoded", 22204, text_of(coding));
  std::string head = file.text();
  const std::vector<std::byte> data = writer.point_data(records, head.size());
  const size_t data_offset = head.size();
  const std::string whole = head + std::string(text_of(data));
  const laz::LazPoints points{6, 30, nodes.size() * shape.node_points, data_offset};
  const auto laz = laz::LazFile::open(as_bytes(whole), points, coding);
  const CopcHierarchy hierarchy = hierarchy_of(shape, nodes, laz->chunks(), whole.size());
  Bytes copc(whole + hierarchy.pages);
  copc.set<uint8_t>(104, 0x80 | 6).set<uint64_t>(247, points.count);
  constexpr size_t kInfo = 375 + 54;
  for (const size_t axis : {0, 1, 2}) copc.set(kInfo + 8 * axis, 160.0);
  copc.set(kInfo + 24, 160.0).set(kInfo + 40, hierarchy.root).set(kInfo + 48, hierarchy.root_bytes);
  return copc.text();
}

}  // namespace surfcast::testing
