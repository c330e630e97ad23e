#include "service/client_places.h"

namespace surfcast::service {

std::shared_ptr<const void> ClientPlaces::take(ClientId client) {
  const auto give_back = [state = state_, client](const void* /*place*/) {
    const std::lock_guard lock(state->mutex);
    ++state->free;
    if (--state->held[client] == 0) state->held.erase(client);
  };
  {
    const std::lock_guard lock(state_->mutex);
    size_t& held = state_->held[client];
    if (held >= state_->free) {
      if (held == 0) state_->held.erase(client);
      return nullptr;
    }
    ++held;
    --state_->free;
  }
  return {state_.get(), give_back};
}

}  // namespace surfcast::service
