#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "ldc/block_tree.h"
#include "model/block_decoder.h"
#include "model/member_levels.h"
#include "model/model_file.h"

namespace surfcast::model {

/// Where the tables of a member begin in those of the joined model.
struct MemberOffsets {
  uint32_t volume = 0;
  uint32_t ellipsoids = 0;  ///< source of ellipsoids
};

/// What a block of a joined model is.
struct BlockOrigin {
  static constexpr uint32_t kShared = UINT32_MAX;

  uint32_t member = kShared;  ///< kShared: it stands for blocks of several members
  uint32_t index = 0;         ///< of the block of the member, or of the shared block
};

/// The members of a joined model, and what its blocks are.
struct JoinedParts {
  std::vector<Member> members;
  std::vector<MemberOffsets> offsets;  ///< of each member
  std::vector<BlockOrigin> origins;    ///< of each block
  std::vector<SharedBlock> shared;
};

/// The tables of several models that are shown as one: the levels above the members with what they are made of, then
/// all other blocks of one member after those of the other.
struct JoinedTables {
  ModelInfo info;
  std::vector<ScalarColumn> scalars;  ///< all attributes of any member, each of a type that holds its values
  std::vector<Volume> volumes;
  std::vector<EllipsoidSource> ellipsoids;
  std::vector<ldc::BlockEntry> blocks;
  JoinedParts parts;
};

/// Fails for a member that has `places` and cannot be placed: only scans without curvature can. The error names it.
Status check_place(const Member& member);

/// The first member decides which way is up. Normals of each scan count as they do alone. Fails if there are too many
/// members, if one is named twice, or if one cannot be placed.
Result<JoinedTables> join_tables(std::vector<Member> members);

/// A block of surfels of a member with the colours and attributes of the joined model, as scan::conform fills them in
/// where scans are built together: colours become grey, attributes 0 or opaque. `scalars`: the attributes of `wanted`.
/// Unless all are wanted, a block without curvature gets none.
DecodedBlock conform(DecodedBlock block, int color_bits, int joined_color_bits, std::span<const ScalarColumn> scalars,
                     WantedScalars wanted);

/// A block of surfels in another place. Its lattice has steps of the same length.
DecodedBlock placed(DecodedBlock block, const glm::dmat4x3& place);

}  // namespace surfcast::model
