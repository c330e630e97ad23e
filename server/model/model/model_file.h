#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/byte_source.h"
#include "base/result.h"
#include "geometry/box.h"
#include "ldc/block_tree.h"
#include "model/decoded_block.h"
#include "model/elevation_range.h"
#include "model/ellipsoid_source.h"
#include "model/georeference.h"
#include "model/kind_count.h"
#include "model/statistics.h"
#include "model/volume.h"

namespace surfcast::model {

/// Properties of a whole model.
struct ModelInfo {
  uint64_t surfels = 0;                   ///< surfels of the source: those in the leaves of the tree
  uint64_t scatter = 0;                   ///< how many of them lie on no surface (SurfelCloud::scatter)
  std::vector<KindCount> kinds;           ///< kinds of its blocks; BlockEntry::kind is an index into this list
  int levels = 0;                         ///< levels of detail; 1 without coarse levels
  geometry::Box bounds;                   ///< of the stored positions, world units
  bool oriented = false;                  ///< see SurfelCloud::oriented
  bool partly_oriented = false;           ///< some blocks are (DecodedBlock::oriented); also if all are
  bool z_up = true;                       ///< see SurfelCloud::z_up
  int color_bits = 0;                     ///< 8 or 16; 0: the model has no colour
  bool upside_down = false;               ///< the vertical axis points down: up is its negative end
  int harmonics_degree = 0;               ///< highest degree of the harmonics of its Gaussians
  bool even = false;                      ///< its surfels are samples of meshes, even and with exact radii
  bool in_place = false;                  ///< its blocks are made of a tree of points when they are asked for
  size_t ellipsoid_columns = 0;           ///< most columns of a source of its ellipsoids
  std::vector<std::string> scalar_names;  ///< scalar attributes of the leaves, in order
  std::vector<std::string> source_names;  ///< the input files
  std::vector<AttributeRange>
      ranges;                       ///< of the attributes that have finite values; empty if the file has no statistics
  std::vector<ClassCount> classes;  ///< classes that occur, sorted by code; likewise
  ElevationRange elevation;         ///< of all but volumes, without outliers

  /// The direction that points up, unit.
  [[nodiscard]] glm::dvec3 up() const {
    return (upside_down ? -1.0 : 1.0) * (z_up ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0));
  }
  /// Null if the file has no range of this attribute.
  [[nodiscard]] const AttributeRange* range_of(std::string_view attribute) const {
    for (const AttributeRange& range : ranges) {
      if (range.attribute == attribute) return &range;
    }
    return nullptr;
  }
};

class BlockCache;
class BlockProvider;
class ModelFile;
struct Directory;
struct ScalarColumn;

/// The most models that are shown as one.
inline constexpr size_t kMaxMembers = 64;

/// A model that is shown together with others.
struct Member {
  std::string name;  ///< under which it is known
  std::shared_ptr<const ModelFile> model;
  /// For each of its blocks the affine map from its world to that of the first member; empty: these are the same.
  std::vector<glm::dmat4x3> places{};
};

/// A block as a member of a joined model has it. A plain model is its own only part; so is a joined model for the
/// blocks that stand for several members.
struct Part {
  const ModelFile& model;
  uint32_t block = 0;             ///< of the member
  uint32_t member = 0;            ///< index of the member; 0 if it is no part of one
  uint32_t first_volume = 0;      ///< the number of the member's first volume among those of the joined model
  uint32_t first_ellipsoids = 0;  ///< likewise, of its first source of ellipsoids
};

/// An open model: a file, blocks that something else provides, or several models that are shown as one: all their
/// blocks, and above those of scans with many surfels coarser levels that are made when they are needed. All methods
/// are const and safe to call from several threads at once.
class ModelFile {
 public:
  static Result<ModelFile> open(const std::filesystem::path& path);
  /// `cache`: for blocks of a source that is slower than this disk; may be null.
  static Result<ModelFile> open(std::unique_ptr<const ByteSource> source, std::shared_ptr<BlockCache> cache = nullptr);

  /// A model of surfels whose blocks are provided. `path`: what it is called. The entries form a tree of blocks of the
  /// kind 0, which `info` names.
  static ModelFile of_blocks(const std::filesystem::path& path, ModelInfo info, std::vector<ldc::BlockEntry> entries,
                             std::unique_ptr<const BlockProvider> provider);
  /// Shows models as one, in this order. Fails if there are more than kMaxMembers, if two have one name, and if one has
  /// `places` and a kind that cannot be placed; the error names it.
  static Result<ModelFile> join(std::vector<Member> members);

  ModelFile(ModelFile&&) noexcept;
  ModelFile& operator=(ModelFile&&) noexcept;
  ~ModelFile();

  [[nodiscard]] const ModelInfo& info() const;
  [[nodiscard]] const ldc::BlockTree& tree() const;
  [[nodiscard]] std::span<const ldc::BlockEntry> blocks() const { return tree().blocks(); }
  /// Starts to read the bytes of blocks that are about to be decoded, most urgent first. Returns immediately.
  void prefetch(std::span<const uint32_t> blocks) const;
  /// A block that was prefetched will not be decoded.
  void forget(size_t block) const;
  /// The same for blocks that are made together: decoding one of them makes all.
  [[nodiscard]] uint64_t unit_of(uint32_t block) const;
  /// The bytes of a block of any kind. Fails if their checksum is wrong. Of a joined model, those of the member.
  [[nodiscard]] Result<StoredBlock> stored(size_t block) const;
  /// The volumes whose bricks are blocks of the kind "grid"; none in most models.
  [[nodiscard]] std::span<const Volume> volumes() const;
  /// The scalar attributes of the leaves, in the order of ModelInfo::scalar_names.
  [[nodiscard]] std::span<const ScalarColumn> scalars() const;
  /// The models of a joined one; none of a file.
  [[nodiscard]] std::span<const Member> members() const;
  /// Where kinds that number their volumes or sources, or state limits, read a block.
  [[nodiscard]] Part part(uint32_t block) const;
  /// The members of a joined model that a block stands for; none of a file.
  [[nodiscard]] std::bitset<kMaxMembers> members_of(uint32_t block) const;
  /// The place of a block of the kind "grid". It lies within its volume, and its parent stands for it.
  [[nodiscard]] BrickRecord brick(size_t block) const;
  /// The sources of the blocks of the kind "ellipsoid"; none in most models.
  [[nodiscard]] std::span<const EllipsoidSource> ellipsoid_sources() const;
  /// Prefixes an error about a block with the names of file and block.
  [[nodiscard]] Error named(size_t block, const Error& error) const;
  /// Checks and decodes a block of surfels. Fails on a block of another kind. Attributes are decoded in order, up to
  /// the last one that `scalars` requests. Of a joined model all blocks have all its attributes, and colours if any has
  /// them: see conform (model/joined_model.h).
  [[nodiscard]] Result<DecodedBlock> decode(size_t block, WantedScalars scalars = WantedScalars::kAll) const;
  /// Where the model lies on the earth. It is read when it is asked for, because drawing does without it. Of a joined
  /// model: the system of the first member that states one, in which all lie. The source's is known if it is the same
  /// for all members that state a system.
  [[nodiscard]] Result<Georeference> georeference() const;
  /// The path of the file, or its URL. Of a joined model, the names of its members.
  [[nodiscard]] const std::filesystem::path& path() const;
  /// Where its bytes come from; of a model in many files, those of the file that describes it. Not of a joined model.
  [[nodiscard]] const ByteSource& source() const;
  /// An ID of this opening of the file, unique in the process and not reused after the file is closed.
  [[nodiscard]] uint64_t id() const;

 private:
  struct State;
  explicit ModelFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast::model
