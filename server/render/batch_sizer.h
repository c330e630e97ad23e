#pragma once

#include <cstddef>

namespace surfcast::render {

/// How many work groups of a pass are dispatched at a time. Between two batches a picture can be given up, so a batch
/// should take so little time that nobody feels it, and so much that starting it costs nothing beside it. The pace is
/// learnt from batch to batch, also across pictures: hardware soon gets whole passes, software small parts of them.
class BatchSizer {
 public:
  /// Work groups of the next batch, at least 1.
  [[nodiscard]] size_t groups() const { return groups_; }
  void record(size_t groups, double milliseconds);

 private:
  size_t groups_ = 256;
};

}  // namespace surfcast::render
