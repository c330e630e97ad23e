#pragma once

#include <span>
#include <vector>

#include "render/transfer_function.h"
#include "render/volume_plan.h"
#include "volume/brick.h"

namespace surfcast::render {

/// A plane in source indices: dot(normal, index) = distance; the normal has the length 1.
struct IndexPlane {
  glm::dvec3 normal{0, 0, 1};
  double distance = 0;
};

IndexPlane index_plane(const picture::Slice& slice, const VolumePlace& place);

/// What of one volume may be seen, by its values and by its place.
class VisibleParts {
 public:
  VisibleParts(const VolumeLook& look, const VolumePlace& place);

  /// True if the transfer function or an iso-surface shows something of the values in [low, high].
  [[nodiscard]] bool within(double low, double high) const;
  [[nodiscard]] bool sliced() const { return !slices_.empty(); }
  /// True if a slice cuts the box or lies on a face.
  [[nodiscard]] bool cut(const volume::IndexBox& box) const;
  /// Sets the bits of the sub-bricks (SURFCAST_UNIT_SEEN) in which there may be an iso-surface or a slice.
  void mark_surfaces(const kinds::BrickBlock& block, std::span<uint32_t, SURFCAST_SEEN_WORDS> words) const;

 private:
  [[nodiscard]] bool has_iso(const volume::BrickHeader& header, const volume::CodeRange& range) const;

  TransferFunction medium_;
  std::vector<double> isos_;
  std::vector<IndexPlane> slices_;
};

}  // namespace surfcast::render
