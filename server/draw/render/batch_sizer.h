#pragma once

#include <cstddef>

namespace surfcast::render {

/// Chooses the number of work groups of a pass that are dispatched at once. A picture can be cancelled or preempted
/// between two batches. So a batch should be short enough for a quick reaction, and long enough to make its overhead
/// negligible. The rate is measured with every batch, also across pictures: hardware GL soon gets whole passes,
/// software GL small parts of them. Lists of work begin with what takes longest, so a pass begins with as many groups
/// as fitted at the beginning of the pass before.
class BatchSizer {
 public:
  /// Before the first batch of a pass.
  void begin_pass();
  /// Work groups of the next batch, at least 1.
  [[nodiscard]] size_t groups() const { return groups_; }
  void record(size_t groups, double milliseconds);

 private:
  size_t groups_ = 256;
  size_t first_ = 256;  ///< of a pass
  bool begins_ = true;
};

}  // namespace surfcast::render
