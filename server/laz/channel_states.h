#pragma once

#include <array>
#include <cstdint>
#include <memory>

namespace surfcast::laz {

/// What is known of an item in each of the four scanner channels. A channel begins with its first point, and goes on
/// from the last value of the channel before. `State` is made from that value and has it as its member `last`.
template <typename State>
class ChannelStates {
 public:
  ChannelStates(uint32_t channel, const decltype(State::last)& first) : current_(channel) {
    states_[channel] = std::make_unique<State>(first);
  }

  State& current() { return *states_[current_]; }
  [[nodiscard]] uint32_t channel() const { return current_; }

  /// Makes `channel` the current one. Returns the state that was current, or the new one if it had to be made.
  State& change(uint32_t channel) {
    State& before = current();
    current_ = channel;
    if (states_[channel]) return before;
    states_[channel] = std::make_unique<State>(before.last);
    return *states_[channel];
  }

 private:
  std::array<std::unique_ptr<State>, 4> states_;
  uint32_t current_;
};

}  // namespace surfcast::laz
