#pragma once

#include <array>
#include <cstdint>
#include <memory>

namespace surfcast::laz {

/// The decoder state of an item in each of the four scanner channels. A channel starts with its first point, from the
/// last value of the previous channel. `State` is constructed from this value and holds it in its member `last`.
template <typename State>
class ChannelStates {
 public:
  ChannelStates(uint32_t channel, const decltype(State::last)& first) : current_(channel) {
    states_[channel] = std::make_unique<State>(first);
  }

  State& current() { return *states_[current_]; }
  [[nodiscard]] uint32_t channel() const { return current_; }

  /// Makes `channel` current. Returns the previous state, or the new state if it had to be created.
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
