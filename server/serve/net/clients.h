#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace surfcast::net {

/// How many connections and views there may be. 0 for a client: as many as there may be at all.
struct ClientLimits {
  size_t connections = 256;            ///< of all clients together
  size_t connections_per_client = 64;  ///< one client leaves most of them to others
  size_t views_per_client = 0;         ///< on all its connections together
};

/// What each client (see client_name) has open. Used on the thread of the sockets.
class Clients {
 public:
  struct Counts {
    size_t connections = 0;  ///< that are served
    size_t refused = 0;      ///< that are only told why they are not
    size_t views = 0;
  };

  explicit Clients(const ClientLimits& limits) : limits_(limits) {}

  /// Why another connection of that client is not served, in words for it; empty: it is.
  [[nodiscard]] std::string refusal_of_connection(const std::string& client) const;
  /// Whether that is because of the client's own number of connections.
  [[nodiscard]] bool has_all_its_connections(const std::string& client) const;
  /// Likewise another view.
  [[nodiscard]] std::string refusal_of_view(const std::string& client) const;
  /// Of all clients.
  [[nodiscard]] const Counts& all() const { return all_; }
  [[nodiscard]] Counts counts_of(const std::string& client) const;

  void add(const std::string& client, size_t Counts::*what);
  void remove(const std::string& client, size_t Counts::*what);

 private:
  ClientLimits limits_;
  Counts all_;
  std::map<std::string, Counts> counts_;  ///< by name, of clients that have anything open
};

/// Counts something of a client for as long as it lives.
class Counted {
 public:
  Counted(std::shared_ptr<Clients> clients, std::string client, size_t Clients::Counts::*what)
      : clients_(std::move(clients)), client_(std::move(client)), what_(what) {
    clients_->add(client_, what_);
  }
  ~Counted() {
    if (clients_) clients_->remove(client_, what_);
  }
  Counted(Counted&&) = default;
  Counted& operator=(Counted&& other) noexcept {
    std::swap(clients_, other.clients_);
    std::swap(client_, other.client_);
    std::swap(what_, other.what_);
    return *this;
  }

  [[nodiscard]] const std::string& client() const { return client_; }

 private:
  std::shared_ptr<Clients> clients_;
  std::string client_;
  size_t Clients::Counts::*what_;
};

}  // namespace surfcast::net
