#include "estimation/propagate_signs.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/contract.h"
#include "estimation/sign_vote.h"

namespace surfcast::estimation {
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

/// The initial contacts, of linked sites: every site is a piece. Their numbers are those of the links.
class LinkContacts {
 public:
  LinkContacts(const Sites& sites, const Links& links, std::span<const glm::vec3> normals,
               std::span<const PointKind> kinds)
      : sites_(sites), links_(links), normals_(normals), kinds_(kinds) {
    SURFCAST_EXPECTS(links.sites() <= kMaxSites);
  }

  [[nodiscard]] bool empty() const { return links_.sites() < 2; }
  [[nodiscard]] size_t chunks() const { return (links_.sites() + kSites - 1) / kSites; }
  /// Calls `use(number, contact)` for the contacts of a chunk, in ascending order of their numbers, unless
  /// `skip(a, b)` is true for their pieces.
  template <typename Skip, typename Use>
  void for_each(size_t chunk, const Skip& skip, const Use& use) const {
    const size_t first = chunk * kSites;
    links_.for_each_numbered(first, std::min(links_.sites(), first + kSites),
                             [&](uint32_t a, uint32_t b, uint32_t number) {
                               if (!skip(a, b)) use(number, contact(a, b));
                             });
  }
  [[nodiscard]] Contact at(uint32_t number) const {
    const auto [a, b] = links_.pair(number);
    return contact(a, b);
  }

 private:
  static constexpr size_t kSites = 8192;  ///< of a chunk

  /// The best of 1, 1/16, 1/64 and 1/1024 for walls (docs/laboratory.md, "Signs at the feet of walls").
  [[nodiscard]] double weight(uint32_t a, uint32_t b) const {
    constexpr double kScatter = 1.0 / 64;
    return !kinds_.empty() && (is_scatter(kinds_[a]) || is_scatter(kinds_[b])) ? kScatter : 1;
  }
  [[nodiscard]] Contact contact(uint32_t a, uint32_t b) const {
    const double scaled = 0x1p32 * weight(a, b) * sign_vote(sites_, normals_, a, b);
    return {a, b, static_cast<int64_t>(scaled + std::copysign(0.5, scaled))};
  }

  const Sites& sites_;
  const Links& links_;
  std::span<const glm::vec3> normals_;
  std::span<const PointKind> kinds_;
};

/// Contacts in runs, with unused places between these. Their numbers are their places.
struct ContactRuns {
  struct Run {
    size_t first = 0;
    size_t last = 0;  ///< exclusive
  };
  std::vector<Contact> contacts;
  std::vector<Run> runs;

  [[nodiscard]] bool empty() const {
    return std::all_of(runs.begin(), runs.end(), [](const Run& run) { return run.first == run.last; });
  }
  [[nodiscard]] size_t chunks() const { return runs.size(); }
  template <typename Skip, typename Use>
  void for_each(size_t chunk, const Skip& skip, const Use& use) const {
    for (size_t i = runs[chunk].first; i < runs[chunk].last; ++i) {
      if (!skip(contacts[i].a, contacts[i].b)) use(static_cast<uint32_t>(i), contacts[i]);
    }
  }
  [[nodiscard]] const Contact& at(uint32_t number) const { return contacts[number]; }
};

/// A contact by its strength: larger numbers are stronger contacts, and of equally strong ones earlier ones. 0 is none.
using Strength = uint64_t;

Strength strength_of(const Contact& contact, uint32_t number) {
  const auto bits = std::bit_cast<uint32_t>(static_cast<float>(std::abs(contact.agreement)));
  return uint64_t{bits} << 32U | (std::numeric_limits<uint32_t>::max() - number);
}

uint32_t number_of(Strength strength) {
  return std::numeric_limits<uint32_t>::max() - static_cast<uint32_t>(strength);
}

void raise(Strength& largest, Strength strength) {
  std::atomic_ref<Strength> shared(largest);
  Strength before = shared.load(std::memory_order_relaxed);
  while (before < strength && !shared.compare_exchange_weak(before, strength, std::memory_order_relaxed)) {
  }
}

/// The strongest contact of every piece.
template <typename Contacts>
std::vector<Strength> strongest(const Contacts& contacts, size_t pieces) {
  std::vector<Strength> best(pieces);
  const auto none = [](uint32_t, uint32_t) { return false; };
  tbb::parallel_for(size_t{0}, contacts.chunks(), [&](size_t chunk) {
    contacts.for_each(chunk, none, [&](uint32_t number, const Contact& contact) {
      const Strength strength = strength_of(contact, number);
      raise(best[contact.a], strength);
      raise(best[contact.b], strength);
    });
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
template <typename Contacts>
std::vector<Member> hook(const Contacts& contacts, const std::vector<Strength>& best) {
  std::vector<Member> members(best.size());
  for_each_chunk(best.size(), [&](size_t, size_t first, size_t last) {
    for (size_t p = first; p < last; ++p) {
      const auto piece = static_cast<uint32_t>(p);
      members[p] = {piece, 0};
      if (best[p] == 0) continue;
      const Contact c = contacts.at(number_of(best[p]));
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

/// A contact in terms of the pieces to which its own belong.
Contact relabelled(const Contact& contact, const std::vector<Member>& members) {
  const Member& a = members[contact.a];
  const Member& b = members[contact.b];
  return {std::min(a.of, b.of), std::max(a.of, b.of), a.opposed != b.opposed ? -contact.agreement : contact.agreement};
}

/// Adds up contacts of equal pairs in the order in which pairs come first.
class PairSums {
 public:
  void clear() {
    sums_.clear();
    slots_.assign(slots_.size(), kNone);
  }
  void add(const Contact& contact) {
    if (2 * sums_.size() >= slots_.size()) grow();
    uint32_t& slot = slot_of(contact);
    if (slot == kNone) {
      slot = static_cast<uint32_t>(sums_.size());
      sums_.push_back(contact);
    } else {
      sums_[slot].agreement += contact.agreement;
    }
  }
  [[nodiscard]] const std::vector<Contact>& sums() const { return sums_; }

 private:
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

  [[nodiscard]] uint32_t& slot_of(const Contact& contact) {
    const uint64_t pair = uint64_t{contact.a} << 32U | contact.b;
    size_t at = pair * 0x9e3779b97f4a7c15ULL >> (64 - bits_);
    while (slots_[at] != kNone && (sums_[slots_[at]].a != contact.a || sums_[slots_[at]].b != contact.b)) {
      at = (at + 1) & (slots_.size() - 1);
    }
    return slots_[at];
  }
  void grow() {
    ++bits_;
    slots_.assign(size_t{1} << bits_, kNone);
    for (uint32_t i = 0; i < sums_.size(); ++i) slot_of(sums_[i]) = i;
  }

  unsigned bits_ = 13;
  std::vector<uint32_t> slots_ = std::vector<uint32_t>(size_t{1} << bits_, kNone);  ///< open addressing
  std::vector<Contact> sums_;
};

/// The contacts between the pieces to which the members belong, chunk by chunk: one for each pair of pieces.
template <typename Contacts>
std::vector<std::vector<Contact>> join_chunks(const Contacts& contacts, const std::vector<Member>& members) {
  std::vector<std::vector<Contact>> joined(contacts.chunks());
  const auto inside = [&members](uint32_t a, uint32_t b) { return members[a].of == members[b].of; };
  tbb::parallel_for(size_t{0}, joined.size(), [&](size_t chunk) {
    thread_local PairSums pairs;
    pairs.clear();
    contacts.for_each(chunk, inside,
                      [&](uint32_t, const Contact& contact) { pairs.add(relabelled(contact, members)); });
    joined[chunk] = pairs.sums();
  });
  return joined;
}

/// Contacts sorted into buckets by their first piece. Bucket i is from begins[i] to begins[i + 1].
struct Buckets {
  std::vector<Contact> contacts;
  std::vector<size_t> begins;
  unsigned shift = 0;  ///< a bucket is for 2^shift pieces
};

Buckets sort_into_buckets(std::vector<std::vector<Contact>> chunks, uint32_t pieces) {
  constexpr unsigned kBucketBits = 10;
  Buckets buckets;
  buckets.shift = std::max<unsigned>(static_cast<unsigned>(std::bit_width(pieces)), kBucketBits) - kBucketBits;
  const size_t count = (size_t{pieces} >> buckets.shift) + 1;
  std::vector<size_t> places(chunks.size() * count);  // of each chunk in each bucket
  tbb::parallel_for(size_t{0}, chunks.size(), [&](size_t chunk) {
    for (const Contact& c : chunks[chunk]) ++places[chunk * count + (c.a >> buckets.shift)];
  });
  size_t total = 0;
  for (size_t bucket = 0; bucket < count; ++bucket) {
    buckets.begins.push_back(total);
    for (size_t chunk = 0; chunk < chunks.size(); ++chunk) {
      total += std::exchange(places[chunk * count + bucket], total);
    }
  }
  buckets.begins.push_back(total);
  buckets.contacts.resize(total);
  tbb::parallel_for(size_t{0}, chunks.size(), [&](size_t chunk) {
    for (const Contact& c : chunks[chunk]) {
      buckets.contacts[places[chunk * count + (c.a >> buckets.shift)]++] = c;
    }
    std::vector<Contact>().swap(chunks[chunk]);
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
template <typename Contacts>
ContactRuns between_pieces(const Contacts& contacts, const std::vector<Member>& members, uint32_t pieces) {
  Buckets buckets = sort_into_buckets(join_chunks(contacts, members), pieces);
  SURFCAST_EXPECTS(buckets.contacts.size() < std::numeric_limits<uint32_t>::max());
  ContactRuns joined{std::move(buckets.contacts), std::vector<ContactRuns::Run>(buckets.begins.size() - 1)};
  tbb::parallel_for(size_t{0}, joined.runs.size(), [&](size_t i) {
    const size_t first = buckets.begins[i];
    const std::span all = std::span(joined.contacts).subspan(first, buckets.begins[i + 1] - first);
    joined.runs[i] = {first,
                      first + add_up(all, static_cast<uint32_t>(i << buckets.shift), size_t{1} << buckets.shift)};
  });
  return joined;
}

/// The contacts of a round, and the pieces that they join into larger ones.
struct Round {
  std::vector<Member> members;  ///< each piece in a larger one
  uint32_t pieces = 0;          ///< larger ones
  ContactRuns contacts;         ///< between these
};

/// Joins each piece with that of its strongest contact.
template <typename Contacts>
Round join(const Contacts& contacts, size_t pieces) {
  Round round;
  round.members = hook(contacts, strongest(contacts, pieces));
  flatten(round.members);
  round.pieces = number_roots(round.members);
  round.contacts = between_pieces(contacts, round.members, round.pieces);
  return round;
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

SurfacePieces propagate_signs(const Sites& sites, const Links& links, std::span<const glm::vec3> normals,
                              std::span<const PointKind> kinds) {
  SurfacePieces pieces{static_cast<uint32_t>(links.sites()), {}, {}};
  std::vector<std::vector<Member>> levels;
  // Every round at least halves the number of pieces in contact (Boruvka's algorithm).
  const LinkContacts all(sites, links, normals, kinds);
  if (!all.empty()) {
    Round round = join(all, links.sites());
    levels.push_back(std::move(round.members));
    while (!round.contacts.empty()) {
      round = join(round.contacts, round.pieces);
      levels.push_back(std::move(round.members));
    }
    pieces.count = round.pieces;
  }
  pieces.piece.resize(links.sites());
  pieces.opposed.resize(links.sites());
  follow(levels, pieces);
  return pieces;
}

}  // namespace surfcast::estimation
