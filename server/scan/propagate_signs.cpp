#include "scan/propagate_signs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include "scan/links.h"

namespace surfcast::scan {
namespace {

/// The contact of two pieces, given by one member of each.
struct Contact {
  uint32_t a;
  uint32_t b;
  double agreement;  ///< sum of the votes of their links; positive if the signs of the members agree
};

bool same_pieces(const Contact& x, const Contact& y) {
  return x.a == y.a && x.b == y.b;
}

/// Rewrites contacts in terms of the roots of their pieces: one for each pair, none within a piece.
std::vector<Contact> between_roots(std::vector<Contact> contacts, SignedForest& forest) {
  for (Contact& c : contacts) {
    const auto [root_a, opposed_a] = forest.find(c.a);
    const auto [root_b, opposed_b] = forest.find(c.b);
    c.a = std::min(root_a, root_b);
    c.b = std::max(root_a, root_b);
    if (opposed_a != opposed_b) c.agreement = -c.agreement;
  }
  std::erase_if(contacts, [](const Contact& c) { return c.a == c.b; });
  std::stable_sort(contacts.begin(), contacts.end(),
                   [](const Contact& x, const Contact& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); });
  std::vector<Contact> sums;
  for (const Contact& c : contacts) {
    if (sums.empty() || !same_pieces(sums.back(), c)) {
      sums.push_back(c);
    } else {
      sums.back().agreement += c.agreement;
    }
  }
  return sums;
}

/// In [-1, 1]; see propagate_signs.h.
double vote(const Sites& sites, std::span<const glm::vec3> normals, uint32_t a, uint32_t b) {
  const glm::dvec3 d = sites.positions[b] - sites.positions[a];
  const glm::dvec3 n(normals[a]);
  const glm::dvec3 m(normals[b]);
  return glm::dot(n, m) - glm::dot(n, d) * glm::dot(m, d) / glm::dot(d, d);
}

/// The initial contacts: every site is a piece.
std::vector<Contact> link_contacts(const Sites& sites, const NeighbourGraph& graph,
                                   std::span<const glm::vec3> normals) {
  std::vector<Contact> contacts;
  contacts.reserve(normals.size() * kLinks / 2);
  for_each_link(graph, normals.size(), [&](uint32_t a, uint32_t b) {
    contacts.push_back({a, b, vote(sites, normals, a, b)});
  });
  return contacts;
}

bool stronger(const Contact& x, const Contact& y) {
  const double strength_x = std::abs(x.agreement);
  const double strength_y = std::abs(y.agreement);
  return strength_x != strength_y ? strength_x > strength_y : std::tie(x.a, x.b) < std::tie(y.a, y.b);
}

/// The strongest contact of every piece, strongest first.
std::vector<Contact> strongest(std::span<const Contact> contacts, size_t sites) {
  constexpr size_t kNone = SIZE_MAX;
  std::vector<size_t> best(sites, kNone);
  for (size_t i = 0; i < contacts.size(); ++i) {
    for (const uint32_t piece : {contacts[i].a, contacts[i].b}) {
      if (best[piece] == kNone || stronger(contacts[i], contacts[best[piece]])) best[piece] = i;
    }
  }
  std::vector<Contact> chosen;
  for (size_t i = 0; i < contacts.size(); ++i) {
    if (best[contacts[i].a] == i || best[contacts[i].b] == i) chosen.push_back(contacts[i]);
  }
  std::sort(chosen.begin(), chosen.end(), stronger);
  return chosen;
}

}  // namespace

SignedForest propagate_signs(const Sites& sites, const NeighbourGraph& graph, std::span<const glm::vec3> normals) {
  SignedForest forest(normals.size());
  // Every round at least halves the number of pieces in contact (Boruvka's algorithm).
  for (std::vector<Contact> contacts = link_contacts(sites, graph, normals); !contacts.empty();) {
    for (const Contact& c : strongest(contacts, normals.size())) forest.join(c.a, c.b, c.agreement < 0);
    contacts = between_roots(std::move(contacts), forest);
  }
  return forest;
}

}  // namespace surfcast::scan
