#include "render/batched_dispatch.h"

#include <algorithm>

#include <epoxy/gl.h>

#include "base/stopwatch.h"
#include "shared/frame_layout.h"

namespace surfcast::render {

Groups all_pixels(int width, int height) {
  const auto groups = [](int pixels, int side) { return static_cast<size_t>((pixels + side - 1) / side); };
  return {groups(height, SURFCAST_BLOCK_HEIGHT), groups(width, SURFCAST_BLOCK_WIDTH)};
}

Status dispatch_in_batches(const Groups& groups, BatchSizer& sizer, const Preemption& preemption,
                           const std::function<void()>& bind) {
  bind();
  sizer.begin_pass();
  const size_t width = groups.width.value_or(1);
  for (size_t first = 0; first < groups.count;) {
    const size_t count = std::clamp<size_t>(sizer.groups() / width, 1, groups.count - first);
    const auto x = static_cast<GLuint>(groups.width ? width : count);
    const auto y = static_cast<GLuint>(groups.width ? count : 1);
    const Stopwatch watch;
    glUniform1ui(SURFCAST_UNIFORM_FIRST_GROUP, static_cast<GLuint>(groups.first + first));
    glDispatchCompute(x, y, 1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    glFinish();
    sizer.record(count * width, watch.milliseconds());
    first += count;
    if (preemption.yield_to_urgent()) bind();  // this work may cancel the picture
    if (preemption.cancelled()) return fail(ErrorKind::kCancelled, "cancelled");
  }
  return {};
}

}  // namespace surfcast::render
