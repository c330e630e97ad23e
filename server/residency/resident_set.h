#pragma once

#include <cstdint>
#include <list>

#include "residency/resident_model.h"

namespace surfcast {

/// The models that are on the GPU, within a budget of bytes: the one drawn least recently goes first. A model larger
/// than the whole budget is held alone.
class ResidentSet {
 public:
  explicit ResidentSet(size_t budget_bytes) : budget_(budget_bytes) {}

  /// Loads the model unless it is here. The pointer is good until the next call.
  Result<const ResidentModel*> require(const ModelFile& model);
  void forget(const ModelFile& model);
  [[nodiscard]] size_t gpu_bytes() const;

 private:
  struct Entry {
    uint64_t model;  ///< ModelFile::id
    ResidentModel resident;
  };

  size_t budget_;
  std::list<Entry> entries_;  ///< most recently drawn first
};

}  // namespace surfcast
