#include "kinds/pixel_hits.h"

#include <algorithm>

namespace surfcast::kinds {

PixelHits::PixelHits(const PixelRange& range)
    : range_(range), pixels_(static_cast<size_t>(range.size().x) * static_cast<size_t>(range.size().y)) {}

bool PixelHits::may_show(const PixelRange& range, double nearest) const {
  for (int y = range.first.y; y <= range.last.y; ++y) {
    const auto row = pixels_.begin() + static_cast<std::ptrdiff_t>(index_of({range.first.x, y}));
    if (std::any_of(row, row + range.size().x, [&](const Pixel& pixel) { return nearest <= pixel.occluder; })) {
      return true;
    }
  }
  return false;
}

uint32_t PixelHits::store(const Entry& entry) {
  if (free_ == kNone) {
    entries_.push_back(entry);
    return static_cast<uint32_t>(entries_.size() - 1);
  }
  const uint32_t place = free_;
  free_ = entries_[place].next;
  entries_[place] = entry;
  return place;
}

/// Empties a list from a link on.
void PixelHits::drop_from(uint32_t& link) {
  while (link != kNone) {
    const uint32_t place = link;
    link = entries_[place].next;
    entries_[place].next = free_;
    free_ = place;
  }
}

void PixelHits::add(const glm::ivec2& at, const PickHit& hit, const ItemLook& look) {
  Pixel& pixel = pixels_[index_of(at)];
  if (hit.opacity < 1) return add_translucent(pixel, hit, look);
  pixel.occluder = std::min(pixel.occluder, hit.occluder);
  const PickRank rank{hit.form, block_, hit.item};
  // All entries before the new one's place are nearer; if the last of them, the first in rank, is found before the new
  // one, the new one never is.
  uint32_t before = kNone;
  uint32_t after = pixel.nearest;
  while (after != kNone && entries_[after].item.depth <= hit.depth) {
    before = after;
    after = entries_[after].next;
  }
  const bool found = hit.depth <= pixel.occluder && (before == kNone || rank < entries_[before].item.rank);
  if (found) {
    while (after != kNone && rank < entries_[after].item.rank) {
      const uint32_t next = entries_[after].next;
      entries_[after].next = free_;
      free_ = after;
      after = next;
    }
    const uint32_t placed = store({{rank, hit.depth, look}, after});
    (before == kNone ? pixel.nearest : entries_[before].next) = placed;
  }
  drop_hidden(pixel);
}

/// Drops the items behind the pixel's occluder.
void PixelHits::drop_hidden(Pixel& pixel) {
  for (uint32_t* link : {&pixel.nearest, &pixel.translucent}) {
    while (*link != kNone && entries_[*link].item.depth <= pixel.occluder) link = &entries_[*link].next;
    drop_from(*link);
  }
}

/// What more of the list is found can only hide more: the place where half of the light is left comes nearer.
void PixelHits::add_translucent(Pixel& pixel, const PickHit& hit, const ItemLook& look) {
  if (hit.depth > pixel.occluder) return;
  const PickRank rank{hit.form, block_, hit.item};
  uint32_t before = kNone;
  uint32_t after = pixel.translucent;
  const auto in_front = [&](const ShownItem& item) {
    return item.depth < hit.depth || (item.depth == hit.depth && item.rank < rank);
  };
  while (after != kNone && in_front(entries_[after].item)) {
    before = after;
    after = entries_[after].next;
  }
  const uint32_t placed = store({{rank, hit.depth, look}, after, hit.opacity});
  (before == kNone ? pixel.translucent : entries_[before].next) = placed;
  double left = 1;
  for (uint32_t entry = pixel.translucent; entry != kNone && left > kSeenThrough; entry = entries_[entry].next) {
    left *= 1 - entries_[entry].opacity;
    if (left <= kSeenThrough) pixel.occluder = entries_[entry].item.depth;
  }
  drop_hidden(pixel);
}

std::optional<ShownItem> PixelHits::shown(const glm::ivec2& at) const {
  double left = 1;
  for (uint32_t entry = pixels_[index_of(at)].translucent; entry != kNone; entry = entries_[entry].next) {
    left *= 1 - entries_[entry].opacity;
    if (left <= kSeenThrough) return entries_[entry].item;
  }
  uint32_t entry = pixels_[index_of(at)].nearest;
  if (entry == kNone) return std::nullopt;
  while (entries_[entry].next != kNone) entry = entries_[entry].next;
  return entries_[entry].item;
}

}  // namespace surfcast::kinds
