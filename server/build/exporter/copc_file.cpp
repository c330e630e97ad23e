#include <array>
#include <string_view>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "base/atomic_file.h"
#include "exporter/even_sample.h"
#include "exporter/las_bytes.h"
#include "exporter/las_coding.h"
#include "exporter/node_pages.h"
#include "exporter/octree_files.h"
#include "laz/laszip_record.h"

namespace surfcast::exporter {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::string_view kCopcUser = "copc";
constexpr size_t kInfoBytes = 160;
constexpr size_t kHierarchyEntry = 32;
constexpr size_t kExtendedHead = 60;

// Offsets in the public header block: LAS 1.4 specification, table 3.
constexpr size_t kFirstExtended = 235;
constexpr size_t kExtendedRecords = 243;

/// The chunk of a node.
struct CopcNode {
  uint64_t offset = 0;
  size_t bytes = 0;
  size_t points = 0;
};

/// Bytes and points are those of a chunk, or of a page and -1.
void add_entry(Bytes& page, const ldc::OctreeKey& key, uint64_t offset, size_t bytes, int32_t points) {
  add(page, static_cast<int32_t>(key.depth));
  for (const uint32_t place : {key.x, key.y, key.z}) add(page, static_cast<int32_t>(place));
  add(page, offset);
  add(page, static_cast<int32_t>(bytes));
  add(page, points);
}

class CopcFile : public NodeBatch {
 public:
  CopcFile(AtomicFile file, LasHead head, uint64_t most_bytes, size_t most_entries)
      : NodeBatch(most_bytes), file_(std::move(file)), head_(std::move(head)), most_entries_(most_entries) {}

  /// The info record comes first: readers look for it at a fixed place.
  Status write_head() {
    head_.compressed = true;
    head_.chunk_size = laz::kVariableChunks;
    head_.records.insert(head_.records.begin(), las_record(kCopcUser, 1, Bytes(kInfoBytes)));
    add_laszip_record(head_);
    const Bytes bytes = bytes_before_points(head_);
    data_offset_ = bytes.size() - sizeof(int64_t);
    return file_.append(bytes);
  }

  Result<uint64_t> finish(const OctreeFacts& facts) override {
    Status status = write_waiting();
    const size_t table = file_.position();
    if (status) status = file_.append(laz::encode_chunk_table(coding_of(head_), chunks_));
    const size_t hierarchy = file_.position();
    if (status) status = write_hierarchy();
    for (const Bytes& record : head_.extended) {
      if (status) status = file_.append(record);
    }
    if (status) status = complete_head(facts, table, hierarchy);
    const uint64_t bytes = file_.position();
    if (status) status = file_.commit();
    if (!status) return fail(status);
    return bytes;
  }

 private:
  Status write(std::vector<OctreeNode> nodes) override {
    std::vector<Bytes> coded(nodes.size());
    oneapi::tbb::parallel_for(size_t{0}, nodes.size(),
                              [&](size_t i) { coded[i] = laz::encode_chunk(coding_of(head_), nodes[i].records); });
    for (size_t i = 0; i < nodes.size(); ++i) {
      if (Status status = write_chunk(nodes[i], coded[i]); !status) return status;
    }
    return {};
  }

  Status write_chunk(const OctreeNode& node, const Bytes& coded) {
    const size_t points = node.records.size() / head_.record_length;
    keys_.push_back(node.key);
    nodes_.push_back({file_.position(), coded.size(), points});
    chunks_.push_back({points, coded.size()});
    return file_.append(coded);
  }

  /// The pages one after another in an extended record. The first is that of the root.
  Status write_hierarchy() {
    const std::vector<NodePage> pages = make_pages(keys_, most_entries_);
    std::vector<uint64_t> offsets{file_.position() + kExtendedHead};
    for (const NodePage& page : pages) offsets.push_back(offsets.back() + bytes_of(page));
    Bytes record(kExtendedHead);
    put_text(record, 2, kCopcUser);
    put(record, 18, uint16_t{1000});
    put(record, 20, offsets.back() - offsets.front());
    root_page_ = {offsets[0], offsets[1] - offsets[0]};
    for (const NodePage& page : pages) {
      for (const size_t i : page.nodes)
        add_entry(record, keys_[i], nodes_[i].offset, nodes_[i].bytes, static_cast<int32_t>(nodes_[i].points));
      for (const size_t i : page.subpages)
        add_entry(record, keys_[pages[i].nodes.front()], offsets[i], offsets[i + 1] - offsets[i], -1);
    }
    return file_.append(record);
  }

  static size_t bytes_of(const NodePage& page) { return kHierarchyEntry * (page.nodes.size() + page.subpages.size()); }

  Status complete_head(const OctreeFacts& facts, size_t table, size_t hierarchy) {
    head_.records.front() = las_record(kCopcUser, 1, info_record(facts));
    fill_in_header(head_, facts.counts, data_offset_);
    put(head_.header, kFirstExtended, uint64_t{hierarchy});
    put(head_.header, kExtendedRecords, static_cast<uint32_t>(head_.extended.size() + 1));
    Bytes bytes = bytes_before_points(head_);
    put(bytes, data_offset_, static_cast<int64_t>(table));
    return file_.overwrite(0, bytes);
  }

  [[nodiscard]] Bytes info_record(const OctreeFacts& facts) const {
    const double half = facts.cube.side / 2;
    Bytes info;
    for (int axis = 0; axis < 3; ++axis) add(info, facts.cube.min[axis] + half);
    add(info, half);
    add(info, facts.cube.side * kSampleSpacing);
    for (const uint64_t number : root_page_) add(info, number);
    add(info, facts.least_time);
    add(info, facts.most_time);
    info.resize(kInfoBytes);
    return info;
  }

  AtomicFile file_;
  LasHead head_;
  size_t most_entries_;
  size_t data_offset_ = 0;
  std::vector<ldc::OctreeKey> keys_;
  std::vector<CopcNode> nodes_;
  std::vector<laz::ChunkSize> chunks_;
  std::array<uint64_t, 2> root_page_{};  ///< offset and size
};

}  // namespace

Result<std::unique_ptr<NodeBatch>> create_copc(const std::filesystem::path& target, LasHead head, uint64_t most_bytes,
                                               size_t most_entries) {
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(file);
  auto copc = std::make_unique<CopcFile>(std::move(*file), std::move(head), most_bytes, most_entries);
  if (Status status = copc->write_head(); !status) return fail(status);
  return copc;
}

}  // namespace surfcast::exporter
