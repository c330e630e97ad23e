#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace surfcast::view {

using ViewTime = std::chrono::steady_clock::time_point;

/// How a frame of a view is drawn.
enum class FrameKind {
  kMotion,   ///< in motion: small, coarse, per-surfel weights, JPEG
  kRefined,  ///< at rest: all parameters as requested, resident blocks only, JPEG
  kFinal,    ///< at rest: exactly the picture that was requested
  /// At rest: as kRefined, from the newest edition of the model, which replaces the one shown so far. Not drawn before
  /// all its blocks are there, so that it is no worse than the picture on the screen.
  kTakeover,
};

struct ViewTiming {
  std::chrono::milliseconds grace{250};         ///< from the last update to rest, if no end of the motion is reported
  std::chrono::milliseconds refined{150};       ///< from the start of rest to kRefined
  std::chrono::milliseconds final{500};         ///< from the start of rest to kFinal
  std::chrono::milliseconds block_wait{2500};   ///< longest wait for blocks while the drawing time is unknown
  std::chrono::milliseconds poll_interval{50};  ///< between two checks whether missing blocks have arrived
  std::chrono::milliseconds busy_retry{500};    ///< after a frame that a busy server refused to draw
  std::chrono::milliseconds missing_block_timeout{5000};  ///< without any new block: the missing ones are given up
  std::chrono::milliseconds takeover_try{250};  ///< in motion, between two frames tried from the newer edition
};

/// The most frames, or pieces of one, that may be unacknowledged. More would only show older pictures, unless the
/// client warps them and the way to it is long.
inline constexpr size_t kMaxUnacknowledged = 2;
inline constexpr size_t kLargestWindow = 8;

/// The outcome of drawing a frame.
enum class FrameResult {
  kNothing,     ///< nothing new to display: no block is resident, or none that the previous frame lacked
  kImprovable,  ///< missing blocks are still loading
  kComplete,    ///< redrawing in this way would not improve the frame
};

/// The next action of a view: draw now, or wait until a time or an event.
struct ViewStep {
  std::optional<FrameKind> draw;
  std::optional<ViewTime> wake_at;
};

/// Schedules the frames of a view, from the times of its updates, drawings and acknowledgements. It identifies pictures
/// by their number; the newest picture is the one to display.
class ViewPlan {
 public:
  explicit ViewPlan(const ViewTiming& timing) : timing_(timing) {}

  /// An update has arrived. `changed`: its picture differs from the previous one.
  void update(bool changed, bool moving, ViewTime now);
  [[nodiscard]] ViewStep next(ViewTime now) const;

  /// Drawing of a frame of the newest picture starts.
  void begin(uint64_t frame, FrameKind kind);
  /// A frame that is still queued will show the newest picture instead of its own.
  void retarget(uint64_t frame);
  /// The youngest motion frame that is queued or being drawn, if it shows an older picture than the newest.
  [[nodiscard]] std::optional<uint64_t> retargetable() const;
  /// Frames at rest in progress whose picture is not the newest any more.
  [[nodiscard]] std::vector<uint64_t> outdated() const;
  /// The frame will not be delivered.
  void drop(uint64_t frame);
  /// The server was too busy to draw the frame: the view retries after ViewTiming::busy_retry.
  void refuse(uint64_t frame, ViewTime now);
  void finish(uint64_t frame, FrameResult result, ViewTime now);
  /// The model has a newer edition, which takes over once the newest picture is drawn from the present one at rest, or
  /// in motion at the first try for which all blocks are there.
  void expect_takeover() { successor_ = true; }
  void taken_over() { successor_ = false; }
  /// Whether the motion frame that is to be drawn now is tried from the newer edition.
  [[nodiscard]] bool may_try_takeover(ViewTime now) const { return successor_ && now >= next_try_at_; }
  void try_takeover(ViewTime now) { next_try_at_ = now + timing_.takeover_try; }
  /// A frame at rest of the newest picture was drawn in `draw_ms`, from `blocks` blocks, with `missing` missing.
  void record_draw(double draw_ms, uint32_t blocks, uint32_t missing, ViewTime now);
  /// The newest picture, of so many blocks, now has `missing` blocks missing.
  void record_missing(uint32_t missing, uint32_t blocks, ViewTime now);
  /// The most missing blocks with which a frame at rest is worth drawing while they are still loading. A frame of a
  /// large model takes seconds; one frame for every few blocks would only delay the complete one.
  [[nodiscard]] uint32_t max_missing_blocks(ViewTime now) const;
  [[nodiscard]] bool is_pending(uint64_t frame) const;

  /// A message has been sent. `last`: it is the last one of its frame.
  void send(FrameKind kind, bool last);
  void acknowledge(FrameKind kind);
  /// The remaining pieces of a frame will not be sent.
  void stop_sending() { sending_ = false; }
  [[nodiscard]] bool may_send() const { return motion_unacknowledged_ + still_unacknowledged_ < window_; }
  /// So many messages may be unacknowledged from now on.
  void set_window(size_t messages) { window_ = messages; }

 private:
  struct Job {
    uint64_t frame = 0;
    FrameKind kind = FrameKind::kMotion;
    uint64_t picture = 0;
  };
  /// The best frame drawn so far of the newest picture.
  enum class Progress { kNone, kMotion, kRefined, kRefinedComplete, kFinal };

  [[nodiscard]] const Job* find(uint64_t frame) const;
  [[nodiscard]] bool room_for_motion() const;
  [[nodiscard]] uint32_t max_missing_before_first_draw(ViewTime now) const;
  [[nodiscard]] double whole_draw_ms() const;
  [[nodiscard]] std::optional<ViewTime> due(ViewTime rest) const;
  [[nodiscard]] FrameKind wanted() const;

  ViewTiming timing_;
  size_t window_ = kMaxUnacknowledged;
  uint64_t picture_ = 0;  ///< the newest
  Progress progress_ = Progress::kNone;
  ViewTime changed_at_;
  ViewTime rest_at_;
  ViewTime next_poll_at_;
  ViewTime improved_at_;
  ViewTime next_try_at_;  ///< of a motion frame from the newer edition
  ViewTime not_before_;   ///< no frame is drawn before this time because the server is busy
  /// The number of missing blocks of the newest picture at one time.
  struct MissingSample {
    uint32_t missing = 0;
    uint32_t blocks = 0;  ///< of the picture
    ViewTime at;
  };
  std::optional<MissingSample> first_sample_;
  MissingSample last_sample_;
  bool drawn_ = false;  ///< a frame at rest of the newest picture has been drawn
  ViewTime drawn_at_;   ///< when the last such frame was drawn; its duration and missing blocks follow
  double draw_ms_ = 0;
  uint32_t drawn_blocks_ = 0;
  uint32_t drawn_missing_ = 0;  ///< by the last frame at rest
  std::vector<Job> jobs_;       ///< oldest first
  size_t motion_unacknowledged_ = 0;
  size_t still_unacknowledged_ = 0;
  bool successor_ = false;  ///< a newer edition of the model is to take over
  bool sending_ = false;    ///< pieces of a frame remain to be sent
};

}  // namespace surfcast::view
