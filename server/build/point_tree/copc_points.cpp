#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/invalid_input.h"
#include "laz/laz_file.h"
#include "point_tree/tree_formats.h"
#include "scan/copc_index.h"
#include "scan/las_header.h"
#include "scan/las_reader.h"

namespace surfcast::point_tree {
namespace {

/// The bytes of a file before its points, and what they say.
struct LasHead {
  std::vector<std::byte> bytes;
  scan::LasHeader header;  ///< refers to the bytes
};

/// Where the header of LAS 1.4 states what is read here.
constexpr size_t kHeaderBytes = 375;
constexpr size_t kDataOffsetAt = 96;
constexpr size_t kBoundsAt = 179;
/// More than the records before the points have.
constexpr uint64_t kMaxHead = uint64_t{16} << 20;
/// Of the points of a node.
constexpr uint64_t kMaxRecordBytes = uint64_t{256} << 20;

Result<LasHead> read_head(const ByteSource& file) {
  LasHead head;
  head.bytes.resize(std::min<uint64_t>(kHeaderBytes, file.size()));
  if (Status status = file.read(0, head.bytes); !status) return fail(status);
  const bool las = head.bytes.size() == kHeaderBytes &&
                   std::equal(head.bytes.begin(), head.bytes.begin() + 4, reinterpret_cast<const std::byte*>("LASF"));
  if (!las) return invalid_input("is no COPC file");
  const uint64_t size = scan::load<uint32_t>(&head.bytes[kDataOffsetAt]);
  if (size > std::min(kMaxHead, file.size())) return invalid_input("the LAS points begin too far within the file");
  head.bytes.resize(std::max<uint64_t>(size, kHeaderBytes));
  if (Status status = file.read(0, head.bytes); !status) return fail(status);
  Result<scan::LasHeader> header = scan::parse_las_header(head.bytes);
  if (!header) return fail(header);
  if (header->copc_record.empty() || !header->compressed || header->laszip_record.empty()) {
    return invalid_input("is LAS or LAZ, but no COPC file: it has no hierarchy");
  }
  head.header = std::move(*header);
  return head;
}

/// The bounds that the header states; empty if they make no sense.
geometry::Box stated_bounds(std::span<const std::byte> head) {
  geometry::Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t at = kBoundsAt + 16 * static_cast<size_t>(axis);
    box.max[axis] = scan::load<double>(&head[at]);
    box.min[axis] = scan::load<double>(&head[at + 8]);
    if (!std::isfinite(box.min[axis]) || !std::isfinite(box.max[axis]) || box.min[axis] > box.max[axis]) return {};
  }
  return box;
}

class CopcReader : public NodeReader {
 public:
  CopcReader(std::unique_ptr<const ByteSource> file, LasHead head)
      : file_(std::move(file)),
        head_(std::move(head)),
        traits_(scan::las_traits(head_.header)),
        columns_(scan::las_columns(head_.header)) {}

  [[nodiscard]] const scan::RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<scan::ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] const ByteSource& source() const override { return *file_; }
  void prefetch(std::span<const Node> nodes) const override {
    std::vector<ByteRange> ranges;
    ranges.reserve(nodes.size());
    for (const Node& node : nodes) ranges.push_back(node.bytes);
    file_->prefetch(ranges);
  }
  void forget(const Node& node) const override { file_->forget(node.bytes); }

  [[nodiscard]] Result<scan::PointTable> read(const Node& node) const override {
    std::vector<std::byte> bytes(node.bytes.size);
    if (Status status = file_->read(node.bytes.offset, bytes); !status) return fail(status);
    const laz::Chunk chunk{0, node.points, 0, bytes.size()};
    const scan::LasHeader& header = head_.header;
    const laz::LazPoints points{header.point_format, header.record_length, node.points, 0};
    const Result<laz::LazFile> file = laz::LazFile::open_chunks(bytes, points, header.laszip_record, {chunk});
    if (!file) return fail(file);
    Result<laz::LazChunkReader> reader = file->read_chunk(chunk);
    if (!reader) return fail(reader);
    std::vector<std::byte> records(node.points * header.record_length);
    if (Status status = reader->read(records); !status) return fail(status);
    scan::PointTable table = scan::las_table(records.data(), node.points, header);
    table.records = std::move(records);
    return table;
  }

 private:
  std::unique_ptr<const ByteSource> file_;
  LasHead head_;
  scan::RowTraits traits_;
  std::vector<scan::ColumnInfo> columns_;
};

/// The nodes of the hierarchy, whose chunks are checked: each lies within the file and may have its points.
Result<std::vector<Node>> checked_nodes(const scan::CopcNodes& read, size_t record_length, uint64_t file_bytes) {
  std::vector<Node> nodes;
  nodes.reserve(read.nodes.size());
  uint64_t chunk_bytes = 0;
  for (const scan::CopcNode& from : read.nodes) {
    const Node node{{static_cast<uint8_t>(from.level), static_cast<uint32_t>(from.place.x),
                     static_cast<uint32_t>(from.place.y), static_cast<uint32_t>(from.place.z)},
                    from.points,
                    from.points > 0 ? from.chunk : ByteRange()};
    const laz::Chunk chunk{0, node.points, node.bytes.offset, node.bytes.size};
    const Status sound = node.points > 0 ? laz::check_chunk(chunk, record_length, file_bytes) : Status();
    if (!sound) return fail(sound);
    if (node.points > kMaxRecordBytes / record_length) return invalid_input("a node has too many points to be decoded");
    chunk_bytes += node.bytes.size;
    nodes.push_back(node);
  }
  if (chunk_bytes > file_bytes) return invalid_input("the chunks of its nodes overlap");
  return nodes;
}

}  // namespace

Result<OpenedTree> open_copc(std::unique_ptr<const ByteSource> file, uint64_t most_bytes) {
  Result<LasHead> head = read_head(*file);
  if (!head) return fail(head);
  const Result<scan::CopcInfo> info = scan::read_copc_info(head->header.copc_record);
  if (!info) return fail(info);
  const Result<scan::CopcNodes> read = scan::read_copc_nodes(*file, *info, {}, most_bytes);
  if (!read) return fail(read);
  Result<std::vector<Node>> nodes = checked_nodes(*read, head->header.record_length, file->size());
  if (!nodes) return fail(nodes);
  const Cells cells{info->low, info->side};
  Result<NodeTree> tree = arrange_nodes(std::move(*nodes), cells, root_spacing(cells, info->spacing));
  if (!tree) return fail(tree);
  OpenedTree opened;
  opened.bounds = stated_bounds(head->bytes);
  opened.tree = std::move(*tree);
  opened.reader = std::make_unique<const CopcReader>(std::move(file), std::move(*head));
  return opened;
}

}  // namespace surfcast::point_tree
