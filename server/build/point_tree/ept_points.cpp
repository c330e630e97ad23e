#include <utility>

#include "base/invalid_input.h"
#include "point_tree/tree_formats.h"
#include "scan/ept_index.h"

namespace surfcast::point_tree {
namespace {

/// More than a description, and than a tile of an octree of points.
constexpr uint64_t kMaxDescription = uint64_t{16} << 20;
constexpr uint64_t kMaxTile = uint64_t{256} << 20;

scan::EptKey ept_key(const ldc::OctreeKey& key) {
  return {key.depth, key.x, key.y, key.z};
}

/// The description, which counts as replaced when files of its folder are.
class DescribedFolder : public ByteSource {
 public:
  DescribedFolder(std::unique_ptr<const ByteSource> description, std::unique_ptr<const FileFolder> folder)
      : description_(std::move(description)), folder_(std::move(folder)) {}

  [[nodiscard]] const std::string& name() const override { return description_->name(); }
  [[nodiscard]] uint64_t size() const override { return description_->size(); }
  [[nodiscard]] Status read(uint64_t offset, std::span<std::byte> bytes) const override {
    return description_->read(offset, bytes);
  }
  void prefetch(std::span<const ByteRange> ranges) const override { description_->prefetch(ranges); }
  void forget(const ByteRange& range) const override { description_->forget(range); }
  [[nodiscard]] std::string version() const override { return description_->version(); }
  [[nodiscard]] int descriptor() const override { return description_->descriptor(); }
  void look_for_replacement() const override { description_->look_for_replacement(); }
  [[nodiscard]] bool replaced() const override { return description_->replaced() || folder_->replaced(); }
  [[nodiscard]] const FileFolder& folder() const { return *folder_; }

 private:
  std::unique_ptr<const ByteSource> description_;
  std::unique_ptr<const FileFolder> folder_;
};

class EptReader : public NodeReader {
 public:
  EptReader(std::unique_ptr<const ByteSource> description, std::unique_ptr<const FileFolder> folder,
            scan::EptDescription ept, scan::EptColumns columns, std::vector<std::byte> root)
      : source_(std::move(description), std::move(folder)),
        ept_(std::move(ept)),
        columns_(std::move(columns.columns)),
        root_(std::move(root)) {
    traits_.crs = ept_.crs;
    traits_.grid = columns.grid;
  }

  [[nodiscard]] const scan::RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<scan::ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] const ByteSource& source() const override { return source_; }
  void prefetch(std::span<const Node> nodes) const override {
    std::vector<std::string> names;
    names.reserve(nodes.size());
    for (const Node& node : nodes) names.push_back(name_of_tile(node));
    source_.folder().prefetch(names);
  }
  void forget(const Node& node) const override { source_.folder().forget(name_of_tile(node)); }

  [[nodiscard]] Result<scan::PointTable> read(const Node& node) const override {
    if (node.key.depth == 0) return points_of_tile(node, root_);
    const Result<std::vector<std::byte>> tile = source_.folder().read(name_of_tile(node), kMaxTile);
    if (!tile) return fail(tile);
    return points_of_tile(node, *tile);
  }

 private:
  [[nodiscard]] Result<scan::PointTable> points_of_tile(const Node& node, std::span<const std::byte> tile) const {
    Result<scan::PointTable> table = scan::ept_points(ept_, columns_, tile, node.points);
    if (table && table->rows != node.points) return invalid_input("has not the points that the hierarchy states");
    return table;
  }
  [[nodiscard]] std::string name_of_tile(const Node& node) const {
    return scan::ept_tile_name(ept_, ept_key(node.key));
  }

  const DescribedFolder source_;
  scan::EptDescription ept_;
  std::vector<scan::ColumnInfo> columns_;
  std::vector<std::byte> root_;  ///< its tile, which says what all tiles have
  scan::RowTraits traits_;
};

Result<scan::EptDescription> read_description(const ByteSource& file) {
  if (file.size() > kMaxDescription) return fail(ErrorKind::kLimit, "is too large for a description");
  std::vector<std::byte> bytes(file.size());
  if (Status status = file.read(0, bytes); !status) return fail(status);
  return scan::parse_ept(bytes);
}

Result<NodeTree> arrange_ept(const scan::EptDescription& ept, const scan::EptNodes& read) {
  const Result<Cells> cells = cells_below(ept.cube);
  if (!cells) return fail(cells);
  std::vector<Node> nodes;
  nodes.reserve(read.size());
  for (const auto& [key, points] : read) {
    Node node;
    node.key = {static_cast<uint8_t>(key[0]), key[1], key[2], key[3]};
    node.points = points;
    nodes.push_back(node);
  }
  return arrange_nodes(std::move(nodes), *cells, root_spacing(*cells, cells->side / ept.span));
}

}  // namespace

Result<OpenedTree> open_ept(std::unique_ptr<const ByteSource> description, std::unique_ptr<const FileFolder> folder,
                            uint64_t most_bytes) {
  Result<scan::EptDescription> ept = read_description(*description);
  if (!ept) return fail(ept);
  const Result<scan::EptNodes> nodes = scan::read_ept_nodes(*ept, *folder, {}, most_bytes);
  if (!nodes) return fail(nodes);
  Result<NodeTree> tree = arrange_ept(*ept, *nodes);
  if (!tree) return fail(tree);
  Result<std::vector<std::byte>> root = folder->read(scan::ept_tile_name(*ept, {0, 0, 0, 0}), kMaxTile);
  if (!root) return fail(root);
  Result<scan::EptColumns> columns = scan::ept_columns(*ept, *root);
  if (!columns) return fail(columns);
  OpenedTree opened;
  opened.bounds = ept->conforming;
  opened.tree = std::move(*tree);
  opened.reader = std::make_unique<const EptReader>(std::move(description), std::move(folder), std::move(*ept),
                                                    std::move(*columns), std::move(*root));
  return opened;
}

}  // namespace surfcast::point_tree
