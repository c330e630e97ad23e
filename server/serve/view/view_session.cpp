#include "view/view_session.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>
#include <vector>

#include "base/log.h"
#include "view/video_budget.h"

namespace surfcast::view {
namespace {

/// Frames before the final one have a spacing of their own: only the final one is drawn to an error or a time.
void set_interim_spacing(picture::PictureRequest& request) {
  request.spacing = 1;
  request.error = request.time_ms = 0;
}

constexpr int kRefinedQuality = 90;  // of the JPEG at rest
// The transfer time of a piece. Short enough that a motion which starts behind the piece is not noticeably delayed.
constexpr double kPieceMs = 60;
constexpr size_t kFirstPiece = size_t{64} << 10;
constexpr size_t kMinPiece = size_t{24} << 10;
constexpr size_t kMinWarpedPiece = size_t{8} << 10;  // more of them may be on the way, and each may be shown
constexpr size_t kMaxPiece = size_t{16} << 20;       // a message stays far below kMaxAnswerBytes
// Sides of depth maps, texels, and what they take at most. Finer ones tear where points are rough.
constexpr int kTexelsAtRest = 160;
constexpr int kTexelsInMotion = 80;
constexpr size_t kDepthBytesAtRest = 6000;
constexpr size_t kDepthBytesInMotion = 3000;
constexpr size_t kLatencies = 5;
constexpr double kLateMs = 100;  // beyond its round trip, from which on a message is late
// Clients that warp need no frame for each of the display's: fewer and sharper ones are nearer to the truth. Frames of
// the best quality are drawn as often as the device can.
constexpr double kWarpedRate = 0.4;
// Of a view: larger ones get files. That is not a setting because nothing is refused.
constexpr double kMaxVideoPixels = 3840.0 * 2160;

int scaled(int pixels, double scale) {
  return std::max(1, static_cast<int>(std::lround(pixels * scale)));
}

/// Zero while there is none.
ViewTime::duration median_of(const std::deque<ViewTime::duration>& durations) {
  if (durations.empty()) return {};
  std::vector<ViewTime::duration> sorted(durations.begin(), durations.end());
  std::ranges::sort(sorted);
  return sorted[sorted.size() / 2];
}

/// The stream of a view; null where the server cannot encode one, which is logged once.
std::shared_ptr<video::VideoStream> open_stream() {
  Result<std::shared_ptr<video::VideoStream>> stream = video::VideoStream::open();
  if (stream) return std::move(*stream);
  static const bool logged = [&stream] {
    spdlog::warn("frames in motion are JPEG files alone: {}", stream.error().message);
    return true;
  }();
  static_cast<void>(logged);
  return nullptr;
}

/// A picture is improvable while missing blocks are loading. A picture with holes that will be filled soon is not
/// shown.
FrameResult result_of(FrameKind kind, const service::EncodedPicture& picture) {
  if (kind == FrameKind::kTakeover) return picture.bytes.empty() ? FrameResult::kNothing : FrameResult::kComplete;
  if (kind == FrameKind::kFinal || picture.nothing_pending) return FrameResult::kComplete;
  return picture.bytes.empty() || picture.stats.holes > 0 ? FrameResult::kNothing : FrameResult::kImprovable;
}

}  // namespace

ViewSession::ViewSession(service::RenderService& service, const service::Client& client,
                         const access::AuthorizedModel& model, uint64_t viewer, const ViewOptions& options,
                         ViewCounts& counts, ViewPort port)
    : service_(service),
      client_(client),
      viewer_(viewer),
      options_(options),
      counts_(counts),
      port_(std::move(port)),
      newest_{0, service::PictureJob{model}} {
  ++counts_.open;
  if (options_.video) stream_ = open_stream();
}

ViewSession::~ViewSession() {
  --counts_.open;
}

/// Whether the final frame can be made of the one before it, which has the same pixels.
bool ViewSession::may_be_kept(const service::PictureJob& job) const {
  constexpr size_t kPixelBytes = 4;  // of the JPEG at rest
  const size_t pixels = static_cast<size_t>(job.request.width) * static_cast<size_t>(job.request.height);
  return pixels * kPixelBytes <= options_.kept_bytes && !picture::has_budget(job.request) &&
         picture::pixel_format_of(job.format) == picture::pixel_format_of(picture::FileFormat::kJpeg);
}

service::PictureJob ViewSession::picture_job(FrameKind kind, uint64_t frame, ViewTime now) const {
  service::PictureJob job = newest_.picture;
  job.request.edition = frames_.at(frame).edition;
  if (options_.depth) {
    job.request.depth_texels = kind == FrameKind::kMotion ? kTexelsInMotion : kTexelsAtRest;
    job.depth_bytes = kind == FrameKind::kMotion ? kDepthBytesInMotion : kDepthBytesAtRest;
  }
  if (kind == FrameKind::kFinal) return job;
  picture::PictureRequest& request = job.request;
  request.loading = picture::Loading::kNow;
  if (picture::has_budget(request)) set_interim_spacing(request);
  job.format = picture::FileFormat::kJpeg;
  job.quality = kRefinedQuality;
  // At rest, a client that shows what has come of a file sees first what changes most.
  const bool shown_early = options_.depth && kind != FrameKind::kMotion;
  job.order = shown_early ? picture::JpegOrder::kScans : picture::JpegOrder::kRows;
  if (kind == FrameKind::kTakeover) {
    request.max_missing_blocks = 0;
    job.keep_frame = may_be_kept(newest_.picture);
    return job;
  }
  if (kind == FrameKind::kRefined) {
    request.displayed_cut = displayed_cut_;
    request.max_missing_blocks = plan_.max_missing_blocks(std::chrono::steady_clock::now());
    job.keep_frame = may_be_kept(newest_.picture);
    return job;
  }
  make_motion_job(frame, now, job);
  return job;
}

void ViewSession::make_motion_job(uint64_t frame, ViewTime now, service::PictureJob& job) const {
  picture::PictureRequest& request = job.request;
  if (warps_ && request.camera) request.camera = forecast_.at(now + median_of(latencies_), now);
  const video::FrameOrder order{frame, video_frame_bytes(now), request.width, request.height};
  if (is_video_) job.video = {stream_, order};
  const MotionQuality quality = motion_quality(order.bytes);
  request.rest_spacing = request.spacing * quality.scale;
  request.render_scale = 1;
  request.width = scaled(request.width, quality.scale);
  request.height = scaled(request.height, quality.scale);
  request.spacing = std::max(request.spacing * quality.scale, quality.spacing);
  request.normalization = picture::Normalization::kSurfel;
  request.blends_behind = true;
  request.viewer = viewer_;
  if (request.edition != edition_) request.max_missing_blocks = 0;
  job.priority = service::Priority::kMotion;
  job.quality = quality.jpeg_quality;
  job.supersedes = frames_.at(frame).supersedes;
}

MotionQuality ViewSession::motion_quality(size_t video_bytes) const {
  if (!is_video_) return quality_of(quality_);
  MotionQuality quality = drawing_of(quality_);
  quality.scale = std::min(quality.scale, video_scale(video_bytes, view_pixels()));
  return quality;
}

double ViewSession::view_pixels() const {
  return static_cast<double>(newest_.picture.request.width) * newest_.picture.request.height;
}

/// Frames a second for which size and spacing are chosen.
double ViewSession::motion_fps() const {
  return warps_ ? kWarpedRate * options_.target_fps : options_.target_fps;
}

size_t ViewSession::video_frame_bytes(ViewTime now) const {
  const double milliseconds = video_frame_ms(motion_fps());
  return video_bytes(link_.bytes_now_in(milliseconds, now).value_or(kFirstPiece), depth_bytes_);
}

/// Whether the next frames in motion are packets of the video. While nothing is known of the link they are files.
void ViewSession::choose_codec(ViewTime now) {
  const std::optional<size_t> fits = link_.bytes_now_in(video_frame_ms(motion_fps()), now);
  if (!stream_ || !fits) return;
  const bool small = view_pixels() <= kMaxVideoPixels;
  const double scale = drawing_of(quality_).scale;
  const double file = good_file_bytes(file_density_, view_pixels() * scale * scale);
  is_video_ = small && wants_video(file + static_cast<double>(depth_bytes_), static_cast<double>(*fits), is_video_);
}

void ViewSession::update(ViewUpdate update, ViewTime now) {
  const bool changed = update.changed;
  if (changed && !newest_begun_) ++counts_.replaced;
  newest_ = std::move(update);
  plan_.update(changed, newest_.moving, now);
  if (!changed) return;
  if (options_.depth && newest_.picture.request.camera) forecast_.record(*newest_.picture.request.camera, now);
  newest_begun_ = false;
  displayed_cut_ = 0;
  finished_frame_.reset();
  for (const uint64_t frame : plan_.outdated()) drop(frame);
  if (outgoing_ && outgoing_->kind != FrameKind::kMotion) give_up_sending();
  retarget(now);
}

/// Replaces the request of a frame that still waits for the render thread by the newest picture.
void ViewSession::retarget(ViewTime now) {
  const std::optional<uint64_t> frame = plan_.retargetable();
  if (!frame) return;
  Job& job = frames_.at(*frame);
  choose_codec(now);
  if (!service_.replace(job.job, picture_job(FrameKind::kMotion, *frame, now))) return;
  plan_.retarget(*frame);
  job.video = is_video_;
  job.begun = now;
  job.update = newest_.update;
  job.quality = quality_;
  newest_begun_ = true;
  ++counts_.replaced;
}

/// Cancels a frame that is being drawn or encoded.
void ViewSession::drop(uint64_t frame) {
  const auto found = frames_.find(frame);
  service_.cancel(found->second.job);
  plan_.drop(frame);
  frames_.erase(found);
  ++counts_.dropped;
}

/// The messages that may be unacknowledged. Frames that are warped may be some round trips old, so that a long way
/// takes no frames from the client: as many are sent as fit on the way, while all that was sent arrives in time.
size_t ViewSession::window(ViewTime now) const {
  // Packets of one size do not tell the rate from the round trip.
  const double round_trip = is_video_ ? link_.least_elapsed_ms() : link_.round_trip_ms();
  const double milliseconds = round_trip + kLateMs;
  const std::optional<size_t> fits = is_video_ ? link_.bytes_now_in(milliseconds, now) : link_.bytes_in(milliseconds);
  if (!warps_ || round_trip == 0 || !fits) return kMaxUnacknowledged;
  if (link_.bytes_on_the_way() >= *fits || link_.waits_ms(now) > 2 * round_trip + kLateMs) return kMaxUnacknowledged;
  const auto frames = static_cast<size_t>(std::ceil(round_trip * options_.target_fps / 1000));
  return std::min(kMaxUnacknowledged + frames, kLargestWindow);
}

std::optional<ViewTime> ViewSession::advance(ViewTime now) {
  if (closed_) return std::nullopt;
  plan_.set_window(window(now));
  send_pieces(now);
  const ViewStep step = plan_.next(now);
  if (!step.draw) return step.wake_at;
  if (port_.may_draw()) draw(*step.draw, now);
  return std::nullopt;
}

void ViewSession::model_changed() {
  const uint64_t newest = service_.edition(newest_.picture.model);
  if (closed_ || edition_ == 0 || newest <= std::max(edition_, successor_)) return;
  successor_ = newest;
  plan_.expect_takeover();
}

/// The first picture decides which edition is shown until another one takes over.
void ViewSession::settle_edition() {
  if (edition_ == 0) edition_ = service_.edition(newest_.picture.model);
}

/// The edition to draw a frame from.
uint64_t ViewSession::next_edition(FrameKind kind, ViewTime now) {
  if (kind == FrameKind::kTakeover) return successor_;
  if (kind != FrameKind::kMotion || !plan_.may_try_takeover(now)) return edition_;
  plan_.try_takeover(now);
  return successor_;
}

void ViewSession::draw(FrameKind kind, ViewTime now) {
  settle_edition();
  const uint64_t frame = ++last_frame_;
  Job& job = frames_[frame];
  job.kind = kind;
  job.update = newest_.update;
  job.edition = next_edition(kind, now);
  job.quality = quality_;
  job.begun = now;
  // A frame that is tried may come to nothing, and is in place of no other.
  job.supersedes = kind == FrameKind::kMotion && job.edition == edition_ ? last_motion_job_ : 0;
  plan_.begin(frame, kind);
  newest_begun_ = true;
  if (kind == FrameKind::kMotion) choose_codec(now);
  job.video = kind == FrameKind::kMotion && is_video_;
  auto done = [weak = weak_from_this(), post = port_.post, frame](Result<service::EncodedPicture> picture) {
    post([weak, frame, picture = std::move(picture)]() mutable {
      if (const auto self = weak.lock()) self->finish(frame, std::move(picture));
    });
  };
  if (kind == FrameKind::kFinal && finished_frame_) {
    job.job =
        service_.encode(std::exchange(finished_frame_, {}), picture_job(kind, frame, now), std::move(done), client_);
  } else {
    job.job = service_.draw(client_, picture_job(kind, frame, now), std::move(done));
  }
  if (kind == FrameKind::kMotion && job.edition == edition_) last_motion_job_ = job.job;
}

void ViewSession::finish(uint64_t frame, Result<service::EncodedPicture> picture) {
  if (closed_ || !plan_.is_pending(frame)) return withdraw(picture);
  Job& job = frames_.at(frame);
  if (!picture) return frame_failed(frame, picture.error());
  if (!follows(*picture)) {
    withdraw(picture);
    return frame_failed(frame, {ErrorKind::kCancelled, "the frame that it refers to was not sent"});
  }
  if (job.kind == FrameKind::kMotion && job.edition > edition_ && picture->bytes.empty()) {
    plan_.drop(frame);  // drawn from the present edition at once
    frames_.erase(frame);
    return;
  }
  const ViewTime now = std::chrono::steady_clock::now();
  const FrameResult result = result_of(job.kind, *picture);
  plan_.finish(frame, result, now);
  if (job.kind == FrameKind::kRefined) record_progress(*picture, now);
  if (job.edition > edition_ && result != FrameResult::kNothing) take_over(frame, *picture);
  if (picture->bytes.empty() || (result == FrameResult::kNothing)) {
    frames_.erase(frame);
    return withdraw(picture);
  }
  record_size(*picture, job);
  if (job.video && !picture->video) give_up_video();
  job.video = picture->video.has_value();
  // Waiting for the previous frame is no cost of this one.
  job.cost.draw = picture->draw_ms + std::max(picture->waited_ms - last_draw_ms_, 0.0);
  job.cost.encode = picture->encode_ms;
  last_draw_ms_ = picture->draw_ms;
  warps_ = picture->depth.has_value();
  show(frame, job.kind, std::move(*picture));
  send_pieces(now);
}

/// The codec has failed, or there is no room for its encoder.
void ViewSession::give_up_video() {
  stream_.reset();
  is_video_ = false;
}

/// Whether a decoder that has got all that was sent can decode this picture.
bool ViewSession::follows(const service::EncodedPicture& picture) const {
  return !picture.video || picture.video->key || picture.video->refers_to == last_packet_;
}

/// This picture is not sent: the video goes on with a key frame.
void ViewSession::withdraw(const Result<service::EncodedPicture>& picture) {
  if (picture && picture->video && stream_) stream_->restart();
}

/// The sizes of files tell whether later ones would fit the link.
void ViewSession::record_size(const service::EncodedPicture& picture, const Job& job) {
  if (job.kind == FrameKind::kMotion) depth_bytes_ = picture.depth ? picture.depth->codes.size() : 0;
  if (picture.video || picture.format != picture::FileFormat::kJpeg || job.kind == FrameKind::kFinal) return;
  const int quality = job.kind == FrameKind::kMotion ? quality_of(job.quality).jpeg_quality : kRefinedQuality;
  file_density_ = jpeg_density(picture.bytes.size(), static_cast<double>(picture.width) * picture.height, quality);
}

/// A frame failed. If the server was busy the view retries later; any other error but a cancellation ends the view.
void ViewSession::frame_failed(uint64_t frame, const Error& error) {
  frames_.erase(frame);
  ++counts_.dropped;
  if (error.kind == ErrorKind::kUnavailable) return plan_.refuse(frame, std::chrono::steady_clock::now());
  plan_.drop(frame);
  if (error.kind == ErrorKind::kCancelled) return;
  close();
  port_.fail(error);
}

/// From now on the edition of this frame is shown.
void ViewSession::take_over(uint64_t frame, service::EncodedPicture& picture) {
  const Job& job = frames_.at(frame);
  edition_ = job.edition;
  displayed_cut_ = job.kind == FrameKind::kTakeover ? picture.cut : 0;
  finished_frame_.reset();
  if (picture.converged) finished_frame_ = std::move(picture.frame);
  picture.frame.reset();
  drop_former_editions();
  if (successor_ == edition_) {
    successor_ = 0;
    plan_.taken_over();
  } else {
    plan_.expect_takeover();  // there is a still newer one
  }
}

/// Cancels the frames in progress of editions before the one that is shown now.
void ViewSession::drop_former_editions() {
  std::vector<uint64_t> former;
  for (const auto& [frame, job] : frames_) {
    if (plan_.is_pending(frame) && job.edition < edition_) former.push_back(frame);
  }
  for (const uint64_t frame : former) drop(frame);
}

/// Records how complete the newest picture is.
void ViewSession::record_progress(service::EncodedPicture& picture, ViewTime now) {
  const uint32_t missing = picture.stats.blocks_missing;
  plan_.record_missing(missing, picture.stats.blocks_selected, now);
  if (!picture.bytes.empty()) {
    displayed_cut_ = picture.cut;
    plan_.record_draw(picture.draw_ms, picture.stats.blocks_drawn, missing, now);
    if (picture.converged && picture.nothing_pending) finished_frame_ = std::move(picture.frame);
  }
  picture.frame.reset();
}

void ViewSession::show(uint64_t frame, FrameKind kind, service::EncodedPicture picture) {
  if (outgoing_) give_up_sending();
  picture.stats.stages.push_back({"transfer", last_cost_.transfer});
  picture.stats.stages.push_back({"paint", last_cost_.client});
  ViewMessage message;
  message.frame = frame;
  message.update = frames_.at(frame).update;
  message.width = newest_.picture.request.width;
  message.height = newest_.picture.request.height;
  message.moving = kind == FrameKind::kMotion;
  // The renderer's `converged` refers to the request of this frame, not to the request of the view.
  picture.converged = picture.converged && kind == FrameKind::kFinal;
  std::vector<std::byte> bytes = std::move(picture.bytes);
  std::shared_ptr<const void> memory = std::move(picture.memory);
  message.picture = std::move(picture);
  outgoing_ = Outgoing{frame, kind, std::move(message), std::move(bytes), 0, std::move(memory)};
}

void ViewSession::give_up_sending() {
  const uint64_t frame = outgoing_->frame;
  outgoing_.reset();
  plan_.stop_sending();
  frames_.at(frame).sent = true;
  erase_if_done(frame);
  ++counts_.dropped;
}

void ViewSession::erase_if_done(uint64_t frame) {
  const auto found = frames_.find(frame);
  if (found->second.sent && found->second.unacknowledged == 0) frames_.erase(found);
}

/// Sends as much as may be sent: motion frames as a whole, others in pieces small enough not to delay a motion. A
/// packet of a video does not wait, because it could not be dropped for a newer one. When it was drawn, there was room
/// for it.
void ViewSession::send_pieces(ViewTime now) {
  while (outgoing_ && (plan_.may_send() || frames_.at(outgoing_->frame).video)) {
    const size_t rest = outgoing_->bytes.size() - outgoing_->sent;
    const size_t least = warps_ ? kMinWarpedPiece : kMinPiece;
    const size_t piece = std::clamp(link_.bytes_in(kPieceMs).value_or(kFirstPiece), least, kMaxPiece);
    const bool whole = outgoing_->kind == FrameKind::kMotion || rest < piece + piece / 2;
    send_piece(whole ? rest : piece, now);
  }
}

void ViewSession::send_piece(size_t bytes, ViewTime now) {
  Outgoing& out = *outgoing_;
  const bool first = out.sent == 0;
  const bool last = out.sent + bytes == out.bytes.size();
  ViewMessage message;
  if (first) message = std::move(out.message);
  const size_t depth_bytes = message.picture.depth ? message.picture.depth->codes.size() : 0;
  message.frame = out.frame;
  if (first && last) {
    message.picture.bytes = std::move(out.bytes);
  } else {
    const auto begin = out.bytes.begin() + static_cast<std::ptrdiff_t>(out.sent);
    message.picture.bytes.assign(begin, begin + static_cast<std::ptrdiff_t>(bytes));
  }
  out.sent += bytes;
  message.first = first;
  message.more = !last;

  Job& job = frames_.at(out.frame);
  ++job.unacknowledged;
  job.sent = last;
  if (job.video) last_packet_ = out.frame;
  plan_.send(out.kind, last);
  link_.send(out.frame, bytes + depth_bytes, now);
  counts_.bytes += bytes;
  if (last) {
    ++counts_.frames;
    outgoing_.reset();
  }
  port_.send(std::move(message));
}

void ViewSession::acknowledge(uint64_t frame, double client_ms, ViewTime now) {
  const auto found = frames_.find(frame);
  if (closed_ || found == frames_.end() || found->second.unacknowledged == 0) return;
  Job& job = found->second;
  --job.unacknowledged;
  plan_.acknowledge(job.kind);
  const bool late = link_.waits_ms(now) > link_.least_elapsed_ms() + kLateMs;
  const std::optional<double> transfer = link_.acknowledge(frame, client_ms, now);
  if (job.kind == FrameKind::kMotion && job.sent) latencies_.push_back(now - job.begun);
  if (latencies_.size() > kLatencies) latencies_.pop_front();
  if (job.kind == FrameKind::kMotion && transfer) adapt_quality(job, *transfer, client_ms, late);
  erase_if_done(frame);
}

void ViewSession::adapt_quality(Job& job, double transfer_ms, double client_ms, bool late) {
  job.cost.transfer = transfer_ms;
  job.cost.client = client_ms;
  last_cost_ = job.cost;
  // While frames are late, fewer are drawn, each in less time. That is no evidence for larger ones.
  if (job.video && late) return;
  // A frame drawn with an earlier quality is no evidence about the current one.
  const bool current = job.quality.draw.rung == quality_.draw.rung && job.quality.link.rung == quality_.link.rung;
  if (current) quality_ = (job.video ? adapt_drawing : adapt)(quality_, job.cost, motion_fps());
}

void ViewSession::close() {
  if (closed_) return;
  closed_ = true;
  outgoing_.reset();
  for (const auto& [frame, job] : frames_) {
    if (plan_.is_pending(frame)) service_.cancel(job.job);
  }
}

}  // namespace surfcast::view
