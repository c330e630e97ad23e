#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "view/view_plan.h"

namespace surfcast::view {

/// What is known of the way to a client from messages of different sizes and the times of their acknowledgements: a
/// message of b bytes takes round_trip + b / rate. The smallest message seen fixes one end of that line and larger ones
/// its slope. Until a slope is known, the rate is taken as if there were no round trip: too small rather than too
/// large.
class LinkEstimate {
 public:
  void send(uint64_t frame, size_t bytes, ViewTime now);
  /// The client has acknowledged the oldest message of that frame after working on it for `client_ms`. Milliseconds
  /// that the message spent on the line itself; none when no such message is on its way.
  std::optional<double> acknowledge(uint64_t frame, double client_ms, ViewTime now);

  /// Milliseconds that so many bytes keep the line busy; 0 while nothing is known.
  [[nodiscard]] double transfer_ms(size_t bytes) const;
  /// How many bytes go through in that time; none while nothing is known.
  [[nodiscard]] std::optional<size_t> bytes_in(double milliseconds) const;

 private:
  struct Message {
    uint64_t frame = 0;
    size_t bytes = 0;
    ViewTime sent;
  };
  /// A message that arrived.
  struct Sample {
    double bytes = 0;
    double milliseconds = 0;  ///< from its sending, or from when the line was free for it, to its arrival
  };
  void learn(const Sample& sample);
  [[nodiscard]] double round_trip_ms() const;

  std::deque<Message> on_the_way_;
  std::deque<Sample> samples_;            ///< the newest
  std::optional<ViewTime> last_arrival_;  ///< of an acknowledgement, less what the client did
  double ms_per_byte_ = 0;                ///< 0: nothing is known
  bool slope_known_ = false;
};

}  // namespace surfcast::view
