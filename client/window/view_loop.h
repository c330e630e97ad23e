#pragma once

#include "client/server_connection.h"

namespace surfcast::window {

/// What is looked at, and how.
struct ViewRequest {
  protocol::ModelUrl url;
  wire::DrawPicture picture;  ///< its resolution is the window's at first
  double target_fps = 0;      ///< as in OpenView
};

/// Shows a model in a window until somebody closes it. Comes back to the same view when the server was away; fails when
/// it was never there.
Status view_in_window(const ViewRequest& request, const client::ClientConfig& config);

}  // namespace surfcast::window
