#include <limits>
#include <utility>

#include "render/draw_to_goal.h"

namespace surfcast::render {

Result<picture::Frame> draw_to_time(const picture::PictureRequest& request, const DrawPicture& draw,
                                    std::optional<SpacingTime>& known) {
  TimeSearch search(request.time_ms);
  picture::PictureRequest trial = request;
  trial.error = trial.time_ms = 0;
  picture::Frame best;
  double spent_ms = 0;
  std::optional<double> next = first_spacing_for(known, request.time_ms);
  for (; next; next = search.next()) {
    trial.spacing = *next;
    Result<picture::Frame> frame = draw(trial);
    if (!frame) return frame;
    spent_ms += drawing_ms(*frame);
    search.add({*next, drawing_ms(*frame)});
    if (search.best().spacing == *next) best = std::move(*frame);
  }
  const SpacingTime found = search.best();
  if (found.spacing > 0 && found.milliseconds < 2 * request.time_ms) known = found;
  best.expected_ms = found.milliseconds;
  if (found.spacing == 0) best.expected_error = std::numeric_limits<double>::infinity();
  best.stats.stages.push_back({"search", spent_ms - found.milliseconds});
  return best;
}

}  // namespace surfcast::render
