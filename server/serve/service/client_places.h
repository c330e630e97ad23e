#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>

#include "service/client_shares.h"

namespace surfcast::service {

/// A number of places that clients hold for a while. A client may take one if it holds fewer than are free, so that of
/// 16 the first client gets 8, the next one 4, and so on: a single client never takes all of them. Thread-safe.
class ClientPlaces {
 public:
  explicit ClientPlaces(size_t places) : state_(std::make_shared<State>(places)) {}

  /// A place, which is free again when the pointer and its copies are gone; null: there is none for this client now.
  [[nodiscard]] std::shared_ptr<const void> take(ClientId client);

 private:
  struct State {
    explicit State(size_t places) : free(places) {}
    std::mutex mutex;
    size_t free;
    std::map<ClientId, size_t> held;
  };

  std::shared_ptr<State> state_;
};

}  // namespace surfcast::service
