#pragma once

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "base/result.h"
#include "base/stopwatch.h"
#include "picture/picture.h"
#include "service/picture_memory.h"
#include "service/render_service.h"

namespace surfcast::service {

/// A picture on its way through the service.
struct RenderJob {
  RenderJob(const Client& of, PictureJob wanted, RenderService::PictureDone then)
      : client(of), picture(std::move(wanted)), done(std::move(then)) {}

  JobId id = 0;
  Client client;
  PictureJob picture;
  RenderService::PictureDone done;
  std::atomic<bool> cancelled = false;
  std::shared_ptr<PictureMemory::Share> memory;  ///< from the beginning of drawing on
  std::vector<pick::FrontPixel> front;           ///< for PictureJob::channels
  double search_ms = 0;                          ///< to find it
  Stopwatch since_submission;                    ///< to the render thread
  double waited_ms = 0;                          ///< for the render thread
  double draw_ms = 0;
  bool small = false;                  ///< is_small, of a picture at rest, when drawing began
  std::atomic<bool> encoding = false;  ///< encoding has begun
};
using SharedFrame = std::shared_ptr<const picture::Frame>;

tl::unexpected<Error> cancelled_error();

/// Memory that a picture takes at most: pixels, channels and its file.
size_t memory_of(const PictureJob& picture);
/// Pictures that take so little that they need not wait for room beside large ones.
bool is_small(const PictureJob& picture);

/// The encoded picture of a job whose frame was drawn, or why there is none. Fails with kCancelled soon after the job
/// is cancelled.
Result<EncodedPicture> encode_job(RenderJob& job, const Result<SharedFrame>& shared);

}  // namespace surfcast::service
