#include "point_tree/fronts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "estimation/sign_vote.h"

namespace surfcast::point_tree {
namespace {

/// The most sweeps over the sites, forwards and backwards in turn. The first one reaches nearly all sites. In the
/// second one all neighbours vote. The others are for sites whose signs are still unknown.
constexpr int kSweeps = 4;
constexpr int kCompleteSweeps = 2;
/// The least agreement of the votes for a known sign; 1 if no vote opposes it.
constexpr double kAgreement = 0.5;
/// The largest share of discs with unknown fronts in an oriented cloud. About half of them are not drawn.
constexpr double kUnknownShare = 0.01;

/// How far the sign of each site is known: from -1, opposed to its normal, to 1; 0 is unknown.
class SignSpread {
 public:
  SignSpread(const estimation::Neighbourhoods& neighbourhoods, const surfel::SurfelCloud& cloud)
      : near_(neighbourhoods), signs_(near_.sites.size()), told_(signs_.size()) {
    for (const uint32_t surfel : near_.sites.points()) {
      discs_.push_back(!cloud.is_scatter(surfel));
      normals_.push_back(cloud.normals[surfel]);
    }
  }

  /// `front`: the normal of a point at a site as the upper level knows it.
  void tell(uint32_t site, const glm::vec3& front) {
    if (discs_[site]) told_[site] = signs_[site] = double{glm::dot(front, normals_[site])};
  }

  void spread() {
    std::vector<uint32_t> sites(signs_.size());
    std::iota(sites.begin(), sites.end(), 0U);
    std::erase_if(sites, [this](uint32_t site) { return !discs_[site]; });
    for (int sweep = 0; sweep < kSweeps && !sites.empty(); ++sweep) {
      if (sweep >= kCompleteSweeps) std::erase_if(sites, [this](uint32_t site) { return is_known(site); });
      for (const uint32_t site : sites) signs_[site] = vote_at(site);
      std::ranges::reverse(sites);
    }
  }

  [[nodiscard]] bool is_opposed(uint32_t site) const { return signs_[site] < 0; }
  /// The neighbours agree with each other and with the upper level.
  [[nodiscard]] bool is_known(uint32_t site) const {
    return std::abs(signs_[site]) >= kAgreement && signs_[site] * told_[site] >= 0;
  }

 private:
  /// The votes of the neighbours and of the upper level.
  [[nodiscard]] double vote_at(uint32_t site) const {
    double sum = told_[site];
    double all = std::abs(sum);
    for (const uint32_t neighbour : near_.graph.of(site)) {
      if (signs_[neighbour] == 0) continue;
      const double vote = signs_[neighbour] * estimation::sign_vote(near_.sites, normals_, site, neighbour);
      sum += vote;
      all += std::abs(vote);
    }
    return all > 0 ? sum / all : 0;
  }

  const estimation::Neighbourhoods& near_;
  std::vector<glm::vec3> normals_;  ///< of each site, as are those that follow
  std::vector<bool> discs_;         ///< false: scatter
  std::vector<double> signs_;
  std::vector<double> told_;  ///< by the upper level; 0: nothing
};

void tell_known(const estimation::Sites& sites, std::span<const uint64_t> codes, const Fronts& above,
                SignSpread& spread) {
  size_t at = 0;
  for (size_t i = 0; i < codes.size(); ++i) {
    while (at < above.codes.size() && above.codes[at] < codes[i]) ++at;
    if (at == above.codes.size()) return;
    if (above.codes[at] == codes[i]) spread.tell(sites.of_point[i], above.normals[at]);
  }
}

}  // namespace

Fronts turn_outwards(const estimation::Neighbourhoods& neighbourhoods, std::span<const uint64_t> codes,
                     const Fronts& above, surfel::SurfelCloud& cloud) {
  const std::vector<uint32_t>& site_of = neighbourhoods.sites.of_point;
  SignSpread spread(neighbourhoods, cloud);
  tell_known(neighbourhoods.sites, codes, above, spread);
  spread.spread();
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (spread.is_opposed(site_of[i])) cloud.normals[i] = -cloud.normals[i];
  }
  Fronts fronts = fronts_of(codes, cloud);
  size_t discs = 0, unknown = 0;
  for (size_t i = 0; i < codes.size(); ++i) {
    if (cloud.is_scatter(i)) continue;
    ++discs;
    if (spread.is_known(site_of[i])) continue;
    ++unknown;
    fronts.normals[i] = glm::vec3(0);
  }
  cloud.oriented = static_cast<double>(unknown) <= kUnknownShare * static_cast<double>(discs);
  return fronts;
}

Fronts fronts_of(std::span<const uint64_t> codes, const surfel::SurfelCloud& cloud) {
  Fronts fronts;
  fronts.codes.assign(codes.begin(), codes.end());
  for (size_t i = 0; i < codes.size(); ++i) {
    fronts.normals.push_back(cloud.is_scatter(i) ? glm::vec3(0) : cloud.normals[i]);
  }
  return fronts;
}

}  // namespace surfcast::point_tree
