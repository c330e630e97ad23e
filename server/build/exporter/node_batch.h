#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "exporter/point_octree.h"

namespace surfcast::exporter {

/// What a file states of the octree of its points as a whole.
struct OctreeFacts {
  LasCounts counts;
  geometry::RootCube cube;
  double least_time = 0;  ///< GPS time
  double most_time = 0;
};

/// A node that is to be written.
struct OctreeNode {
  ldc::OctreeKey key;
  std::vector<std::byte> records;
};

/// Collects nodes, so that many are encoded at once.
class NodeBatch : public NodeWriter {
 public:
  /// `most_bytes`: of records that wait.
  explicit NodeBatch(uint64_t most_bytes) : most_bytes_(most_bytes) {}

  Status take(const ldc::OctreeKey& key, std::vector<std::byte> records) override {
    waiting_bytes_ += records.size();
    waiting_.push_back({key, std::move(records)});
    return waiting_bytes_ < most_bytes_ ? Status() : write_waiting();
  }
  /// Call after the last node. Bytes that were written.
  virtual Result<uint64_t> finish(const OctreeFacts& facts) = 0;

 protected:
  Status write_waiting() {
    waiting_bytes_ = 0;
    return write(std::exchange(waiting_, {}));
  }

 private:
  virtual Status write(std::vector<OctreeNode> nodes) = 0;

  uint64_t most_bytes_;
  uint64_t waiting_bytes_ = 0;
  std::vector<OctreeNode> waiting_;
};

}  // namespace surfcast::exporter
