#pragma once

#include "client/navigation.h"
#include "geometry/box.h"

namespace surfcast::window {

/// What is looked at, as far as views of all of it ask.
struct Subject {
  geometry::Box bounds;
  bool z_up = true;  ///< otherwise y points to the sky
};

/// The usual sides, as in the browser: the front of a z-up model faces -y, that of a y-up one +z.
enum class StandardView { kFront, kRight, kBack, kLeft, kTop, kBottom, kIso };

/// The nearest pose that looks the same way and sees all of the subject; `aspect` is width over height.
client::Pose fit_pose(const client::Pose& pose, const Subject& subject, double aspect);
/// All of the subject from one of the usual sides.
client::Pose standard_pose(StandardView view, const client::Pose& pose, const Subject& subject, double aspect);

}  // namespace surfcast::window
