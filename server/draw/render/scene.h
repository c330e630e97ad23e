#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#include "kinds/file_blocks.h"
#include "model/model_file.h"
#include "picture/picture.h"
#include "render/survey.h"
#include "residency/residency.h"

namespace surfcast::render {

/// The state of a viewer's motion between pictures.
struct ViewerHistory {
  uint64_t viewer = 0;
  std::optional<geometry::Camera> camera;
  std::vector<uint32_t> refined;  ///< see select_blocks
};

/// Records the camera of a picture in motion and predicts the camera some pictures later, by linear extrapolation from
/// the last picture. None if the camera does not move or there is no last picture.
std::optional<geometry::CameraFrame> update_and_extrapolate(ViewerHistory& history, const geometry::Camera& camera,
                                                            int width, int height);

/// A model that is being viewed.
class Scene {
 public:
  /// Fails if the model has blocks of a kind that is not in the table.
  static Result<std::unique_ptr<Scene>> create(const std::shared_ptr<const model::ModelFile>& model,
                                               kinds::KindTable kinds);

  [[nodiscard]] const model::ModelFile& model() const { return *model_; }
  [[nodiscard]] const residency::ViewedModel& viewed() const { return viewed_; }
  /// True if normals of some of its scans tell front from back.
  [[nodiscard]] bool has_fronts() const { return has_fronts_; }
  /// The number of a block's kind in the table of kinds.
  [[nodiscard]] uint32_t kind_of(uint32_t block) const { return blocks_->kind_of(block); }
  /// True if it has blocks of a kind that is drawn as surfaces.
  [[nodiscard]] bool has_surfaces() const { return kinds_.surfaces; }
  /// True if the model has blocks that are drawn in several ways: surfaces are then kept in layers.
  [[nodiscard]] bool mixed() const { return kinds_.mixed; }
  [[nodiscard]] bool has_gaussians() const { return kinds_.gaussians; }
  [[nodiscard]] bool has_glyphs() const { return kinds_.glyphs; }
  /// Per block the number of its glyphs; 0 for other kinds. Empty if the model has no glyphs.
  [[nodiscard]] const std::vector<uint32_t>& glyphs() const { return glyphs_; }
  /// Number of surfels in the blocks before this one, modulo 2^32: the index of its first surfel in the model.
  [[nodiscard]] uint32_t first_surfel(uint32_t block) const { return first_surfels_[block]; }
  /// The requested camera, or one that shows the whole model.
  [[nodiscard]] geometry::Camera camera_of(const picture::PictureRequest& request) const;

  /// The history of a viewer. Only the `most` most recently seen viewers are remembered.
  ViewerHistory& history_of(uint64_t viewer, size_t most);
  Surveys& surveys() { return surveys_; }

 private:
  struct Kinds {
    bool surfaces = false;
    bool gaussians = false;
    bool glyphs = false;
    bool mixed = false;
  };

  Scene(std::shared_ptr<const model::ModelFile> model, std::shared_ptr<const kinds::FileBlocks> blocks,
        const Kinds& kinds);

  std::shared_ptr<const model::ModelFile> model_;
  std::shared_ptr<const kinds::FileBlocks> blocks_;
  residency::ViewedModel viewed_;
  std::vector<uint32_t> first_surfels_;
  std::vector<uint32_t> glyphs_;
  Kinds kinds_;
  bool has_fronts_;
  std::list<ViewerHistory> viewers_;  ///< most recently seen first
  Surveys surveys_;
};

}  // namespace surfcast::render
