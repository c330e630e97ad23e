#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "service/render_service.h"
#include "view/link_estimate.h"
#include "view/quality_controller.h"
#include "view/view_plan.h"

namespace surfcast::view {

/// What all views of a server have done.
struct ViewCounts {
  uint64_t open = 0;      ///< now
  uint64_t frames = 0;    ///< sent whole
  uint64_t replaced = 0;  ///< updates that were overtaken by a newer one before they were drawn
  uint64_t dropped = 0;   ///< frames given up while they were drawn, encoded or sent
  uint64_t bytes = 0;     ///< of encoded pictures, sent
};

/// A frame of a view, or a piece of one: then `picture.bytes` is that piece, and pieces after the first have nothing
/// else.
struct ViewMessage {
  uint64_t frame = 0;   ///< grows within the view
  uint64_t update = 0;  ///< the newest that it shows
  int width = 0;        ///< of the view, pixels; the picture may be smaller
  int height = 0;       ///< of the view, pixels
  bool moving = false;
  bool first = true;  ///< piece of the frame
  bool more = false;  ///< pieces follow
  service::EncodedPicture picture;
};

/// What is to be seen from now on.
struct ViewUpdate {
  uint64_t update = 0;
  service::PictureJob picture;
  bool changed = true;  ///< not the same picture as before
  bool moving = false;
};

/// How a view reaches its client. Functions are called on the view's thread.
struct ViewPort {
  std::function<void(ViewMessage)> send;
  std::function<void(const Error&)> fail;  ///< the view is over
  std::function<bool()> may_draw;          ///< false while the client does not take what it was sent
  /// From any thread: runs a task on the view's thread.
  std::function<void(std::function<void()>)> post;
};

/// A picture that follows a camera: drawn for speed while it moves, finer and finer once it rests (see ViewPlan). All
/// methods are called on one thread, the view's; drawing and encoding happen on the service's threads.
class ViewSession : public std::enable_shared_from_this<ViewSession> {
 public:
  ViewSession(service::RenderService& service, service::SessionId session, uint64_t viewer, double target_fps,
              ViewCounts& counts, ViewPort port);
  ~ViewSession();
  ViewSession(const ViewSession&) = delete;
  ViewSession& operator=(const ViewSession&) = delete;

  void update(ViewUpdate update, ViewTime now);
  /// The client has dealt with a message of that frame. Others than those on their way do not matter.
  void acknowledge(uint64_t frame, double client_ms, ViewTime now);
  /// Does what is due. When to be called again at the latest, if nothing happens before.
  std::optional<ViewTime> advance(ViewTime now);
  /// Gives up what is under way; nothing is sent from here on.
  void close();

 private:
  /// A frame from its beginning to its last acknowledgement.
  struct Job {
    FrameKind kind = FrameKind::kMotion;
    uint64_t update = 0;
    service::JobId job = 0;
    service::JobId supersedes = 0;  ///< the frame for motion before it
    QualityState quality;
    MotionCost cost;
    size_t unacknowledged = 0;  ///< messages
    bool sent = false;          ///< or dropped: it ends with its last acknowledgement
  };
  /// A frame that is being sent or waits for it.
  struct Outgoing {
    uint64_t frame = 0;
    FrameKind kind = FrameKind::kMotion;
    ViewMessage message;           ///< without its bytes
    std::vector<std::byte> bytes;  ///< of the whole frame
    size_t sent = 0;               ///< bytes
  };

  void draw(FrameKind kind);
  [[nodiscard]] service::PictureJob picture_job(FrameKind kind, service::JobId supersedes) const;
  void retarget();
  void drop(uint64_t frame);
  void erase_if_done(uint64_t frame);
  void finish(uint64_t frame, Result<service::EncodedPicture> picture);
  void frame_failed(uint64_t frame, const Error& error);
  void record_progress(service::EncodedPicture& picture, ViewTime now);
  void show(uint64_t frame, FrameKind kind, service::EncodedPicture picture);
  void give_up_sending();
  void send_pieces(ViewTime now);
  void send_piece(size_t bytes, ViewTime now);
  void adapt_quality(Job& job, double transfer_ms, double client_ms);

  service::RenderService& service_;
  service::SessionId session_;
  uint64_t viewer_;
  double target_fps_;
  ViewCounts& counts_;
  ViewPort port_;
  bool closed_ = false;

  ViewPlan plan_{ViewTiming{}};
  ViewUpdate newest_;
  LinkEstimate link_;
  QualityState quality_ = first_quality();
  uint64_t last_frame_ = 0;
  bool newest_begun_ = true;  ///< a frame of the newest picture has been begun
  service::JobId last_motion_job_ = 0;
  double last_draw_ms_ = 0;  ///< of the last frame that was drawn
  MotionCost last_cost_;     ///< of the last frame for motion that was acknowledged
  /// The newest picture, if the last frame at rest was all that it will be.
  std::shared_ptr<const picture::Frame> finished_frame_;
  uint64_t displayed_cut_ = 0;  ///< of the last frame at rest that was drawn of the newest picture; 0: none
  std::map<uint64_t, Job> frames_;
  std::optional<Outgoing> outgoing_;
};

}  // namespace surfcast::view
