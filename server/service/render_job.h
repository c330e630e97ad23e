#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "base/result.h"
#include "base/stopwatch.h"
#include "picture/picture.h"
#include "service/render_service.h"

namespace surfcast::service {

/// A picture on its way through the service.
struct RenderJob {
  JobId id = 0;
  SessionId session = 0;
  PictureJob picture;
  RenderService::PictureDone done;
  std::atomic<bool> cancelled = false;
  std::vector<pick::FrontPixel> front;  ///< for PictureJob::channels
  double search_ms = 0;                 ///< to find it
  Stopwatch since_submission;           ///< to the render thread
  double waited_ms = 0;                 ///< for the render thread
  double draw_ms = 0;
  std::atomic<bool> encoding = false;  ///< encoding has begun
};
using SharedFrame = std::shared_ptr<const picture::Frame>;

tl::unexpected<Error> cancelled_error();

/// The encoded picture of a job whose frame was drawn, or why there is none. Fails with kCancelled soon after the job
/// is cancelled.
Result<EncodedPicture> encode_job(RenderJob& job, const Result<SharedFrame>& shared);

}  // namespace surfcast::service
