#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "service/job_queue.h"
#include "service/render_service.h"

namespace surfcast::net {

/// The requests of one connection that have not been answered, and which of them is drawn next. A client that does not
/// read its answers has no further picture drawn: its requests wait here, and it costs nobody but itself.
class RequestWindow {
 public:
  using RequestId = uint64_t;

  struct Limits {
    size_t outstanding = 64;                   ///< requests without an answer
    size_t drawing = 2;                        ///< of them with the service: one drawn while the next one waits
    size_t outgoing_bytes = size_t{32} << 20;  ///< unread answers beyond which nothing more is drawn
  };

  explicit RequestWindow(const Limits& limits) : limits_(limits) {}

  /// Whether a request of that id may come in: not while one of the same id or too many are outstanding.
  [[nodiscard]] Status admit(RequestId id) const;

  /// Takes a picture that was admitted; it waits until `next` hands it out.
  void add_picture(RequestId id, service::PictureJob job) { waiting_.emplace_back(id, std::move(job)); }
  /// Takes any other request that was admitted; it is under way at once.
  void add_other(RequestId id) { active_.emplace(id, Active{}); }

  /// The next picture to give to the service, if there may be one now. It counts as under way from here on.
  std::optional<std::pair<RequestId, service::PictureJob>> next(size_t outgoing_bytes);
  /// Notes the service's name for a picture under way, unless it has finished already.
  void set_job(RequestId id, service::JobId job);

  /// Takes a picture out that still waits; false when it does not.
  bool remove_waiting(RequestId id);
  /// The service's name of a picture under way.
  [[nodiscard]] std::optional<service::JobId> job(RequestId id) const;
  /// Forgets what has been answered.
  void finish(RequestId id);
  /// Forgets what waits and tells what is under way at the service.
  std::vector<service::JobId> abandon();

  [[nodiscard]] size_t outstanding() const { return waiting_.size() + active_.size(); }

 private:
  struct Active {
    bool picture = false;
    std::optional<service::JobId> job;  ///< of a picture, once the service has named it
  };

  Limits limits_;
  std::deque<std::pair<RequestId, service::PictureJob>> waiting_;
  std::map<RequestId, Active> active_;
  size_t drawing_ = 0;  ///< pictures among active_
};

}  // namespace surfcast::net
