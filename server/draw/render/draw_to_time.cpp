#include <limits>
#include <utility>

#include "render/draw_to_goal.h"
#include "render/time_goal.h"

namespace surfcast::render {
namespace {

class TimeDrawing {
 public:
  TimeDrawing(const picture::PictureRequest& request, const DrawPicture& draw, std::optional<SpacingTime>& known)
      : request_(request), asked_ms_(request.time_ms), draw_(draw), known_(known) {
    request_.error = request_.time_ms = 0;
  }

  Result<picture::Frame> run() {
    Result<SpacingTime> found = choose_spacing(first_spacing_for(known_, asked_ms_));
    if (found && found->spacing > 0 && found->milliseconds < 2 * asked_ms_) known_ = *found;
    if (found && found->milliseconds > kLongTime * asked_ms_) found = draw_smaller(*found);
    if (!found) return fail(found);
    best_.expected_ms = found->milliseconds;
    if (best_.spacing == 0 && best_.render_scale == 1) best_.expected_error = std::numeric_limits<double>::infinity();
    best_.stats.stages.push_back({"search", spent_ms_ - found->milliseconds});
    return std::move(best_);
  }

 private:
  Result<picture::Frame> draw() {
    Result<picture::Frame> frame = draw_(request_);
    if (frame) spent_ms_ += drawing_ms(*frame);
    return frame;
  }

  Result<SpacingTime> choose_spacing(double first) {
    TimeSearch search(asked_ms_);
    for (std::optional next(first); next; next = search.next()) {
      request_.spacing = *next;
      Result<picture::Frame> frame = draw();
      if (!frame) return fail(frame);
      search.add({*next, drawing_ms(*frame)});
      if (search.best().spacing == *next) best_ = std::move(*frame);
    }
    return search.best();
  }

  /// Chooses a size, with about as many surfels for each pixel that is drawn, and then the spacing anew: the smaller
  /// picture may leave time for more surfels. This twice, because the first picture of a size or a spacing takes longer
  /// than the next one.
  Result<SpacingTime> draw_smaller(const SpacingTime& whole) {
    ScaleSearch search(asked_ms_, whole.milliseconds);
    while (const std::optional<double> next = search.next()) {
      request_.render_scale = *next;
      request_.spacing = whole.spacing / *next;
      const Result<picture::Frame> frame = draw();
      if (!frame) return fail(frame);
      search.add({*next, drawing_ms(*frame)});
    }
    request_.render_scale = search.best().scale;
    const Result<SpacingTime> found = choose_spacing(whole.spacing / request_.render_scale);
    return found ? choose_spacing(found->spacing) : found;
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
