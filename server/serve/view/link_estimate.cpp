#include "view/link_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace surfcast::view {
namespace {

constexpr size_t kSamples = 256;
constexpr size_t kRecent = 24;     // samples, of which the slope is
constexpr double kLarger = 1.5;    // times the bytes of the quickest message; smaller ones are of its size
constexpr double kNewShare = 0.3;  // weight of a new slope against the previous estimate

double milliseconds_between(ViewTime from, ViewTime to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

ViewTime later(ViewTime time, double milliseconds) {
  return time + std::chrono::duration_cast<ViewTime::duration>(std::chrono::duration<double, std::milli>(milliseconds));
}

/// Where the samples begin that tell the slope.
auto first_recent(const auto& samples) {
  return samples.end() - static_cast<ptrdiff_t>(std::min(samples.size(), kRecent));
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
  samples_.push_back({static_cast<double>(message.bytes), std::max(milliseconds_between(begin, arrival), 0.01),
                      milliseconds_between(message.sent, arrival)});
  if (samples_.size() > kSamples) samples_.pop_front();
  learn_rate_now(samples_.back(), arrival);
  last_arrival_ = arrival;
  learn_slope();
  return transfer_ms(message.bytes);
}

double LinkEstimate::round_trip_ms() const {
  if (!slope_known_) return 0;
  double least = std::numeric_limits<double>::max();
  for (auto sample = first_recent(samples_); sample != samples_.end(); ++sample) {
    least = std::min(least, sample->elapsed - sample->bytes * ms_per_byte_);
  }
  return std::max(least, 0.0);
}

/// The milliseconds of a byte, by messages of two sizes. Both groups are late by the same delays on average, while the
/// quickest message is not: compared with that alone, delays would count as a slow line.
std::optional<double> LinkEstimate::slope() const {
  const auto first = first_recent(samples_);
  const Sample quickest = *std::ranges::min_element(first, samples_.end(), {}, &Sample::milliseconds);
  Group small;
  Group large;
  for (auto s = first; s != samples_.end(); ++s) (s->bytes < kLarger * quickest.bytes ? small : large).add(*s);
  if (large.count == 0) return std::nullopt;
  const double milliseconds = large.mean_milliseconds() - small.mean_milliseconds();
  return std::max(milliseconds / (large.mean_bytes() - small.mean_bytes()), 1e-9);
}

void LinkEstimate::learn_slope() {
  const Sample& sample = samples_.back();
  if (const std::optional<double> measured = slope()) {
    ms_per_byte_ = slope_known_ ? ms_per_byte_ + kNewShare * (*measured - ms_per_byte_) : *measured;
    slope_known_ = true;
  } else if (!slope_known_) {
    const double most = sample.milliseconds / std::max(sample.bytes, 1.0);
    ms_per_byte_ = ms_per_byte_ > 0 ? std::min(ms_per_byte_, most) : most;
  }
}

/// An upper bound of the rate by one message. Its time beyond that of the quickest message transferred the bytes that
/// it has beyond the quickest one. Of a message of the same size that difference is noise, so all of its bytes count. A
/// message that waited for the one before was transferred in the time since that one arrived.
double LinkEstimate::most_bytes_per_ms(double bytes, double elapsed, double since_arrival) const {
  constexpr double kNoise = 5;  // ms by which times of messages vary for other reasons
  constexpr double kMinMs = 0.5;
  const Sample quickest = quickest_message();
  if (elapsed - since_arrival > quickest.elapsed) return bytes / std::max(since_arrival, kMinMs);
  const double common = std::clamp(bytes - quickest.bytes, 0.0, quickest.bytes);
  return (bytes - common) / std::max(elapsed - quickest.elapsed - kNoise, kMinMs);
}

/// The rate grows step by step, up to what the better one of the last two messages allows. Small messages are no
/// evidence that more would fit.
void LinkEstimate::learn_rate_now(const Sample& message, ViewTime arrival) {
  constexpr double kGrowth = 1.25;
  constexpr double kEvidenceMs = 8;  // of the link, that a message takes at least
  if (!last_arrival_) {
    last_most_ = bytes_per_ms_now_ = message.bytes / std::max(message.elapsed, 1.0);
    return;
  }
  const double most = most_bytes_per_ms(message.bytes, message.elapsed, milliseconds_between(*last_arrival_, arrival));
  const bool evidence = message.bytes > kEvidenceMs * bytes_per_ms_now_;
  const double grown = bytes_per_ms_now_ * (evidence ? kGrowth : 1);
  bytes_per_ms_now_ = std::min(grown, std::max(most, std::exchange(last_most_, most)));
}

/// A message that is on the way for longer than it should be is evidence already.
std::optional<size_t> LinkEstimate::bytes_now_in(double milliseconds, ViewTime now) const {
  constexpr double kMax = 1e9;
  if (bytes_per_ms_now_ <= 0) return std::nullopt;
  double bytes_per_ms = bytes_per_ms_now_;
  if (!on_the_way_.empty()) {
    const auto bytes = static_cast<double>(on_the_way_.front().bytes);
    const double most = most_bytes_per_ms(bytes, waits_ms(now), milliseconds_between(*last_arrival_, now));
    bytes_per_ms = std::min(bytes_per_ms, most);
  }
  return static_cast<size_t>(std::min(milliseconds * bytes_per_ms, kMax));
}

LinkEstimate::Sample LinkEstimate::quickest_message() const {
  return samples_.empty() ? Sample{} : *std::ranges::min_element(samples_, {}, &Sample::elapsed);
}

double LinkEstimate::least_elapsed_ms() const {
  return quickest_message().elapsed;
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
  constexpr double kMax = 1e9;
  if (ms_per_byte_ <= 0) return std::nullopt;
  return static_cast<size_t>(std::min(milliseconds / ms_per_byte_, kMax));
}

}  // namespace surfcast::view
