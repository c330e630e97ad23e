#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include "client/server_connection.h"
#include "surfcast.pb.h"

namespace surfcast::client {

/// A view of one model: what a server shows of it while the camera moves and rests. The connection must outlive it, and
/// nothing else may be asked on the connection meanwhile.
class View {
 public:
  using Clock = std::chrono::steady_clock;

  struct Frame {
    wire::ViewFrame frame;      ///< whole
    Clock::time_point arrived;  ///< its last byte
    uint64_t bytes = 0;         ///< that the connection carried since the frame before it
  };

  /// `target_fps` is to be held while moving; 0: as the server likes.
  static Result<View> open(ServerConnection& connection, const wire::DrawPicture& picture, double target_fps);

  /// Shows something else. Returns the number that frames which show it will bear.
  Result<uint64_t> show(const wire::DrawPicture& picture, bool moving);
  /// The next frame, or nothing when none is whole by then. It must be acknowledged by `painted`.
  Result<std::optional<Frame>> next_until(Clock::time_point deadline);
  /// The frame is to be seen now: the server may send another one.
  Status painted(const Frame& frame);
  /// Asks what a picture shows at a pixel. A newer question takes the place of one that has no answer yet.
  Status pick(const wire::DrawPicture& picture, uint32_t x, uint32_t y);
  /// The answer, once; it arrives while frames are waited for. A question that failed has none.
  std::optional<wire::PickResult> take_picked() { return std::exchange(picked_, std::nullopt); }
  /// Ends the view; what comes until the server has heard of it is thrown away.
  Status close();

  /// Frames of which the server gave up the rest, because there was something newer to be seen.
  [[nodiscard]] uint64_t abandoned() const { return abandoned_; }

 private:
  View(ServerConnection& connection, uint64_t id) : connection_(&connection), id_(id) {}
  Result<std::optional<Frame>> take(wire::ViewFrame frame);
  Status acknowledge(uint64_t frame, double client_ms);

  ServerConnection* connection_;
  uint64_t id_;
  uint64_t updates_ = 0;
  std::optional<wire::ViewFrame> incomplete_;
  uint64_t bytes_before_ = 0;
  uint64_t abandoned_ = 0;
  std::optional<uint64_t> pick_;  ///< the question that waits for an answer
  std::optional<wire::PickResult> picked_;
};

}  // namespace surfcast::client
