#include "view/link_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surfcast::view {
namespace {

constexpr size_t kSamples = 24;
constexpr double kLarger = 1.5;    // times the bytes of the quickest message; smaller ones are of its size
constexpr size_t kTransfers = 4;
constexpr double kNewShare = 0.3;  // weight of a new slope against the previous estimate

double milliseconds_between(ViewTime from, ViewTime to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

ViewTime later(ViewTime time, double milliseconds) {
  return time + std::chrono::duration_cast<ViewTime::duration>(std::chrono::duration<double, std::milli>(milliseconds));
}

}  // namespace

void LinkEstimate::send(uint64_t frame, size_t bytes, ViewTime now) {
  on_the_way_.push_back({frame, bytes, now});
}

std::optional<double> LinkEstimate::acknowledge(uint64_t frame, double client_ms, ViewTime now) {
  const auto found = std::ranges::find(on_the_way_, frame, &Message::frame);
  if (found == on_the_way_.end()) return std::nullopt;
  const Message message = *found;
  on_the_way_.erase(found);
  const double elapsed = milliseconds_between(message.sent, now);
  const ViewTime arrival = later(now, -(std::isfinite(client_ms) ? std::clamp(client_ms, 0.0, elapsed) : 0.0));
  // A message sent while another one occupied the link starts when the other one has arrived.
  ViewTime begin = message.sent;
  if (last_arrival_) begin = std::max(begin, later(*last_arrival_, -round_trip_ms()));
  const double elapsed_at_client = milliseconds_between(message.sent, arrival);
  learn_now(static_cast<double>(message.bytes), elapsed_at_client,
            last_arrival_ ? milliseconds_between(*last_arrival_, arrival) : elapsed_at_client);
  last_arrival_ = arrival;
  const double occupied = std::max(milliseconds_between(begin, arrival), 0.01);
  learn({static_cast<double>(message.bytes), occupied, elapsed_at_client});
  return transfer_ms(message.bytes);
}

double LinkEstimate::round_trip_ms() const {
  if (!slope_known_) return 0;
  double least = std::numeric_limits<double>::max();
  for (const Sample& sample : samples_) least = std::min(least, sample.elapsed - sample.bytes * ms_per_byte_);
  return std::max(least, 0.0);
}

/// The milliseconds of a byte, by messages of two sizes. Both groups are late by the same delays on average, while the
/// quickest message is not: compared with that alone, delays would count as a slow line.
std::optional<double> LinkEstimate::slope() const {
  const Sample quickest = *std::ranges::min_element(samples_, {}, &Sample::milliseconds);
  Group small;
  Group large;
  for (const Sample& s : samples_) (s.bytes < kLarger * quickest.bytes ? small : large).add(s);
  if (large.count == 0) return std::nullopt;
  const double milliseconds = large.mean_milliseconds() - small.mean_milliseconds();
  return std::max(milliseconds / (large.mean_bytes() - small.mean_bytes()), 1e-9);
}

void LinkEstimate::learn(const Sample& sample) {
  samples_.push_back(sample);
  if (samples_.size() > kSamples) samples_.pop_front();
  if (const std::optional<double> measured = slope()) {
    ms_per_byte_ = slope_known_ ? ms_per_byte_ + kNewShare * (*measured - ms_per_byte_) : *measured;
    slope_known_ = true;
  } else if (!slope_known_) {
    const double most = sample.milliseconds / std::max(sample.bytes, 1.0);
    ms_per_byte_ = ms_per_byte_ > 0 ? std::min(ms_per_byte_, most) : most;
  }
}

/// A message occupies the link since it was sent or since the one before has arrived.
void LinkEstimate::learn_now(double bytes, double elapsed, double since_arrival) {
  constexpr double kLeast = 0.5;  // ms: below what is noise in the times
  fixed_round_trip_ms_ = std::min(fixed_round_trip_ms_, elapsed);
  transfers_.push_back({bytes, std::max(std::min(elapsed - fixed_round_trip_ms_, since_arrival), kLeast)});
  if (transfers_.size() > kTransfers) transfers_.pop_front();
}

/// What is on the way for longer than it should be is evidence already.
std::optional<double> LinkEstimate::ms_per_byte_now(ViewTime now) const {
  if (transfers_.empty()) return std::nullopt;
  Transfer sum;
  for (const Transfer& transfer : transfers_) {
    sum.bytes += transfer.bytes;
    sum.milliseconds += transfer.milliseconds;
  }
  const double acknowledged = sum.milliseconds / std::max(sum.bytes, 1.0);
  if (on_the_way_.empty()) return acknowledged;
  const double waits = std::min(waits_ms(now) - fixed_round_trip_ms_, milliseconds_between(*last_arrival_, now));
  return std::max(acknowledged, waits / std::max(static_cast<double>(on_the_way_.front().bytes), 1.0));
}

std::optional<size_t> LinkEstimate::bytes_now_in(double milliseconds, ViewTime now) const {
  constexpr double kMost = 1e9;
  const std::optional<double> ms_per_byte = ms_per_byte_now(now);
  if (!ms_per_byte) return std::nullopt;
  return static_cast<size_t>(std::min(milliseconds / *ms_per_byte, kMost));
}

double LinkEstimate::transfer_ms(size_t bytes) const {
  return static_cast<double>(bytes) * ms_per_byte_;
}

size_t LinkEstimate::bytes_on_the_way() const {
  size_t bytes = 0;
  for (const Message& message : on_the_way_) bytes += message.bytes;
  return bytes;
}

double LinkEstimate::waits_ms(ViewTime now) const {
  return on_the_way_.empty() ? 0 : milliseconds_between(on_the_way_.front().sent, now);
}

std::optional<size_t> LinkEstimate::bytes_in(double milliseconds) const {
  constexpr double kMost = 1e9;
  if (ms_per_byte_ <= 0) return std::nullopt;
  return static_cast<size_t>(std::min(milliseconds / ms_per_byte_, kMost));
}

}  // namespace surfcast::view
