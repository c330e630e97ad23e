#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scattered/field_lattice.h"
#include "scattered/field_options.h"
#include "scattered/read_samples.h"

namespace surfcast::scattered {

/// Planes of a lattice that are evaluated together.
inline constexpr uint32_t kSlabPlanes = 8;

/// How sums of kernels become values.
struct Combining {
  Combination combination = Combination::kSum;
  double background = 0;    ///< of kAverage
  double least_weight = 0;  ///< of kAverage, above 0
};

/// The background is the lowest value unless the options state one.
[[nodiscard]] Combining combining_of(const FieldOptions& options, const Samples& samples);

/// Sums of kernels on a lattice, or on some of its planes: i fastest, then j, then k.
struct KernelSums {
  std::vector<double> sums;     ///< of v W
  std::vector<double> weights;  ///< of W; empty unless they are asked for
};

/// Some samples on a lattice, a slab of planes at a time. Every sum is taken in double precision in the order of the
/// samples, so it does not depend on the number of threads.
class KernelLevel {
 public:
  /// `samples` must outlive this; `members` are those of the level.
  KernelLevel(const Samples& samples, std::span<const uint32_t> members, const FieldLattice& lattice, bool weights);

  [[nodiscard]] const FieldLattice& lattice() const { return lattice_; }
  [[nodiscard]] uint32_t slabs() const { return (lattice_.size.z + kSlabPlanes - 1) / kSlabPlanes; }
  /// Planes of a slab.
  [[nodiscard]] uint32_t planes_of(uint32_t slab) const;
  /// The sums of a slab.
  [[nodiscard]] KernelSums evaluate(uint32_t slab) const;

 private:
  struct Tile;
  void add(const KernelSample& sample, Tile& tile) const;

  const Samples& samples_;
  FieldLattice lattice_;
  bool weights_ = false;
  std::vector<uint64_t> first_;    ///< of each slab, where its samples begin in members_
  std::vector<uint32_t> members_;  ///< samples whose kernels reach into each slab
};

/// Evaluates a field on its lattice. The simple way would be to visit all samples of the lattice within each kernel.
/// Wide kernels would take the time of thousands of others, so they are summed on a coarser lattice that resolves them
/// well, and brought to the finer one by interpolation of degree five. Without wide kernels there is one lattice.
class FieldPlanes {
 public:
  /// The samples must outlive this.
  FieldPlanes(const Samples& samples, const FieldLattice& lattice, const Combining& combining);

  /// Memory of the coarser lattices, bytes.
  [[nodiscard]] static uint64_t bytes_for(const FieldLattice& lattice);

  [[nodiscard]] uint32_t slabs() const { return finest_.slabs(); }
  [[nodiscard]] uint32_t planes_of(uint32_t slab) const { return finest_.planes_of(slab); }
  /// Lattices in use.
  [[nodiscard]] size_t levels() const { return levels_; }
  /// The values of a slab: i fastest, then j, then k. `values` are size.x * size.y * planes_of(slab).
  void evaluate(uint32_t slab, std::span<float> values) const;

 private:
  FieldPlanes(const Samples& samples, const FieldLattice& lattice, const Combining& combining,
              const std::vector<std::vector<uint32_t>>& levels);

  const Combining combining_;
  const KernelLevel finest_;
  const size_t levels_;
  KernelSums coarse_;  ///< of all wide kernels, on a lattice of twice the step
  glm::u32vec3 coarse_size_{0};
};

}  // namespace surfcast::scattered
