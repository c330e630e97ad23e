#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace surfcast::service {

/// Two of several renderers that draw the same models. They are the same if there is only one.
struct RendererChoice {
  size_t first = 0;   ///< draws the model
  size_t second = 0;  ///< draws it, too, while many pictures of it wait
};

/// The renderers with the highest weights, which are hashes of the model's name and of their numbers (Thaler and
/// Ravishankar 1998: highest random weight). So each model is resident on one of them, and one renderer more or less
/// moves as few models as possible. `renderers`: how many there are, at least one.
RendererChoice rank_renderers(std::string_view model, size_t renderers);

/// The renderer for a picture. `waiting_first`, `waiting_second`: pictures that wait for either. `former`: the renderer
/// of the picture before of the same view, which has its blocks; none: the first one is preferred. The other one draws
/// the picture only if clearly fewer wait for it, because it has to load the model.
size_t choose_renderer(const RendererChoice& choice, size_t waiting_first, size_t waiting_second,
                       std::optional<size_t> former);

}  // namespace surfcast::service
