#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "estimation/neighbours.h"
#include "geometry/box.h"

namespace surfcast::estimation {

/// The evidence for one sign or the other of a tree: a set of sites whose normals have known signs relative to each
/// other. Sums over sites are weighted by area, measured by the squared distance to the farthest neighbour. All sums
/// except `area`, `moment` and `spread` change sign with the tree.
struct TreeVotes {
  glm::dvec3 origin{0};  ///< origin of p, a point near the tree
  double area = 0;
  glm::dvec3 moment{0};  ///< sum of p
  double spread = 0;     ///< sum of p . p
  glm::dvec3 normal{0};  ///< sum of n
  double flux = 0;       ///< sum of n . p: three times the enclosed volume (divergence theorem)
  double towards = 0;    ///< sum of n . t, where t is the known direction
  /// Sums of |n . n'| over the links between a site of known direction and one that follows the tree.
  double agreement = 0;
  double conflict = 0;

  void move_origin(const glm::dvec3& to);
  void flip();
  void add(TreeVotes other);
};

/// A site near the border between parts, as seen by one of the parts.
struct BorderSite {
  uint64_t place = 0;  ///< hash of its position
  glm::vec3 normal{0};
  uint32_t tree = 0;
};

/// How the normals of one part of a cloud depend on signs that are still open.
struct PartSigns {
  std::vector<TreeVotes> trees;  ///< sums over the part's own sites; halo sites count in the part that owns them
  double resolved_area = 0;      ///< of sites without a tree
  double agreement = 0;          ///< of links whose agreement does not depend on the signs of trees
  double conflict = 0;
  bool all_known = true;           ///< the direction of every own site is known
  std::vector<BorderSite> border;  ///< a sample of the sites near the border
};

/// Marks sites and surfels whose normal has its final sign.
inline constexpr uint32_t kNoTree = std::numeric_limits<uint32_t>::max();

/// Properties of the scene that influence the decisions.
struct Scene {
  geometry::Box bounds;
  bool z_up = false;
  bool normals_stored = false;  ///< some normals come from the scan and may be inconsistent
};

/// The signs of all trees of all parts.
struct ResolvedSigns {
  bool oriented = false;  ///< the signs are reliable enough to tell front from back
  bool face_up = false;   ///< signs are not reliable: normals of unknown direction are turned upwards individually
  std::vector<std::vector<uint8_t>> flipped;  ///< for each part and tree

  [[nodiscard]] glm::vec3 apply(const glm::vec3& normal, size_t part, uint32_t tree) const {
    if (tree == kNoTree) return normal;
    const bool flip = face_up ? normal.z < 0 : flipped[part][tree] != 0;
    return flip ? -normal : normal;
  }
};

/// Joins the trees of neighbouring parts at the sites that both contain, strongest agreement first. Then the votes of
/// each joined tree decide its sign:
/// - by the known directions, if there are any;
/// - upwards, if the scene is z-up and the tree is a terrain: most of its area faces the same way along z;
/// - otherwise such that the enclosed volume is positive.
///
/// Signs are unreliable if too many neighbours disagree (foliage, noise). They are also unreliable if nothing decides
/// between the two sides: for an open surface that is no terrain, and for a closed one that may be a room seen from
/// inside (in scenes that are z-up, or whose smallest extent is at most half of the other two). Calling such a cloud
/// oriented would hide its front. Normals of an unreliable z-up scene are turned upwards individually.
ResolvedSigns resolve_signs(std::span<const PartSigns> parts, const Scene& scene);

}  // namespace surfcast::estimation
