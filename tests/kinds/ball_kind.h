#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "kinds/kind.h"
#include "model/block_encoder.h"

namespace surfcast::testing {

/// An opaque sphere of one colour. Its centre is stored exactly if it is a multiple of 1/1024.
struct Ball {
  glm::dvec3 centre{0};
  float radius = 1;
  glm::u8vec3 color{255};  ///< sRGB
};

model::EncodedBlock encode_balls(std::span<const Ball> balls);

/// Balls as a kind, ray-cast exactly: an example of everything that a kind outside the table of built-in kinds
/// provides.
class BallKind : public kinds::Kind {
 public:
  [[nodiscard]] std::string_view name() const override { return "ball"; }
  [[nodiscard]] Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                    bool attributes) const override;
  [[nodiscard]] Result<std::shared_ptr<const kinds::SourceBlock>> decode(const model::ModelFile& model,
                                                                         uint32_t block) const override;
  [[nodiscard]] kinds::KindShaders shaders() const override;
};

}  // namespace surfcast::testing
