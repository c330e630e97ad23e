#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "base/result.h"
#include "kinds/source_block.h"
#include "model/model_file.h"
#include "residency/packed_block.h"

namespace surfcast::kinds {

/// The GLSL of a kind: texts that may include files of shaders/.
struct KindShaders {
  /// A compute shader that projects the texels of a chunk and appends a record for each item that is seen; see
  /// shaders/kinds/append_record.glsl.
  std::string_view project;
  /// Defines `Fragment NAME_fragment(uvec4 a, uvec4 b, uvec4 c, vec2 ray)`, NAME being the kind's: what the ray of a
  /// pixel meets of a record (shaders/kinds/exact_list.glsl). Empty of surfels, which the splat kernel is made of.
  std::string_view fragment;
};

/// What a block of a model may be made of: how it is read, packed, drawn and picked. The tree, selection, residency,
/// tile lists, compositing and the order of picks are the same for all kinds. Kinds are constants; all methods may be
/// called from several threads at once, and none of them once for every item. docs/kinds.md tells how a kind is added.
class Kind {
 public:
  virtual ~Kind() = default;

  /// As the model file has it; a GLSL identifier.
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// Reads, decodes and packs a block of the kind for the GPU, with PackedBlock::attributes or without.
  [[nodiscard]] virtual Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                            bool attributes) const = 0;
  /// Reads and decodes a block of the kind with all that the file says of it.
  [[nodiscard]] virtual Result<std::shared_ptr<const SourceBlock>> decode(const model::ModelFile& model,
                                                                          uint32_t block) const = 0;
  [[nodiscard]] virtual KindShaders shaders() const = 0;
};

}  // namespace surfcast::kinds
