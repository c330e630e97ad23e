#pragma once

#include <string>
#include <vector>

#include "kinds/opaque_disc.h"
#include "kinds/source_block.h"
#include "model/model_file.h"

namespace surfcast::kinds {

/// A decoded block of surfels for picking.
class DecodedSurfels : public SourceBlock {
 public:
  /// `own`: of the member that a block of a joined model is from; its normals may tell front from back, and it has
  /// the colours and attributes that are told.
  DecodedSurfels(model::DecodedBlock block, const model::ModelInfo& info, const model::ModelInfo& own);

  [[nodiscard]] size_t bytes() const override;
  /// Tests the opaque discs of the surfels (hit_disc).
  void hit(const PickQuery& query, std::vector<PickHit>& hits) const override;
  void cover(const PickQuery& query, PixelHits& pixels) const override;
  [[nodiscard]] PickedSurfel describe(const PickQuery& query, uint32_t surfel) const override;

 private:
  /// The classification code; none if the model has no classes.
  [[nodiscard]] std::optional<uint8_t> class_of(size_t surfel) const;
  [[nodiscard]] double opacity_of_scan(size_t surfel) const;
  /// The share of the light that the surfel's disc takes; 0 if it is not shown.
  [[nodiscard]] double opacity_of(const PickQuery& query, size_t surfel) const;
  struct DrawnDisc {
    glm::dvec3 o;  ///< centre
    glm::dvec3 n;  ///< unit normal
    double radius = 0;
    std::optional<surfel::OsculatingSurface> surface{};  ///< of a surfel with curvature or a border
    std::optional<surfel::Border> border{};
  };
  /// Where the ray meets what is drawn.
  [[nodiscard]] std::optional<DiscHit> meet(const DrawnDisc& drawn, const PickQuery& query,
                                            const glm::dvec3& ray) const;
  /// `widest`: the largest radius of a disc that is no scatter.
  [[nodiscard]] std::optional<DrawnDisc> disc_of(const PickQuery& query, size_t surfel, float widest) const;
  [[nodiscard]] glm::dvec3 normal_of(const PickQuery& query, size_t surfel) const;
  [[nodiscard]] glm::u8vec3 color_of(size_t surfel) const;
  [[nodiscard]] ItemLook look_of(const PickQuery& query, size_t surfel) const;

  model::DecodedBlock block_;
  surfel::CurvatureColumns curvature_;  ///< of the block
  bool oriented_;
  int color_bits_;
  bool colored_;
  std::vector<std::string> told_;  ///< attributes
};

}  // namespace surfcast::kinds
