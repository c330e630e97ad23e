#include "exporter/octree_file_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "exporter/octree_files.h"
#include "exporter/record_places.h"
#include "scan/scalar_type.h"

namespace surfcast::exporter {
namespace {

constexpr size_t kGpsTime = 22;  // in records of point formats from 6 on

class OctreeFileWriter : public RecordWriter {
 public:
  OctreeFileWriter(std::filesystem::path target, LasHead head, std::unique_ptr<NodeBatch> nodes,
                   const OctreeOptions& options)
      : target_(std::move(target)),
        head_(std::move(head)),
        nodes_(std::move(nodes)),
        options_(options),
        spool_(target_, head_.record_length, options.memory / 4) {}

  Status append(std::span<const std::byte> records) override {
    facts_.counts.add(records, head_);
    for (size_t at = 0; at < records.size(); at += head_.record_length) {
      const auto time = scan::load<double>(&records[at + kGpsTime]);
      if (!std::isfinite(time)) continue;
      least_time_ = std::min(least_time_, time);
      most_time_ = std::max(most_time_, time);
    }
    return spool_.append(records);
  }
  [[nodiscard]] uint64_t points() const override { return facts_.counts.points; }

  Result<uint64_t> finish() override {
    if (points() == 0) return fail(ErrorKind::kInvalidInput, target_.string() + ": an octree of no points");
    facts_.cube = cube_of(head_, facts_.counts);
    if (least_time_ <= most_time_) {
      facts_.least_time = least_time_;
      facts_.most_time = most_time_;
    }
    Status status = write_octree(spool_, head_, facts_.cube, target_, options_, *nodes_);
    if (!status) return fail(status);
    return nodes_->finish(facts_);
  }

 private:
  std::filesystem::path target_;
  LasHead head_;
  std::unique_ptr<NodeBatch> nodes_;
  OctreeOptions options_;
  RecordSpool spool_;
  OctreeFacts facts_;
  double least_time_ = std::numeric_limits<double>::infinity();
  double most_time_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

Result<std::unique_ptr<RecordWriter>> create_octree_file(const std::filesystem::path& target, LasHead head,
                                                         OctreeForm form, const OctreeOptions& options) {
  const uint64_t batch = options.memory / 8;
  const auto create = form == OctreeForm::kCopc ? create_copc : form == OctreeForm::kEpt ? create_ept : create_potree;
  Result<std::unique_ptr<NodeBatch>> nodes = create(target, head, batch, options.page_entries);
  if (!nodes) return fail(nodes);
  // Temporary files of a folder lie beside it.
  return std::make_unique<OctreeFileWriter>(form == OctreeForm::kCopc ? target : target.parent_path(), std::move(head),
                                            std::move(*nodes), options);
}

}  // namespace surfcast::exporter
