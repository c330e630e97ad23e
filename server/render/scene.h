#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#include "kinds/file_blocks.h"
#include "model/model_file.h"
#include "picture/picture.h"
#include "residency/residency.h"

namespace surfcast::render {

/// What is remembered of somebody's motion from picture to picture.
struct ViewerHistory {
  uint64_t viewer = 0;
  std::optional<geometry::Camera> camera;
  std::vector<uint32_t> refined;  ///< see select_blocks
};

/// Notes a picture that did not wait. Where the camera will be some pictures later if it goes on as since the last one;
/// none if it does not move or nothing is known.
std::optional<geometry::CameraFrame> update_and_extrapolate(ViewerHistory& history, const geometry::Camera& camera,
                                                            int width, int height);

/// A model that is being looked at.
class Scene {
 public:
  /// Fails when the model has blocks of a kind that is not in the table.
  static Result<std::unique_ptr<Scene>> create(const std::shared_ptr<const model::ModelFile>& model,
                                               kinds::KindTable kinds);

  [[nodiscard]] const model::ModelFile& model() const { return *model_; }
  [[nodiscard]] const residency::ViewedModel& viewed() const { return viewed_; }
  /// Number of a block's kind in the table.
  [[nodiscard]] uint32_t kind_of(uint32_t block) const { return blocks_->kind_of(block); }
  /// Surfels of the blocks before this one: where its surfels begin among all of the model, modulo 2^32.
  [[nodiscard]] uint32_t first_surfel(uint32_t block) const { return first_surfels_[block]; }
  /// The camera asked for, or one that fits the model.
  [[nodiscard]] geometry::Camera camera_of(const picture::PictureRequest& request) const;

  /// Memory of that viewer, new if it has not been seen for long: the last `most` viewers are remembered.
  ViewerHistory& history_of(uint64_t viewer, size_t most);

 private:
  Scene(std::shared_ptr<const model::ModelFile> model, std::shared_ptr<const kinds::FileBlocks> blocks);

  std::shared_ptr<const model::ModelFile> model_;
  std::shared_ptr<const kinds::FileBlocks> blocks_;
  residency::ViewedModel viewed_;
  std::vector<uint32_t> first_surfels_;
  std::list<ViewerHistory> viewers_;  ///< most recent first
};

}  // namespace surfcast::render
