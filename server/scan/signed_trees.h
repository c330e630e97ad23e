#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "geometry/box.h"
#include "scan/neighbours.h"

namespace surfcast::scan {

/// What speaks for one sign or the other of a tree of sites whose normals have signs relative to each other. Sums over
/// sites are weighted by area: the square of the distance to the farthest neighbour, which is in proportion to the area
/// a site stands for. All sums but `area`, `moment` and `spread` change sign with the tree.
struct TreeVotes {
  glm::dvec3 origin{0};  ///< of p, a place near the tree
  double area = 0;
  glm::dvec3 moment{0};  ///< sum of p
  double spread = 0;     ///< sum of p . p
  glm::dvec3 normal{0};  ///< sum of n
  double flux = 0;       ///< sum of n . p: three times the enclosed volume (divergence theorem)
  double towards = 0;    ///< agreement with the known directions
  /// Links between a site whose direction is known by itself and one that follows the tree, by sum of |n . n'|.
  double agreement = 0;
  double conflict = 0;

  void move_origin(const glm::dvec3& to);
  void flip();
  void add(TreeVotes other);
};

/// A site at a border between parts, as one of the parts sees it.
struct BorderSite {
  uint64_t place = 0;  ///< a hash of its position
  glm::vec3 normal{0};
  uint32_t tree = 0;
};

/// How the normals of one part of a cloud (all of it, if it fits) depend on signs that are still to be settled.
struct PartSigns {
  std::vector<TreeVotes> trees;  ///< of the part's own sites; those of its halo count in the part that owns them
  double resolved_area = 0;      ///< of sites without a tree
  double agreement = 0;          ///< of links whose agreement does not depend on signs of trees
  double conflict = 0;
  bool all_known = true;           ///< every site's direction is known by itself
  std::vector<BorderSite> border;  ///< a sample of the sites near the border
};

/// Marks sites and surfels whose normal has its final sign.
inline constexpr uint32_t kNoTree = std::numeric_limits<uint32_t>::max();

/// What decides about a scene as a whole.
struct Scene {
  geometry::Box bounds;
  bool z_up = false;
  bool normals_stored = false;  ///< some normals are the scan's own, which may disagree among themselves
};

/// The signs of all trees of all parts.
struct ResolvedSigns {
  bool oriented = false;  ///< the signs can be trusted to tell front from back
  bool face_up = false;   ///< they cannot, and normals that are not known are turned upwards one by one
  std::vector<std::vector<uint8_t>> flipped;  ///< for each part and tree

  [[nodiscard]] glm::vec3 apply(const glm::vec3& normal, size_t part, uint32_t tree) const {
    if (tree == kNoTree) return normal;
    const bool flip = face_up ? normal.z < 0 : flipped[part][tree] != 0;
    return flip ? -normal : normal;
  }
};

/// Joins the trees of neighbouring parts by the sites that both see, strongest agreement first, and decides the sign of
/// each joined tree by its votes: by known directions where there are any; upwards, when the scene is z-up and the tree
/// is a terrain, most of whose area faces one way along z; otherwise such that the enclosed volume is positive.
///
/// Signs are not trusted when too many neighbours disagree (foliage, noise), nor when nothing decides between the two
/// sides: an open surface that is no terrain, or a closed one in a scene that may be a room seen from within (z-up, or
/// at least twice as wide, both ways, as high). To call such a cloud oriented would hide its front. Normals of a z-up
/// scene without trust are turned upwards one by one.
ResolvedSigns resolve_signs(std::span<const PartSigns> parts, const Scene& scene);

}  // namespace surfcast::scan
