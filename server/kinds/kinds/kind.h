#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "base/result.h"
#include "kinds/source_block.h"
#include "model/model_file.h"
#include "residency/packed_block.h"

namespace surfcast::kinds {

/// The GLSL sources of a kind. They may include files of shaders/.
struct KindShaders {
  /// A compute shader that projects the texels of a chunk and appends a record for each visible item; see
  /// shaders/kinds/append_record.glsl. Empty for kinds that are drawn by a pass of their own.
  std::string_view project;
  /// Defines `Fragment NAME_fragment(uvec4 a, uvec4 b, uvec4 c, vec2 ray)`, where NAME is the name of the kind. The
  /// function returns the fragment of a record at the ray of a pixel (shaders/kinds/exact_list.glsl). Empty for
  /// surfels, which are built into the splat kernel.
  std::string_view fragment;
};

/// How the items of a kind become a picture.
enum class DrawnAs {
  kSurface,    ///< layers of the splat kernel
  kGaussians,  ///< composited one by one, sorted by depth (render/gaussian_passes.h)
  kGlyphs,     ///< opaque, the nearest of each sample (render/ellipsoid_passes.h); their headers are GlyphBlocks
  kVolume,     ///< sampled along rays (render/volume_passes.h); the headers of its blocks are BrickBlocks
};

/// The kind of the items in a block of a model. It determines how blocks are read, packed, drawn and picked. The tree,
/// selection, residency, tile lists, compositing and the order of picks are the same for all kinds. Kinds are
/// constants. All methods may be called from several threads at once. No method is called once per item. docs/kinds.md
/// describes how to add a kind.
class Kind {
 public:
  virtual ~Kind() = default;

  /// The name in model files; a GLSL identifier.
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// Reads, decodes and packs a block of this kind for the GPU, with or without PackedBlock::attributes.
  [[nodiscard]] virtual Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                            bool attributes) const = 0;
  /// Reads and decodes a block of this kind with all attributes in the file.
  [[nodiscard]] virtual Result<std::shared_ptr<const SourceBlock>> decode(const model::ModelFile& model,
                                                                          uint32_t block) const = 0;
  /// Empty for kinds that are not drawn as surfaces.
  [[nodiscard]] virtual KindShaders shaders() const = 0;
  [[nodiscard]] virtual DrawnAs drawn_as() const { return DrawnAs::kSurface; }
  /// The most texels of a block of so many items in a model.
  [[nodiscard]] virtual uint64_t texels(const model::ModelInfo& /*info*/, uint32_t items) const {
    return uint64_t{residency::kMaxPackedPerSurfel} * items;
  }
};

}  // namespace surfcast::kinds
