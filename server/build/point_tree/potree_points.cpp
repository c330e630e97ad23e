#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/file_source.h"
#include "base/invalid_input.h"
#include "point_tree/tree_formats.h"
#include "scan/potree_reader.h"

namespace surfcast::point_tree {
namespace {

namespace fs = std::filesystem;

/// The cell of a node: a digit of its name for each level, bit 2 for x, bit 1 for y, bit 0 for z.
ldc::OctreeKey key_of_name(std::string_view name) {
  ldc::OctreeKey key;
  for (const char digit : name.substr(1)) {
    const auto bits = static_cast<uint32_t>(digit - '0');
    key = key.child((bits >> 2 & 1) | (bits & 2) | (bits & 1) << 2);
  }
  return key;
}

class PotreeReader : public NodeReader {
 public:
  PotreeReader(std::unique_ptr<const ByteSource> description, FileSource points, scan::Potree2Folder folder)
      : description_(std::move(description)), points_(std::move(points)), folder_(std::move(folder)) {
    traits_.grid = folder_.grid;
  }

  [[nodiscard]] const scan::RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<scan::ColumnInfo>& columns() const override { return folder_.columns; }
  [[nodiscard]] const ByteSource& source() const override { return *description_; }
  [[nodiscard]] std::string version() const override { return description_->version() + ' ' + points_.version(); }
  void prefetch(std::span<const Node> nodes) const override {
    for (const Node& node : nodes) points_.prefetch({&node.bytes, 1});
  }
  void forget(const Node& /*node*/) const override {}

  [[nodiscard]] Result<scan::PointTable> read(const Node& node) const override {
    std::vector<std::byte> bytes(node.bytes.size);
    if (Status status = points_.read(node.bytes.offset, bytes); !status) return fail(status);
    scan::PotreeNode stated;
    stated.points = node.points;
    stated.bytes = node.bytes.size;
    return folder_.points(stated, bytes);
  }

 private:
  std::unique_ptr<const ByteSource> description_;
  FileSource points_;  ///< octree.bin
  scan::Potree2Folder folder_;
  scan::RowTraits traits_;
};

Result<NodeTree> arrange_potree(const scan::Potree2Folder& folder, uint64_t file_bytes) {
  const Result<Cells> cells = cells_below(folder.cube);
  if (!cells) return fail(cells);
  std::vector<Node> nodes;
  nodes.reserve(folder.nodes.size());
  uint64_t bytes = 0;
  for (const scan::PotreeNode& from : folder.nodes) {
    if (from.offset > file_bytes || from.bytes > file_bytes - from.offset) {
      return invalid_input("truncated: node " + from.name + " lies beyond the end of octree.bin");
    }
    bytes += from.bytes;
    Node node;
    node.key = key_of_name(from.name);
    node.points = from.points;
    node.bytes = {from.offset, from.bytes};
    nodes.push_back(node);
  }
  if (bytes > file_bytes) return invalid_input("the bytes of its nodes overlap");
  return arrange_nodes(std::move(nodes), *cells, root_spacing(*cells, folder.spacing));
}

}  // namespace

Result<OpenedTree> open_potree(std::unique_ptr<const ByteSource> description, uint64_t most_bytes) {
  const fs::path metadata = description->name();
  std::error_code code;
  const uintmax_t hierarchy = fs::file_size(metadata.parent_path() / "hierarchy.bin", code);
  if (!code && hierarchy > most_bytes) {
    return fail(ErrorKind::kLimit,
                "the Potree hierarchy has more than the " + std::to_string(most_bytes) + " bytes that are allowed");
  }
  Result<scan::Potree2Folder> folder = scan::open_potree2(metadata);
  if (!folder) return fail(folder);
  const fs::path path = metadata.parent_path() / "octree.bin";
  Result<PositionedFile> points = PositionedFile::open(path);
  if (!points) return fail(points);
  Result<NodeTree> tree = arrange_potree(*folder, points->size());
  if (!tree) return fail(tree);
  OpenedTree opened;
  opened.tree = std::move(*tree);
  opened.reader = std::make_unique<const PotreeReader>(std::move(description), FileSource(std::move(*points), path),
                                                       std::move(*folder));
  return opened;
}

}  // namespace surfcast::point_tree
