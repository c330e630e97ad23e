#pragma once

#include "client/server_connection.h"

namespace surfcast::window {

/// The model and picture of a view.
struct ViewRequest {
  protocol::ModelUrl url;
  wire::DrawPicture picture;  ///< its resolution is the initial size of the window
  double target_fps = 0;      ///< as in OpenView
};

/// Shows a model in a window until the user closes it. After a loss of the connection it reconnects and continues with
/// the same view. Fails if the first connection fails.
Status view_in_window(const ViewRequest& request, const client::ClientConfig& config);

}  // namespace surfcast::window
