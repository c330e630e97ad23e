#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/byte_source.h"
#include "base/result.h"
#include "model/decoded_block.h"
#include "model/georeference.h"

namespace surfcast::model {

struct ScalarColumn;

/// Where the blocks of a model come from: a model file, or what makes them of something else. Errors name neither model
/// nor block. Safe to use from several threads at once.
class BlockProvider {
 public:
  virtual ~BlockProvider() = default;

  /// See ModelFile.
  virtual void prefetch(std::span<const uint32_t> blocks) const = 0;
  virtual void forget(size_t block) const = 0;
  [[nodiscard]] virtual uint64_t unit_of(uint32_t block) const { return block; }
  [[nodiscard]] virtual Result<StoredBlock> stored(size_t block) const = 0;
  /// Of a block of surfels.
  [[nodiscard]] virtual Result<DecodedBlock> decode(size_t block, WantedScalars scalars) const = 0;
  /// The attributes of leaves, in order, with their types.
  [[nodiscard]] virtual std::span<const ScalarColumn> scalars() const = 0;
  [[nodiscard]] virtual Result<Georeference> georeference() const = 0;
  [[nodiscard]] virtual const ByteSource& source() const = 0;
};

}  // namespace surfcast::model
