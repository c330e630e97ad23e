#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>

#include "kinds/source_block.h"
#include "kinds/volume_sight.h"
#include "model/volume.h"
#include "volume/brick.h"

namespace surfcast::kinds {

/// A decoded brick. Its items are its samples, i fastest. A ray meets iso-surfaces, slices and, in stretches of little
/// opacity, what the transfer function shows; a hit names the sample next to it.
class GridBlock : public SourceBlock {
 public:
  GridBlock(volume::Brick brick, const model::Volume& volume);

  [[nodiscard]] size_t bytes() const override { return brick_.codes.size() * sizeof(uint16_t); }
  void hit(const PickQuery& query, std::vector<PickHit>& hits) const override;
  void cover(const PickQuery& query, PixelHits& pixels) const override;
  [[nodiscard]] PickedSurfel describe(const PickQuery& query, uint32_t item) const override;

 private:
  /// The field at a place and its derivatives by the source index.
  struct Field {
    double value = 0;
    glm::dvec3 gradient{0};
  };
  class Ray;

  [[nodiscard]] Field field_at(const glm::dvec3& index) const;
  [[nodiscard]] glm::dvec3 stored_index(const glm::dvec3& index) const;
  [[nodiscard]] uint32_t nearest_sample(const glm::dvec3& index) const;
  [[nodiscard]] glm::dvec3 normal_of(const Field& field) const;
  [[nodiscard]] PixelRange pixels_of(const geometry::CameraFrame& frame, const PixelRange& within) const;
  [[nodiscard]] bool may_show(const VolumeSight& sight) const;

  volume::Brick brick_;
  glm::u32vec3 size_;
  glm::dvec3 origin_;
  glm::dmat3 axes_;
  glm::dmat3 to_index_;
  volume::IndexBox box_;
};

}  // namespace surfcast::kinds
