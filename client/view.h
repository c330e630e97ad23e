#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include "client/server_connection.h"
#include "surfcast.pb.h"

namespace surfcast::client {

/// What a view asks for beside its picture; as in OpenView.
struct ViewWishes {
  double target_fps = 0;  ///< 0: the server's default
  bool depth = false;
  bool video = false;  ///< VP9: whoever asks for it decodes it
  bool early = false;  ///< also frames of which more is on the way, see Frame::whole
};

/// A view of one model, for which the server sends pictures while the camera moves and rests. The connection must
/// outlive the view and must not be used for other requests meanwhile.
class View {
 public:
  using Clock = std::chrono::steady_clock;

  struct Frame {
    wire::ViewFrame frame;      ///< its data are those of a complete file or packet
    Clock::time_point arrived;  ///< arrival of its last byte
    uint64_t bytes = 0;         ///< received on the connection since the previous frame
    /// False: a sharper picture of the same frame follows, unless the server gives it up. It is less sharp than a frame
    /// at rest, but sharper than one in motion.
    bool whole = true;
  };

  static Result<View> open(ServerConnection& connection, const wire::DrawPicture& picture, const ViewWishes& wishes);

  /// Goes on over another connection, whose server has the view open again (ServerConnection::resume).
  void go_on(ServerConnection& connection);
  /// Its number, as wire::Resumed names it.
  [[nodiscard]] uint64_t id() const { return id_; }

  /// Changes the picture of the view. Returns the update number; frames that show this picture repeat it.
  Result<uint64_t> show(const wire::DrawPicture& picture, bool moving);
  /// The next frame, or nothing if none is complete by `deadline`. The caller must acknowledge it with `painted`.
  Result<std::optional<Frame>> next_until(Clock::time_point deadline);
  /// Acknowledges that the frame is on the screen, so that the server may send another one. Nothing to do for a frame
  /// that is not whole.
  Status painted(const Frame& frame);
  /// Requests the surfel at a pixel of a picture. Replaces an earlier request that has no result yet.
  Status pick(const wire::DrawPicture& picture, uint32_t x, uint32_t y);
  /// The result of the last pick request, once. It is received during `next_until`. A failed request has no result.
  std::optional<wire::PickResult> take_picked() { return std::exchange(picked_, std::nullopt); }
  /// Ends the view. Discards the frames that arrive before the server's confirmation.
  Status close();

  /// Number of frames that the server dropped for a newer one before their data was complete.
  [[nodiscard]] uint64_t abandoned() const { return abandoned_; }

 private:
  View(ServerConnection& connection, uint64_t id, bool early) : connection_(&connection), id_(id), early_(early) {}
  Result<std::optional<Frame>> take(wire::ViewFrame frame);
  std::optional<Frame> early_frame();
  Status acknowledge(uint64_t frame, double client_ms);

  ServerConnection* connection_;
  uint64_t id_;
  uint64_t updates_ = 0;
  bool early_;
  std::optional<wire::ViewFrame> incomplete_;
  size_t shown_ = 0;  ///< bytes of its picture that early frames have
  uint64_t bytes_before_ = 0;
  uint64_t abandoned_ = 0;
  std::optional<uint64_t> pick_;  ///< id of the last pick request
  std::optional<wire::PickResult> picked_;
};

}  // namespace surfcast::client
