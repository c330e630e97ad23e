#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "service/render_service.h"
#include "view/camera_forecast.h"
#include "view/link_estimate.h"
#include "view/quality_controller.h"
#include "view/view_plan.h"

namespace surfcast::view {

/// Statistics over all views of a server.
struct ViewCounts {
  uint64_t open = 0;      ///< currently open views
  uint64_t frames = 0;    ///< frames sent completely
  uint64_t replaced = 0;  ///< updates superseded by a newer one before they were drawn
  uint64_t dropped = 0;   ///< frames cancelled while they were drawn, encoded or sent
  uint64_t bytes = 0;     ///< of encoded pictures sent
};

/// A frame of a view, or a piece of one. `picture.bytes` of a piece holds its part of the encoded picture; all other
/// fields of `picture` are set in the first piece only.
struct ViewMessage {
  uint64_t frame = 0;   ///< increases within the view
  uint64_t update = 0;  ///< the newest update that the frame shows
  int width = 0;        ///< of the view, pixels; the picture may be smaller
  int height = 0;       ///< of the view, pixels
  bool moving = false;
  bool first = true;  ///< first piece of the frame
  bool more = false;  ///< more pieces follow
  service::EncodedPicture picture;
};

/// The picture to show from now on.
struct ViewUpdate {
  uint64_t update = 0;
  service::PictureJob picture;
  bool changed = true;  ///< false if the picture is the same as before
  bool moving = false;
};

/// The connection of a view to its client. All functions but `post` are called on the view's thread.
struct ViewPort {
  std::function<void(ViewMessage)> send;
  std::function<void(const Error&)> fail;  ///< the view has ended with this error
  std::function<bool()> may_draw;          ///< false while the client does not read what it was sent
  /// Runs a task on the view's thread. May be called from any thread.
  std::function<void(std::function<void()>)> post;
};

struct ViewOptions {
  static constexpr size_t kKeptBytes = size_t{32} << 20;  ///< a frame of 8 million pixels

  double target_fps = 30;
  /// Frames have a depth, where it is known, by which the client warps them. While they have one, those in motion are
  /// drawn for the camera that the client has when they arrive, as far as that can be told from the cameras before.
  bool depth = false;
  /// The client decodes VP9: frames in motion may be packets of a video, where files would have to be small or coarse
  /// for the link. Without the module of the codec they are files.
  bool video = false;
  /// Of pixels at most, a frame at rest is kept to make the final picture of it without drawing again.
  size_t kept_bytes = kKeptBytes;
};

/// A picture that follows a camera: optimised for speed during motion, refined step by step at rest (see ViewPlan). All
/// methods must be called on the view's thread; drawing and encoding run on the threads of the service.
class ViewSession : public std::enable_shared_from_this<ViewSession> {
 public:
  /// All its pictures are of that model.
  ViewSession(service::RenderService& service, const service::Client& client, const access::AuthorizedModel& model,
              uint64_t viewer, const ViewOptions& options, ViewCounts& counts, ViewPort port);
  ~ViewSession();
  ViewSession(const ViewSession&) = delete;
  ViewSession& operator=(const ViewSession&) = delete;

  /// Frames in motion begin with this quality, as another view had it.
  void begin_with(const QualityState& quality) { quality_ = quality; }
  [[nodiscard]] const QualityState& quality() const { return quality_; }
  void update(ViewUpdate update, ViewTime now);
  /// The client has processed a message of this frame. Unknown frames are ignored.
  void acknowledge(uint64_t frame, double client_ms, ViewTime now);
  /// The service may have a newer edition of the model.
  void model_changed();
  /// Performs all actions that are due. Returns the latest time of the next call, none if only an event can cause one.
  std::optional<ViewTime> advance(ViewTime now);
  /// Cancels all work. Nothing is sent afterwards.
  void close();

 private:
  /// A frame, from the start of drawing to its last acknowledgement.
  struct Job {
    FrameKind kind = FrameKind::kMotion;
    uint64_t update = 0;
    service::JobId job = 0;
    service::JobId supersedes = 0;  ///< the previous motion frame
    uint64_t edition = 0;           ///< of the model
    QualityState quality;
    MotionCost cost;
    bool video = false;         ///< to be a packet of the video; once drawn: it is one
    ViewTime begun;             ///< when its camera was chosen
    size_t unacknowledged = 0;  ///< messages
    bool sent = false;          ///< sent or dropped: the job ends with its last acknowledgement
  };
  /// A frame that is being sent or waits to be sent.
  struct Outgoing {
    uint64_t frame = 0;
    FrameKind kind = FrameKind::kMotion;
    ViewMessage message;                 ///< without picture bytes
    std::vector<std::byte> bytes;        ///< the complete encoded picture
    size_t sent = 0;                     ///< bytes sent so far
    std::shared_ptr<const void> memory;  ///< counts `bytes`
  };

  void draw(FrameKind kind, ViewTime now);
  void settle_edition();
  void take_over(uint64_t frame, service::EncodedPicture& picture);
  [[nodiscard]] bool may_be_kept(const service::PictureJob& job) const;
  [[nodiscard]] uint64_t next_edition(FrameKind kind, ViewTime now);
  [[nodiscard]] service::PictureJob picture_job(FrameKind kind, uint64_t frame, ViewTime now) const;
  void make_motion_job(uint64_t frame, ViewTime now, service::PictureJob& job) const;
  [[nodiscard]] MotionQuality motion_quality(size_t video_bytes) const;
  [[nodiscard]] double view_pixels() const;
  [[nodiscard]] double motion_fps() const;
  [[nodiscard]] size_t video_frame_bytes(ViewTime now) const;
  void choose_codec(ViewTime now);
  void give_up_video();
  [[nodiscard]] bool follows(const service::EncodedPicture& picture) const;
  void withdraw(const Result<service::EncodedPicture>& picture);
  void record_size(const service::EncodedPicture& picture, const Job& job);
  void retarget(ViewTime now);
  void drop(uint64_t frame);
  void drop_former_editions();
  void erase_if_done(uint64_t frame);
  void finish(uint64_t frame, Result<service::EncodedPicture> picture);
  void frame_failed(uint64_t frame, const Error& error);
  void record_progress(service::EncodedPicture& picture, ViewTime now);
  void show(uint64_t frame, FrameKind kind, service::EncodedPicture picture);
  void give_up_sending();
  void send_pieces(ViewTime now);
  void send_piece(size_t bytes, ViewTime now);
  [[nodiscard]] size_t window(ViewTime now) const;
  /// `late`: the frame took kLateMs longer than the quickest message.
  void adapt_quality(Job& job, double transfer_ms, double client_ms, bool late);

  service::RenderService& service_;
  service::Client client_;
  uint64_t viewer_;
  ViewOptions options_;
  ViewCounts& counts_;
  ViewPort port_;
  bool closed_ = false;

  ViewPlan plan_{ViewTiming{}};
  ViewUpdate newest_;
  uint64_t edition_ = 0;    ///< of the model that is shown; 0: none yet, or a model without editions
  uint64_t successor_ = 0;  ///< the newer edition that is to take over; 0: none
  LinkEstimate link_;
  QualityState quality_ = first_quality();
  CameraForecast forecast_;
  bool warps_ = false;                        ///< the client has a depth to warp the newest frame by
  std::deque<ViewTime::duration> latencies_;  ///< of the last frames in motion: from `begun` to their acknowledgement
  uint64_t last_frame_ = 0;
  bool newest_begun_ = true;  ///< drawing of the newest picture has started
  service::JobId last_motion_job_ = 0;
  double last_draw_ms_ = 0;  ///< of the last frame drawn
  MotionCost last_cost_;     ///< of the last motion frame acknowledged
  /// The last frame at rest of the newest picture, if it is final.
  std::shared_ptr<const picture::Frame> finished_frame_;
  uint64_t displayed_cut_ = 0;                  ///< of the last frame at rest drawn of the newest picture; 0: none
  std::shared_ptr<video::VideoStream> stream_;  ///< null: no video
  bool is_video_ = false;                       ///< frames in motion become packets of it
  uint64_t last_packet_ = 0;                    ///< the frame that was the last packet sent; 0: none
  double file_density_ = 0.08;                  ///< of the last JPEG file, see jpeg_density()
  size_t depth_bytes_ = 0;                      ///< of the last frame in motion
  std::map<uint64_t, Job> frames_;
  std::optional<Outgoing> outgoing_;
};

}  // namespace surfcast::view
