#include "service/render_job.h"

#include <cstddef>
#include <utility>

#include "encode/encode_depth.h"
#include "encode/encode_picture.h"
#include "service/picture_channels.h"

namespace surfcast::service {
namespace {

/// The description of a picture and its cost; without its bytes.
EncodedPicture describe(const RenderJob& job, const picture::Frame& frame) {
  EncodedPicture picture;
  picture.format = job.picture.format;
  picture.width = frame.image.width;
  picture.height = frame.image.height;
  picture.camera = frame.camera;
  picture.normalization = job.picture.request.normalization;
  const bool chosen = picture::has_budget(job.picture.request);
  picture.spacing = chosen ? frame.spacing : job.picture.request.spacing;
  picture.render_scale = chosen ? frame.render_scale : job.picture.request.render_scale;
  picture.expected_error = frame.expected_error;
  picture.expected_ms = frame.expected_ms;
  picture.converged = frame.converged;
  picture.nothing_pending = frame.nothing_pending;
  picture.cut = frame.cut;
  picture.preview = frame.preview;
  picture.waited_ms = job.waited_ms;
  picture.draw_ms = job.draw_ms;
  picture.stats = frame.stats;
  return picture;
}

/// The bytes of a picture's file, with its channels.
Result<std::vector<std::byte>> encode_file(const RenderJob& job, const picture::Frame& frame) {
  const PictureJob& picture = job.picture;
  if (picture.channels.none()) {
    return surfcast::encode::encode_picture(frame.image, picture.format, picture.quality, picture.order);
  }
  const picture::Channels channels = make_channels(picture.channels, frame, job.front);
  return surfcast::encode::encode_picture(frame.image, picture.format, picture.quality, picture.order, &channels);
}

/// The bytes of a picture: a packet of its video where it has one, and a file where the codec fails.
Status fill_bytes(const RenderJob& job, const picture::Frame& frame, EncodedPicture& picture) {
  if (const std::optional<VideoJob>& video = job.picture.video) {
    if (Result<video::VideoPacket> packet = video->stream->encode(frame.image, video->order)) {
      picture.bytes = std::move(packet->bytes);
      picture.video = {packet->key, packet->refers_to};
      return {};
    }
  }
  Result<std::vector<std::byte>> bytes = encode_file(job, frame);
  if (!bytes) return fail(bytes);
  picture.bytes = std::move(*bytes);
  return {};
}

/// The picture is not delivered: if it was one of a video, the next one does not refer to it.
tl::unexpected<Error> withdrawn(const EncodedPicture& picture, const RenderJob& job) {
  if (picture.video) job.picture.video->stream->restart();
  return cancelled_error();
}

}  // namespace

size_t memory_of(const PictureJob& picture) {
  constexpr size_t kChannelBytes = 48;  // of a pixel, at most
  const size_t pixels = static_cast<size_t>(picture.request.width) * static_cast<size_t>(picture.request.height);
  const bool floats = picture::pixel_format_of(picture.format) == picture::PixelFormat::kLinearFloat;
  const size_t pixel = (floats ? 4 * sizeof(float) : 4) + (picture.channels.none() ? 0 : kChannelBytes);
  return 2 * pixels * pixel;  // a file is not larger than what it is made of
}

bool is_small(const PictureJob& picture) {
  constexpr size_t kPixels = size_t{512} * 512;  // 8 MiB at most, and some milliseconds to encode
  return picture.channels.none() &&
         static_cast<size_t>(picture.request.width) * static_cast<size_t>(picture.request.height) <= kPixels;
}

tl::unexpected<Error> cancelled_error() {
  return fail(ErrorKind::kCancelled, "the request was cancelled");
}

Result<EncodedPicture> encode_job(RenderJob& job, const Result<SharedFrame>& shared) {
  if (!shared) return fail(shared);
  job.encoding = true;
  if (job.cancelled) return cancelled_error();
  const Stopwatch watch;
  const picture::Frame& frame = **shared;
  EncodedPicture picture = describe(job, frame);
  if (job.picture.keep_frame) picture.frame = *shared;
  if (!frame.image.pixels.empty()) {
    if (Status filled = fill_bytes(job, frame, picture); !filled) return fail(filled);
    if (job.picture.depth_bytes > 0) picture.depth = encode::encode_depth(frame.depth, job.picture.depth_bytes);
  }
  if (job.cancelled) return withdrawn(picture, job);
  picture.encode_ms = watch.milliseconds();
  if (picture.expected_ms > 0) picture.expected_ms += picture.encode_ms;
  if (!job.front.empty()) picture.stats.stages.push_back({"surface", job.search_ms});
  picture.stats.stages.push_back({"encode", picture.encode_ms});
  return picture;
}

}  // namespace surfcast::service
