#pragma once

#include "base/result.h"
#include "residency/block_source.h"

namespace surfcast::residency {

/// Is told which blocks are being loaded, on the threads that load them.
class LoadGuard {
 public:
  virtual ~LoadGuard() = default;

  /// Called before a block is loaded. An error becomes the result of loading it; `leave` is not called then.
  [[nodiscard]] virtual Status enter(const BlockId& id) = 0;
  /// Called after a block has been loaded, on the thread of `enter`.
  virtual void leave(const BlockId& id) = 0;
};

}  // namespace surfcast::residency
