#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "exporter/las_bytes.h"
#include "exporter/las_coding.h"
#include "exporter/las_table.h"
#include "exporter/point_encoders.h"
#include "exporter/table_format.h"

namespace surfcast::exporter {
namespace {

/// As of the records that the points become.
LasCounts las_counts_of(const PointFacts& facts, const surfel::Grid& grid) {
  LasCounts counts;
  counts.points = facts.count;
  counts.returns = facts.returns;
  counts.low.fill(0);
  counts.high.fill(0);
  if (facts.count == 0) return counts;
  const glm::i64vec3 low = grid.index(facts.bounds.min), high = grid.index(facts.bounds.max);
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, most] = std::minmax(low[axis], high[axis]);  // a scale may be negative
    counts.low.at(static_cast<size_t>(axis)) = static_cast<int32_t>(least);
    counts.high.at(static_cast<size_t>(axis)) = static_cast<int32_t>(most);
  }
  return counts;
}

class LasEncoder : public PointEncoder {
 public:
  LasEncoder(LasTable table, const PointFacts& facts)
      : table_(std::move(table)), counts_(las_counts_of(facts, table_.grid)), rounds_(facts.grid != table_.grid) {}

  std::vector<std::byte> head() override {
    LasHead& head = table_.head;
    add_laszip_record(head);
    position_ = bytes_before_points(head).size();
    fill_in_header(head, counts_, position_ - (head.compressed ? sizeof(int64_t) : 0));
    return bytes_before_points(head);
  }

  Result<std::vector<std::byte>> rows(const scan::ScanPoints& points) override {
    Result<std::vector<std::byte>> records = las_records_of(points, table_);
    if (!records || !table_.head.compressed) return records;
    add_bytes(waiting_, *records);
    const size_t chunk = table_.head.chunk_size * table_.head.record_length;
    std::vector<std::byte> coded;
    size_t done = 0;
    for (; waiting_.size() - done >= chunk; done += chunk) add_chunk(std::span(waiting_).subspan(done, chunk), coded);
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
    return coded;
  }

  /// The chunk table, and its place in the last bytes of the file.
  std::vector<std::byte> tail() override {
    std::vector<std::byte> bytes;
    if (!table_.head.compressed) return bytes;
    if (!waiting_.empty()) add_chunk(waiting_, bytes);
    const auto place = static_cast<int64_t>(position_);
    add_bytes(bytes, laz::encode_chunk_table(coding_of(table_.head), chunks_));
    add(bytes, place);
    return bytes;
  }
  [[nodiscard]] std::string note() const override {
    return rounds_ ? "coordinates are rounded to multiples of " + shortest(table_.grid.scale.x) : std::string();
  }

 private:
  void add_chunk(std::span<const std::byte> records, std::vector<std::byte>& bytes) {
    const std::vector<std::byte> coded = laz::encode_chunk(coding_of(table_.head), records);
    chunks_.push_back({records.size() / table_.head.record_length, coded.size()});
    position_ += coded.size();
    add_bytes(bytes, coded);
  }

  LasTable table_;
  LasCounts counts_;
  bool rounds_;                     ///< coordinates, to another lattice than theirs
  std::vector<std::byte> waiting_;  ///< records that do not fill a chunk yet
  std::vector<laz::ChunkSize> chunks_;
  size_t position_ = 0;  ///< behind the last chunk
};

}  // namespace

Result<std::unique_ptr<PointEncoder>> make_las_encoder(const scan::ScanSchema& schema, const PointFacts& facts,
                                                       const EncoderOptions& options, bool compressed) {
  geometry::Box bounds = facts.bounds;
  if (facts.count == 0) bounds.include(glm::dvec3(0));
  Result<LasTable> table = plan_las_table({&schema, bounds, facts.count, options.scale, compressed});
  if (!table) return fail(table);
  table->head.chunk_size = options.chunk_size.value_or(table->head.chunk_size);
  return std::make_unique<LasEncoder>(std::move(*table), facts);
}

}  // namespace surfcast::exporter
