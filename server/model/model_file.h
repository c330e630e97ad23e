#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "geometry/box.h"
#include "ldc/block_tree.h"
#include "model/kind_count.h"
#include "model/statistics.h"
#include "surfel/grid.h"
#include "surfel/scalar_attribute.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::model {

/// What the header of a model says about all its blocks.
struct ModelInfo {
  uint64_t surfels = 0;                   ///< of the source: those of the leaves of the tree
  std::vector<KindCount> kinds;           ///< what the blocks are made of; BlockEntry::kind counts these
  int levels = 0;                         ///< of detail; 1 without coarser ones
  geometry::Box bounds;                   ///< of the stored positions, world units
  bool oriented = false;                  ///< see SurfelCloud::oriented
  bool z_up = true;                       ///< see SurfelCloud::z_up
  int color_bits = 0;                     ///< 8 or 16; 0: the scan has no colour and no block stores any
  std::vector<std::string> scalar_names;  ///< attributes of the leaves, in order
  std::vector<std::string> source_names;  ///< the input files
  std::vector<AttributeRange> ranges;     ///< of the attributes that have numbers; empty: the file does not state them
  std::vector<ClassCount> classes;        ///< by code, those that occur; likewise

  /// Null if it is not stated.
  [[nodiscard]] const AttributeRange* range_of(std::string_view attribute) const {
    for (const AttributeRange& range : ranges) {
      if (range.attribute == attribute) return &range;
    }
    return nullptr;
  }
};

/// A block as it comes out of Draco: structure of arrays of one length.
struct DecodedBlock {
  surfel::Grid grid;
  glm::i64vec3 origin{0};            ///< lattice index that `indices` count from
  std::vector<glm::ivec3> indices;   ///< non-negative lattice steps from `origin`
  std::vector<glm::vec3> normals;    ///< unit
  std::vector<float> radii;          ///< world units
  std::vector<float> weights;        ///< s_k
  std::vector<glm::u16vec3> colors;  ///< in ModelInfo::color_bits; empty without colour
  /// Of a leaf as ModelInfo::scalar_names. Coarse blocks have only those of them that can be averaged, intensity and
  /// classification. The first of these, if not all were wanted.
  std::vector<surfel::ScalarAttribute> scalars;

  [[nodiscard]] size_t size() const { return indices.size(); }
  /// World coordinates of surfel i, exact for inputs on a grid.
  [[nodiscard]] glm::dvec3 position(size_t i) const { return grid.position(origin + glm::i64vec3(indices[i])); }
};

/// A block as the file has it.
struct StoredBlock {
  std::span<const std::byte> bytes;  ///< good as long as the file is open
  surfel::Grid grid;
  glm::i64vec3 origin{0};  ///< lattice index of the lowest corner of its bounds
  glm::u32vec3 extent{0};  ///< of the highest one, counted from `origin`
  uint32_t items = 0;      ///< surfels, or what else its kind is made of
};

/// The scalar attributes that somebody needs of a block. Decoding others takes as long as all that is drawn.
enum class WantedScalars {
  kNone,
  kDrawn,  ///< at least those by which surfels are coloured or hidden, which coarse blocks have, too
  kAll,
};

/// An open model file. All methods are const and safe to call from several threads at once.
class ModelFile {
 public:
  static Result<ModelFile> open(const std::filesystem::path& path);

  ModelFile(ModelFile&&) noexcept;
  ModelFile& operator=(ModelFile&&) noexcept;
  ~ModelFile();

  [[nodiscard]] const ModelInfo& info() const;
  [[nodiscard]] const ldc::BlockTree& tree() const;
  [[nodiscard]] std::span<const ldc::BlockEntry> blocks() const { return tree().blocks(); }
  /// Says that a block is about to be decoded, so that reading its bytes begins. Returns at once.
  void prefetch(size_t block) const;
  /// Checks the checksum of a block, of any kind.
  [[nodiscard]] Result<StoredBlock> stored(size_t block) const;
  /// An error of reading a block, with the names of file and block before it.
  [[nodiscard]] Error named(size_t block, const Error& error) const;
  /// Checks and decodes a block of surfels; fails on one of another kind. `scalars`: of the others only those that
  /// come before these.
  [[nodiscard]] Result<DecodedBlock> decode(size_t block, WantedScalars scalars = WantedScalars::kAll) const;
  [[nodiscard]] const std::filesystem::path& path() const;
  /// Tells this opening of a file from every other one in the life of the process, also after it has been closed.
  [[nodiscard]] uint64_t id() const;

 private:
  struct State;
  explicit ModelFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast::model
