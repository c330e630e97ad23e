#include "view/link_estimate.h"

#include <algorithm>
#include <cmath>

namespace surfcast::view {
namespace {

constexpr size_t kSamples = 24;
constexpr double kLarger = 1.5;    // times the bytes of the quickest message; smaller differences are noise
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
  last_arrival_ = arrival;
  learn({static_cast<double>(message.bytes), std::max(milliseconds_between(begin, arrival), 0.01)});
  return transfer_ms(message.bytes);
}

double LinkEstimate::round_trip_ms() const {
  if (samples_.empty()) return 0;
  const Sample& quickest = *std::ranges::min_element(samples_, {}, &Sample::milliseconds);
  return slope_known_ ? std::max(quickest.milliseconds - quickest.bytes * ms_per_byte_, 0.0) : 0.0;
}

void LinkEstimate::learn(const Sample& sample) {
  samples_.push_back(sample);
  if (samples_.size() > kSamples) samples_.pop_front();
  const Sample quickest = *std::ranges::min_element(samples_, {}, &Sample::milliseconds);
  double bytes = 0;
  double milliseconds = 0;
  for (const Sample& s : samples_) {
    if (s.bytes < kLarger * quickest.bytes) continue;
    bytes += s.bytes - quickest.bytes;
    milliseconds += s.milliseconds - quickest.milliseconds;
  }
  if (bytes > 0) {
    const double slope = std::max(milliseconds / bytes, 1e-9);
    ms_per_byte_ = slope_known_ ? ms_per_byte_ + kNewShare * (slope - ms_per_byte_) : slope;
    slope_known_ = true;
  } else if (!slope_known_) {
    const double most = sample.milliseconds / std::max(sample.bytes, 1.0);
    ms_per_byte_ = ms_per_byte_ > 0 ? std::min(ms_per_byte_, most) : most;
  }
}

double LinkEstimate::transfer_ms(size_t bytes) const {
  return static_cast<double>(bytes) * ms_per_byte_;
}

std::optional<size_t> LinkEstimate::bytes_in(double milliseconds) const {
  constexpr double kMost = 1e9;
  if (ms_per_byte_ <= 0) return std::nullopt;
  return static_cast<size_t>(std::min(milliseconds / ms_per_byte_, kMost));
}

}  // namespace surfcast::view
