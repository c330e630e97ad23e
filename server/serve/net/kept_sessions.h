#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "view/quality_controller.h"

namespace surfcast::net {

/// A view of a session whose connection is gone: what it takes to open it again.
struct KeptView {
  uint64_t id = 0;      ///< of its OpenView
  std::string picture;  ///< encoded wire::DrawPicture, what was asked for last
  uint64_t update = 0;  ///< the number of that picture
  double target_fps = 0;
  bool depth = false;                                  ///< as in OpenView
  bool video = false;                                  ///< the client decodes VP9
  view::QualityState quality = view::first_quality();  ///< of frames in motion
};

/// Sessions that can be gone on with over another connection. Views without a connection wait undrawn. Used on the
/// thread of the sockets.
class KeptSessions {
 public:
  using Clock = std::chrono::steady_clock;

  struct Limits {
    std::chrono::milliseconds time{180'000};  ///< that a session waits for its client
    size_t view_bytes = size_t{8} << 10;      ///< of a view; a larger one does not wait
    size_t sessions = 256;  ///< that wait; for one more, the oldest of who has most of them goes; 0: none does
  };

  /// Whoever has the connection of a session.
  class Holder {
   public:
    virtual ~Holder() = default;
    /// The client has come over another connection: ends this one.
    virtual std::vector<KeptView> hand_over() = 0;
  };

  explicit KeptSessions(const Limits& limits) : limits_(limits) {}

  /// Begins a session. `owner`: who alone may go on with it; `client`: whose sessions are counted together. Returns the
  /// secret that names it; empty: none is kept.
  std::string begin(std::weak_ptr<Holder> holder, std::string owner, std::string client);
  /// The connection is gone.
  void keep(const std::string& secret, std::vector<KeptView> views, Clock::time_point now);
  /// The views of a session, which ends with it; none if there is no such session of that owner.
  std::vector<KeptView> take(const std::string& secret, const std::string& owner, Clock::time_point now);
  void forget(const std::string& secret) { sessions_.erase(name_of(secret)); }

  /// Sessions that wait.
  [[nodiscard]] size_t waiting(Clock::time_point now);
  [[nodiscard]] std::chrono::milliseconds time() const { return limits_.time; }

 private:
  struct Session {
    std::weak_ptr<Holder> holder;
    std::string owner;
    std::string client;
    std::vector<KeptView> views{};
    bool waiting = false;
    Clock::time_point since{};  ///< waiting
  };

  /// What a secret is looked up by: how long that takes tells nothing about others.
  static std::string name_of(const std::string& secret);
  void drop_outdated(Clock::time_point now);
  void make_room();

  Limits limits_;
  std::map<std::string, Session> sessions_;  ///< by name_of their secrets
};

}  // namespace surfcast::net
