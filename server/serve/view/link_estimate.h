#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "view/view_plan.h"

namespace surfcast::view {

/// Estimates the round trip and the rate of a client's connection, from the sizes of messages and the times of their
/// acknowledgements. The model: a message of b bytes takes round_trip + b / rate. Messages of two sizes tell the rate,
/// the quickest one the round trip. While the slope is unknown, the round trip counts as zero, which estimates the rate
/// too low rather than too high.
class LinkEstimate {
 public:
  void send(uint64_t frame, size_t bytes, ViewTime now);
  /// The client has acknowledged the oldest message of this frame after processing it for `client_ms`. Returns the
  /// estimated milliseconds that the message occupied the link, or none if no such message is in flight.
  std::optional<double> acknowledge(uint64_t frame, double client_ms, ViewTime now);

  /// Estimated milliseconds that a message of this size occupies the link; 0 while nothing is known.
  [[nodiscard]] double transfer_ms(size_t bytes) const;
  /// Estimated bytes that the link transfers in this time; none while nothing is known.
  [[nodiscard]] std::optional<size_t> bytes_in(double milliseconds) const;
  /// The same by another estimate, which follows a change of the link at once and does not need messages of different
  /// sizes. It is too high rather than too low while the line is not full.
  [[nodiscard]] std::optional<size_t> bytes_now_in(double milliseconds, ViewTime now) const;
  /// The least time of a message lately, which is no less than the round trip; 0 while nothing is known.
  [[nodiscard]] double least_elapsed_ms() const;
  /// Estimated round trip of an empty message; 0 while it is not known.
  [[nodiscard]] double round_trip_ms() const;
  /// Of messages that are not acknowledged.
  [[nodiscard]] size_t bytes_on_the_way() const;
  /// How long the oldest of them has waited for its acknowledgement; 0: there is none.
  [[nodiscard]] double waits_ms(ViewTime now) const;

 private:
  struct Message {
    uint64_t frame = 0;
    size_t bytes = 0;
    ViewTime sent;
  };
  /// A message that was acknowledged.
  struct Sample {
    double bytes = 0;
    double milliseconds = 0;  ///< from sending, or from when the link became free, to arrival
    double elapsed = 0;       ///< milliseconds from sending to arrival
  };
  /// Messages of about the same size.
  struct Group {
    void add(const Sample& sample) {
      bytes += sample.bytes;
      milliseconds += sample.milliseconds;
      ++count;
    }
    [[nodiscard]] double mean_bytes() const { return bytes / count; }
    [[nodiscard]] double mean_milliseconds() const { return milliseconds / count; }
    double bytes = 0;
    double milliseconds = 0;
    int count = 0;
  };
  void learn_slope();
  void learn_rate_now(const Sample& message, ViewTime arrival);
  [[nodiscard]] double most_bytes_per_ms(double bytes, double elapsed, double since_arrival) const;
  [[nodiscard]] Sample quickest_message() const;
  [[nodiscard]] std::optional<double> slope() const;

  std::deque<Message> on_the_way_;
  std::deque<Sample> samples_;            ///< the last ones
  double bytes_per_ms_now_ = 0;           ///< 0: unknown
  double last_most_ = 0;                  ///< most_bytes_per_ms() of the last message
  std::optional<ViewTime> last_arrival_;  ///< when the last acknowledged message reached the client
  double ms_per_byte_ = 0;                ///< 0: unknown
  bool slope_known_ = false;
};

}  // namespace surfcast::view
