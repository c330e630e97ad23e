#pragma once

#include <filesystem>
#include <glm/mat4x3.hpp>
#include <span>

#include "kinds/kind.h"
#include "kinds/kind_table.h"
#include "model/model_writer.h"
#include "reference/volume_grid.h"
#include "volume/brick.h"

namespace surfcast::testing {

/// Bricks with their codes as they are and the place of their volume: a kind of blocks for tests of drawing.
class PlainBrickKind : public kinds::Kind {
 public:
  [[nodiscard]] std::string_view name() const override { return "plain_brick"; }
  [[nodiscard]] Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                    bool attributes) const override;
  [[nodiscard]] Result<std::shared_ptr<const kinds::SourceBlock>> decode(const model::ModelFile& model,
                                                                         uint32_t block) const override;
  [[nodiscard]] kinds::KindShaders shaders() const override { return {}; }
  [[nodiscard]] kinds::DrawnAs drawn_as() const override { return kinds::DrawnAs::kVolume; }
};

/// The table of kinds with surfels and plain bricks.
kinds::KindTable kinds_with_plain_bricks();

/// The order of the bricks of a level in the file.
enum class BrickOrder { kForward, kReversed };

/// Adds all levels of a grid to a model. Codes have 16 bits over the range of the grid's values.
void add_volume(model::ModelWriter& writer, const reference::VolumeGrid& grid, BrickOrder order = BrickOrder::kForward);
/// Writes a model of one volume.
std::filesystem::path write_volume(const std::filesystem::path& target, const reference::VolumeGrid& grid);
/// The grid with the values that the codes of the bricks stand for.
reference::VolumeGrid as_stored(const reference::VolumeGrid& grid);

}  // namespace surfcast::testing
