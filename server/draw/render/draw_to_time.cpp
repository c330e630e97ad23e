#include <limits>
#include <utility>

#include "render/draw_to_goal.h"

namespace surfcast::render {
namespace {

class TimeDrawing {
 public:
  TimeDrawing(const picture::PictureRequest& request, const DrawPicture& draw, std::optional<SpacingTime>& known)
      : request_(request), asked_ms_(request.time_ms), draw_(draw), known_(known) {
    request_.error = request_.time_ms = 0;
  }

  Result<picture::Frame> run() {
    const Result<SpacingTime> spacing = choose_spacing();
    if (!spacing) return fail(spacing);
    if (spacing->milliseconds < 2 * asked_ms_ && spacing->spacing > 0) known_ = *spacing;
    const Result<double> drawn_ms = choose_scale(*spacing);
    if (!drawn_ms) return fail(drawn_ms);
    best_.expected_ms = *drawn_ms;
    if (best_.spacing == 0 && best_.render_scale == 1) best_.expected_error = std::numeric_limits<double>::infinity();
    best_.stats.stages.push_back({"search", spent_ms_ - *drawn_ms});
    return std::move(best_);
  }

 private:
  Result<picture::Frame> draw() {
    Result<picture::Frame> frame = draw_(request_);
    if (frame) spent_ms_ += drawing_ms(*frame);
    return frame;
  }

  Result<SpacingTime> choose_spacing() {
    TimeSearch search(asked_ms_);
    for (std::optional next(first_spacing_for(known_, asked_ms_)); next; next = search.next()) {
      request_.spacing = *next;
      Result<picture::Frame> frame = draw();
      if (!frame) return fail(frame);
      search.add({*next, drawing_ms(*frame)});
      if (search.best().spacing == *next) best_ = std::move(*frame);
    }
    return search.best();
  }

  /// Draws smaller pictures if the one at its own size takes too long. Returns the time of the best, milliseconds.
  Result<double> choose_scale(const SpacingTime& whole) {
    ScaleSearch search(asked_ms_, whole.milliseconds);
    while (const std::optional<double> next = search.next()) {
      request_.render_scale = *next;
      request_.spacing = whole.spacing / *next;  // about as many surfels for a pixel that is drawn
      Result<picture::Frame> frame = draw();
      if (!frame) return fail(frame);
      search.add({*next, drawing_ms(*frame)});
      if (search.best().scale == *next) best_ = std::move(*frame);
    }
    return search.best().milliseconds;
  }

  picture::PictureRequest request_;
  double asked_ms_;
  const DrawPicture& draw_;
  std::optional<SpacingTime>& known_;
  picture::Frame best_;
  double spent_ms_ = 0;
};

}  // namespace

Result<picture::Frame> draw_to_time(const picture::PictureRequest& request, const DrawPicture& draw,
                                    std::optional<SpacingTime>& known) {
  return TimeDrawing(request, draw, known).run();
}

}  // namespace surfcast::render
