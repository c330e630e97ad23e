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
  kMotion,   ///< for motion: small, coarse, per-surfel weights, JPEG
  kRefined,  ///< at rest: all that was asked for, of the blocks that are there, JPEG
  kFinal,    ///< at rest: the very answer to the request for that picture
};

struct ViewTiming {
  std::chrono::milliseconds grace{250};         ///< after the last update of a motion that was not said to have ended
  std::chrono::milliseconds refined{150};       ///< from the beginning of rest to kRefined
  std::chrono::milliseconds final{500};         ///< from the beginning of rest to kFinal
  std::chrono::milliseconds block_wait{2500};   ///< for blocks, before it is known how long drawing takes
  std::chrono::milliseconds poll_interval{50};  ///< between two looks at whether missing blocks have come
  std::chrono::milliseconds busy_retry{500};    ///< after a frame that the server was too busy to draw
  std::chrono::milliseconds missing_block_timeout{5000};  ///< without any block: those that are missing will not come
};

/// Frames, or pieces of one, that may be on their way without having been acknowledged.
inline constexpr size_t kMaxUnacknowledged = 2;

/// What came of drawing a frame.
enum class FrameResult {
  kNothing,     ///< nothing to show yet: no block was there, or none that the frame before did not have
  kImprovable,  ///< blocks are missing that are still to come
  kComplete,    ///< nothing better will come of drawing it again in this way
};

/// What a view does next: draw, or nothing before that time or an event.
struct ViewStep {
  std::optional<FrameKind> draw;
  std::optional<ViewTime> wake_at;
};

/// Decides when a view draws what, from the times of its updates, drawings and acknowledgements. It knows pictures only
/// by their number: what is to be seen now is the newest one.
class ViewPlan {
 public:
  explicit ViewPlan(const ViewTiming& timing) : timing_(timing) {}

  /// An update has come; `changed`: it shows another picture than the one before.
  void update(bool changed, bool moving, ViewTime now);
  [[nodiscard]] ViewStep next(ViewTime now) const;

  /// Drawing a frame of the newest picture begins.
  void begin(uint64_t frame, FrameKind kind);
  /// A frame whose drawing had not begun in truth will show the newest picture instead.
  void retarget(uint64_t frame);
  /// The youngest frame for motion that is being drawn or waits for it, if it shows an older picture than the newest.
  [[nodiscard]] std::optional<uint64_t> retargetable() const;
  /// Frames at rest that are being drawn for a picture which is not the newest any more.
  [[nodiscard]] std::vector<uint64_t> outdated() const;
  /// A frame will not come.
  void drop(uint64_t frame);
  /// A frame will not come because the server is busy: the view gives it some time.
  void refuse(uint64_t frame, ViewTime now);
  void finish(uint64_t frame, FrameResult result, ViewTime now);
  /// A frame at rest of the newest picture was drawn in that time, and so many blocks would make it better.
  void record_draw(double draw_ms, uint32_t missing, ViewTime now);
  /// So many blocks would make the newest picture better.
  void record_missing(uint32_t missing, ViewTime now);
  /// How many blocks may be missing for a frame at rest to be worth drawing although more are still to come: a frame of
  /// a large model takes seconds, and one for each few blocks would only delay the one that shows them all.
  [[nodiscard]] uint32_t max_missing_blocks(ViewTime now) const;
  [[nodiscard]] bool is_pending(uint64_t frame) const;

  /// A message has been sent; `last` of its frame.
  void send(FrameKind kind, bool last);
  void acknowledge(FrameKind kind);
  /// The rest of a frame will not be sent.
  void stop_sending() { sending_ = false; }
  [[nodiscard]] bool may_send() const { return motion_unacknowledged_ + still_unacknowledged_ < kMaxUnacknowledged; }

 private:
  struct Job {
    uint64_t frame = 0;
    FrameKind kind = FrameKind::kMotion;
    uint64_t picture = 0;
  };
  /// The best that has been drawn of the newest picture.
  enum class Progress { kNone, kMotion, kRefined, kRefinedComplete, kFinal };

  [[nodiscard]] const Job* find(uint64_t frame) const;
  [[nodiscard]] bool room_for_motion() const;
  [[nodiscard]] uint32_t max_missing_before_first_draw(ViewTime now) const;
  [[nodiscard]] std::optional<ViewTime> due(ViewTime rest) const;
  [[nodiscard]] FrameKind wanted() const;

  ViewTiming timing_;
  uint64_t picture_ = 0;  ///< the newest
  Progress progress_ = Progress::kNone;
  ViewTime changed_at_;
  ViewTime rest_at_;
  ViewTime next_poll_at_;
  ViewTime improved_at_;
  ViewTime not_before_;  ///< nothing is drawn: the server is busy
  /// Blocks at a look at the newest picture.
  struct MissingSample {
    uint32_t missing = 0;
    ViewTime at;
  };
  std::optional<MissingSample> first_sample_;
  MissingSample last_sample_;
  bool drawn_ = false;  ///< a frame at rest of the newest picture
  ViewTime drawn_at_;   ///< the last one, in the time below
  double draw_ms_ = 0;
  uint32_t drawn_missing_ = 0;  ///< blocks, by the last frame at rest
  std::vector<Job> jobs_;       ///< oldest first
  size_t motion_unacknowledged_ = 0;
  size_t still_unacknowledged_ = 0;
  bool sending_ = false;  ///< pieces of a frame remain to be sent
};

}  // namespace surfcast::view
