#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

namespace surfcast::service {

/// Who has asked for something: a network address with all its connections, see net/client_name.h. 0: nobody in
/// particular.
using ClientId = uint64_t;

/// How much time was spent on each client that wants something, so that the one with the least is served next (deficit
/// round robin in milliseconds, Shreedhar and Varghese 1995; the costs are known only afterwards, so that what is kept
/// is not what a client may still spend, but what it has spent). A client that comes back is not owed the time that it
/// was away. Not thread-safe.
class ClientShares {
 public:
  /// A client has one more job, which waits or is worked on.
  void enter(ClientId client);
  /// It has one less.
  void leave(ClientId client);
  /// Work on a job of the client has taken so long.
  void charge(ClientId client, double milliseconds);
  /// Milliseconds that the client is ahead of one that has just come; 0 or more while it has jobs.
  [[nodiscard]] double used(ClientId client) const;

 private:
  struct Account {
    double used = 0;
    size_t jobs = 0;
  };

  [[nodiscard]] double least_used() const;

  std::map<ClientId, Account> accounts_;  ///< of clients with jobs, and of those that have had more than others
};

}  // namespace surfcast::service
