#include "service/renderer_choice.h"

#include <cstdint>
#include <span>
#include <utility>

#include "base/contract.h"
#include "base/hash.h"

namespace surfcast::service {
namespace {

/// By how many fewer pictures wait for a renderer before it draws those of another one. Views have at most one waiting
/// each, so that this many views of a model share one renderer.
constexpr size_t kLead = 4;

uint64_t weight_of(std::string_view model, size_t renderer) {
  return hash_of(std::as_bytes(std::span(model.data(), model.size())), renderer);
}

}  // namespace

RendererChoice rank_renderers(std::string_view model, size_t renderers) {
  SURFCAST_EXPECTS(renderers > 0);
  std::pair<uint64_t, size_t> best{weight_of(model, 0), 0};
  std::optional<std::pair<uint64_t, size_t>> second;
  for (size_t i = 1; i < renderers; ++i) {
    std::pair<uint64_t, size_t> next{weight_of(model, i), i};
    if (next > best) std::swap(next, best);
    if (!second || next > *second) second = next;
  }
  return {best.second, second ? second->second : best.second};
}

size_t choose_renderer(const RendererChoice& choice, size_t waiting_first, size_t waiting_second,
                       std::optional<size_t> former) {
  const bool prefers_second = former && *former == choice.second && choice.first != choice.second;
  const size_t own = prefers_second ? waiting_second : waiting_first;
  const size_t others = prefers_second ? waiting_first : waiting_second;
  const bool moves = own >= others + kLead;
  return prefers_second != moves ? choice.second : choice.first;
}

}  // namespace surfcast::service
