#pragma once

namespace surfcast::render {

// The times, over the time asked for, between which TimeSearch and ScaleSearch stop.
inline constexpr double kAimedTime = 0.93;  ///< some of it is left for what varies
inline constexpr double kShortTime = 0.82;  ///< a picture that takes as long is not improved
inline constexpr double kLongTime = 1.1;    ///< fits

}  // namespace surfcast::render
