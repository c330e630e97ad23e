#include "scan/propagate_signs.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/contract.h"

namespace surfcast::scan {
namespace {

/// Work is divided into chunks of this size, whatever the number of threads.
constexpr size_t kChunk = 32768;

size_t chunks_of(size_t size) {
  return (size + kChunk - 1) / kChunk;
}

/// Calls `work(chunk, first, last)` for all chunks, on all threads.
template <typename Work>
void for_each_chunk(size_t size, const Work& work) {
  tbb::parallel_for(size_t{0}, chunks_of(size),
                    [&](size_t chunk) { work(chunk, chunk * kChunk, std::min(size, (chunk + 1) * kChunk)); });
}

/// The contact of two pieces.
struct Contact {
  uint32_t a;
  uint32_t b;
  /// Sum of the votes of their links, in units of 2^-32; positive if the signs of the pieces agree. Sums of integers do
  /// not depend on the order of their terms.
  int64_t agreement;
};

/// In [-1, 1]; see propagate_signs.h.
double vote(const Sites& sites, std::span<const glm::vec3> normals, uint32_t a, uint32_t b) {
  const glm::dvec3 d = sites.positions[b] - sites.positions[a];
  const glm::dvec3 n(normals[a]);
  const glm::dvec3 m(normals[b]);
  return glm::dot(n, m) - glm::dot(n, d) * glm::dot(m, d) / glm::dot(d, d);
}

/// The initial contacts: every site is a piece.
std::vector<Contact> link_contacts(const Sites& sites, const Links& links, std::span<const glm::vec3> normals) {
  std::vector<size_t> begins(chunks_of(links.sites()) + 1);
  for_each_chunk(links.sites(), [&](size_t chunk, size_t first, size_t last) {
    links.for_each(first, last, [&](uint32_t, uint32_t) { ++begins[chunk + 1]; });
  });
  for (size_t chunk = 1; chunk < begins.size(); ++chunk) begins[chunk] += begins[chunk - 1];
  std::vector<Contact> contacts(begins.back());
  for_each_chunk(links.sites(), [&](size_t chunk, size_t first, size_t last) {
    size_t next = begins[chunk];
    links.for_each(first, last, [&](uint32_t a, uint32_t b) {
      contacts[next++] = {a, b, std::llround(std::ldexp(vote(sites, normals, a, b), 32))};
    });
  });
  return contacts;
}

/// A contact by its strength: larger numbers are stronger contacts, and of equally strong ones earlier ones. 0 is none.
using Strength = uint64_t;

Strength strength_of(const Contact& contact, size_t number) {
  const auto bits = std::bit_cast<uint32_t>(static_cast<float>(std::abs(contact.agreement)));
  return uint64_t{bits} << 32U | (std::numeric_limits<uint32_t>::max() - static_cast<uint32_t>(number));
}

size_t number_of(Strength strength) {
  return std::numeric_limits<uint32_t>::max() - static_cast<uint32_t>(strength);
}

void raise(Strength& largest, Strength strength) {
  std::atomic_ref<Strength> shared(largest);
  Strength before = shared.load(std::memory_order_relaxed);
  while (before < strength && !shared.compare_exchange_weak(before, strength, std::memory_order_relaxed)) {
  }
}

/// The strongest contact of every piece.
std::vector<Strength> strongest(std::span<const Contact> contacts, size_t pieces) {
  SURFCAST_EXPECTS(contacts.size() < std::numeric_limits<uint32_t>::max());
  std::vector<Strength> best(pieces);
  for_each_chunk(contacts.size(), [&](size_t, size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const Strength strength = strength_of(contacts[i], i);
      raise(best[contacts[i].a], strength);
      raise(best[contacts[i].b], strength);
    }
  });
  return best;
}

/// A piece that another one belongs to, and its sign relative to it.
struct Member {
  uint32_t of = 0;
  uint32_t opposed = 0;  ///< 0 or 1

  bool operator==(const Member&) const = default;
};

/// Each piece under the one at the other end of its strongest contact. Of two that are each other's, the first is the
/// root. There are no longer circles, because contacts grow stronger from piece to piece.
std::vector<Member> hook(std::span<const Contact> contacts, const std::vector<Strength>& best) {
  std::vector<Member> members(best.size());
  for_each_chunk(best.size(), [&](size_t, size_t first, size_t last) {
    for (size_t p = first; p < last; ++p) {
      const auto piece = static_cast<uint32_t>(p);
      members[p] = {piece, 0};
      if (best[p] == 0) continue;
      const Contact& c = contacts[number_of(best[p])];
      const uint32_t other = c.a == piece ? c.b : c.a;
      const bool root = best[other] == best[p] && piece < other;
      if (!root) members[p] = {other, c.agreement < 0 ? 1U : 0U};
    }
  });
  return members;
}

/// Puts all members directly under their roots, by halving all paths until they have one step.
void flatten(std::vector<Member>& members) {
  std::vector<Member> next(members.size());
  for (std::atomic<bool> changed = true; changed;) {
    changed = false;
    for_each_chunk(members.size(), [&](size_t, size_t first, size_t last) {
      bool moved = false;
      for (size_t p = first; p < last; ++p) {
        const Member& above = members[members[p].of];
        next[p] = {above.of, members[p].opposed ^ above.opposed};
        moved = moved || next[p] != members[p];
      }
      if (moved) changed = true;
    });
    members.swap(next);
  }
}

/// Replaces the roots by consecutive numbers; returns how many there are.
uint32_t number_roots(std::vector<Member>& members) {
  std::vector<uint32_t> numbers(members.size());
  uint32_t count = 0;
  for (uint32_t p = 0; p < members.size(); ++p) {
    if (members[p].of == p) numbers[p] = count++;
  }
  for_each_chunk(members.size(), [&](size_t, size_t first, size_t last) {
    for (size_t p = first; p < last; ++p) members[p].of = numbers[members[p].of];
  });
  return count;
}

/// Rewrites contacts in terms of the pieces to which theirs belong.
void relabel(std::vector<Contact>& contacts, const std::vector<Member>& members) {
  for_each_chunk(contacts.size(), [&](size_t, size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      Contact& c = contacts[i];
      const Member& a = members[c.a];
      const Member& b = members[c.b];
      c = {std::min(a.of, b.of), std::max(a.of, b.of), a.opposed != b.opposed ? -c.agreement : c.agreement};
    }
  });
}

/// Contacts between different pieces, sorted into buckets by their first piece. Bucket i is from begins[i] to
/// begins[i + 1].
struct Buckets {
  std::vector<Contact> contacts;
  std::vector<size_t> begins;
  unsigned shift = 0;  ///< a bucket is for 2^shift pieces
};

Buckets sort_into_buckets(const std::vector<Contact>& contacts, uint32_t pieces) {
  constexpr unsigned kBucketBits = 10;
  Buckets buckets;
  buckets.shift = std::max<unsigned>(static_cast<unsigned>(std::bit_width(pieces)), kBucketBits) - kBucketBits;
  const size_t count = (size_t{pieces} >> buckets.shift) + 1;
  std::vector<size_t> places(chunks_of(contacts.size()) * count);  // of each chunk in each bucket
  for_each_chunk(contacts.size(), [&](size_t chunk, size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const Contact& c = contacts[i];
      if (c.a != c.b) ++places[chunk * count + (c.a >> buckets.shift)];
    }
  });
  size_t total = 0;
  for (size_t bucket = 0; bucket < count; ++bucket) {
    buckets.begins.push_back(total);
    for (size_t chunk = 0; chunk < chunks_of(contacts.size()); ++chunk) {
      total += std::exchange(places[chunk * count + bucket], total);
    }
  }
  buckets.begins.push_back(total);
  buckets.contacts.resize(total);
  for_each_chunk(contacts.size(), [&](size_t chunk, size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const Contact& c = contacts[i];
      if (c.a != c.b) buckets.contacts[places[chunk * count + (c.a >> buckets.shift)]++] = c;
    }
  });
  return buckets;
}

/// Adds up the contacts of each pair of pieces. Returns the number of pairs, whose contacts are then the first ones.
/// All first pieces are from `base` to before `base + pieces`.
size_t add_up(std::span<Contact> contacts, uint32_t base, size_t pieces) {
  thread_local std::vector<Contact> sorted;
  thread_local std::vector<uint32_t> ends;
  ends.assign(pieces + 1, 0);
  for (const Contact& c : contacts) ++ends[c.a - base + 1];
  for (size_t p = 0; p < pieces; ++p) ends[p + 1] += ends[p];
  sorted.resize(contacts.size());
  for (const Contact& c : contacts) sorted[ends[c.a - base]++] = c;
  size_t kept = 0;
  size_t first = 0;
  for (size_t p = 0; p < pieces; first = ends[p++]) {
    const auto begin = sorted.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(ends[p]);
    std::sort(begin, end, [](const Contact& x, const Contact& y) { return x.b < y.b; });
    for (auto c = begin; c != end; ++c) {
      const bool same = c != begin && contacts[kept - 1].b == c->b;
      if (same) {
        contacts[kept - 1].agreement += c->agreement;
      } else {
        contacts[kept++] = *c;
      }
    }
  }
  return kept;
}

/// One contact for each pair of pieces, none within a piece.
std::vector<Contact> between_pieces(std::vector<Contact> contacts, uint32_t pieces) {
  Buckets buckets = sort_into_buckets(contacts, pieces);
  const size_t count = buckets.begins.size() - 1;
  std::vector<size_t> kept(count + 1);
  tbb::parallel_for(size_t{0}, count, [&](size_t i) {
    const std::span all =
        std::span(buckets.contacts).subspan(buckets.begins[i], buckets.begins[i + 1] - buckets.begins[i]);
    kept[i + 1] = add_up(all, static_cast<uint32_t>(i << buckets.shift), size_t{1} << buckets.shift);
  });
  for (size_t i = 0; i < count; ++i) kept[i + 1] += kept[i];
  contacts.resize(kept.back());
  tbb::parallel_for(size_t{0}, count, [&](size_t i) {
    std::copy_n(buckets.contacts.begin() + static_cast<std::ptrdiff_t>(buckets.begins[i]), kept[i + 1] - kept[i],
                contacts.begin() + static_cast<std::ptrdiff_t>(kept[i]));
  });
  return contacts;
}

/// Follows every site to its last piece. `levels[0]` are the sites in the pieces of the first round, `levels[1]` these
/// in the pieces of the second, and so on.
void follow(const std::vector<std::vector<Member>>& levels, SurfacePieces& pieces) {
  for_each_chunk(pieces.piece.size(), [&](size_t, size_t first, size_t last) {
    for (size_t site = first; site < last; ++site) {
      Member at{static_cast<uint32_t>(site), 0};
      for (const std::vector<Member>& level : levels) {
        const Member& above = level[at.of];
        at = {above.of, at.opposed ^ above.opposed};
      }
      pieces.piece[site] = at.of;
      pieces.opposed[site] = static_cast<uint8_t>(at.opposed);
    }
  });
}

}  // namespace

SurfacePieces propagate_signs(const Sites& sites, const Links& links, std::span<const glm::vec3> normals) {
  SurfacePieces pieces{static_cast<uint32_t>(links.sites()), {}, {}};
  std::vector<std::vector<Member>> levels;
  // Every round at least halves the number of pieces in contact (Boruvka's algorithm).
  for (std::vector<Contact> contacts = link_contacts(sites, links, normals); !contacts.empty();) {
    std::vector<Member> members = hook(contacts, strongest(contacts, pieces.count));
    flatten(members);
    pieces.count = number_roots(members);
    relabel(contacts, members);
    contacts = between_pieces(std::move(contacts), pieces.count);
    levels.push_back(std::move(members));
  }
  pieces.piece.resize(links.sites());
  pieces.opposed.resize(links.sites());
  follow(levels, pieces);
  return pieces;
}

}  // namespace surfcast::scan
