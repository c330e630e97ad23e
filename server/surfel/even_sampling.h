#pragma once

namespace surfcast {

/// A surfel's radius is the mean distance to its six nearest neighbours: 1.08 h on an even sampling of spacing h.
inline constexpr double kRadiusOverSpacing = 1.08;

}  // namespace surfcast
