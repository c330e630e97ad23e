#pragma once

#include "client/navigation.h"
#include "geometry/box.h"

namespace surfcast::window {

/// The properties of the model that determine a view of the whole model.
struct Subject {
  geometry::Box bounds;
  bool z_up = true;          ///< whether the vertical axis is z; otherwise it is y
  bool upside_down = false;  ///< the vertical axis points down
};

/// The same standard views as in the browser. The front of a z-up model faces -y, that of a y-up model +z, and that of
/// a model whose y points down -z.
enum class StandardView { kFront, kRight, kBack, kLeft, kTop, kBottom, kIso };

/// The nearest pose with the same view direction that shows the whole subject. `aspect` is width over height.
client::Pose fit_pose(const client::Pose& pose, const Subject& subject, double aspect);
/// The whole subject in a standard view.
client::Pose standard_pose(StandardView view, const client::Pose& pose, const Subject& subject, double aspect);

}  // namespace surfcast::window
