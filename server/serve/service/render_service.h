#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "access/authorization.h"
#include "base/lru_cache.h"
#include "base/result.h"
#include "picture/channels.h"
#include "picture/file_format.h"
#include "picture/picture.h"
#include "service/frame_renderer.h"
#include "service/job_queue.h"
#include "service/model_source.h"
#include "service/pick_service.h"
#include "video/video_stream.h"

namespace surfcast::service {

struct ServiceLimits {
  size_t queued_jobs = 256;         ///< pictures that may wait for the render thread, in all sessions together
  size_t pixels = size_t{1} << 25;  ///< of one picture (8192 x 4096)
  int side = 16384;                 ///< of one picture, pixels; the renderer may draw less
  unsigned encoders = 2;            ///< threads that encode still pictures and look up models
  size_t frames_in_encoding = 3;    ///< per priority: pictures in memory at which no further ones are drawn
  /// Of pictures at rest, from the beginning of drawing until their clients have taken them, bytes. 0: a quarter of the
  /// host's available memory, 1 GiB at most. See PictureMemory.
  size_t picture_memory = 0;
  std::chrono::milliseconds queue_timeout{20'000};  ///< longest wait of a picture for the render thread
  /// A still picture that others wait for is drawn for so long at least before one of another session is drawn in its
  /// middle.
  std::chrono::milliseconds still_turn{250};
  /// Likewise a motion picture, before a small still picture of another session is drawn in its middle.
  std::chrono::milliseconds motion_turn{100};
  PickLimits picks{};
};

/// The place of a motion picture in a view's video.
struct VideoJob {
  std::shared_ptr<video::VideoStream> stream;
  video::FrameOrder order;
};

/// A request for an encoded picture.
struct PictureJob {
  access::AuthorizedModel model;
  picture::PictureRequest request{};  ///< its pixel format is replaced by that of `format`
  bool up_from_model = false;         ///< take the model's vertical axis as the camera's view_up
  picture::FileFormat format = picture::FileFormat::kPng;
  int quality = 90;  ///< of JPEG and WebP, 1 to 100
  picture::JpegOrder order = picture::JpegOrder::kRows;
  size_t depth_bytes = 0;          ///< with PictureRequest::depth_texels: of EncodedPicture::depth, at most
  picture::ChannelSet channels{};  ///< of the file beside colours; only of EXR and of still pictures
  Priority priority = Priority::kStill;
  JobId supersedes = 0;     ///< a job whose picture is obsolete once this one is drawn; 0: none
  bool keep_frame = false;  ///< return the frame with the picture, if there is memory for it
  /// Of a motion picture with 8 bits a channel: it becomes a packet of this video, or a file in `format` if it cannot.
  std::optional<VideoJob> video{};
};

/// What a packet of a video is to its decoder; see video::VideoPacket.
struct PacketPlace {
  bool key = false;
  uint64_t refers_to = 0;
};

/// An encoded picture and its description.
struct EncodedPicture {
  std::vector<std::byte> bytes;  ///< empty if the frame has no pixels, see Frame
  picture::FileFormat format = picture::FileFormat::kPng;
  int width = 0;            ///< pixels
  int height = 0;           ///< pixels
  geometry::Camera camera;  ///< the one that was used
  picture::Normalization normalization = picture::Normalization::kPixel;
  double spacing = 0;            ///< as in PictureRequest, or the one that was chosen
  double render_scale = 1;       ///< as in Frame
  double expected_error = 0;     ///< as in Frame
  double expected_ms = 0;        ///< as in Frame, with encoding
  bool converged = false;        ///< as in Frame
  bool nothing_pending = false;  ///< as in Frame
  uint64_t cut = 0;              ///< as in Frame
  bool preview = false;          ///< as in Frame
  double waited_ms = 0;          ///< waiting for the render thread
  double draw_ms = 0;
  double encode_ms = 0;
  std::optional<PacketPlace> video;             ///< `bytes` are a packet of PictureJob::video instead of a file
  std::optional<picture::EncodedDepth> depth;   ///< with PictureRequest::depth_texels, if it is known
  std::shared_ptr<const picture::Frame> frame;  ///< see PictureJob::keep_frame
  std::shared_ptr<const void> memory;           ///< counts `bytes`; to be kept until they are released
  picture::FrameStats stats;                    ///< the first stage is "queue", the last one "encode"
};

/// Who draws models.
struct Drawers {
  FrameRendererFactory make_renderer;
  std::shared_ptr<ModelQueries> queries{};  ///< answers what is asked about them beside pictures; null: this process
};

/// Draws and encodes pictures. A render thread owns each renderer and takes jobs from a queue that is fair between
/// clients and their sessions. Models are spread over the renderers (see RendererChoice). A small pool encodes still
/// pictures; motion pictures have an encoder thread of their own. Motion pictures may preempt still pictures (see
/// DrawShares). All methods may be called from any thread.
///
/// Remote models (see ModelSource) may have a queue and threads of their own, so that nobody else waits for the
/// network.
///
/// A picture with channels of its front surface waits until that has been found, and then for the render thread.
///
/// Whatever is about a model takes an access::AuthorizedModel: who may know of which is decided before, and only there.
///
/// Callbacks run on a thread of the service. If a job is refused, or cancelled while it waits for the render thread,
/// its callback runs on the calling thread before the call returns. Callbacks must not block. Each is called exactly
/// once, or again with an error if it throws (out of memory).
class RenderService {
 public:
  using PictureDone = std::function<void(Result<EncodedPicture>)>;
  using ListDone = std::function<void(ModelList)>;
  using DescriptionDone = std::function<void(Result<ModelDescription>)>;

  /// Starts the threads. Fails if a renderer cannot be created. `models` must outlive the service. `queries` answers
  /// what is asked about models beside pictures; null: this process does. `remote`: who draws remote models, beside the
  /// others; none: whoever draws those. `more`: further renderers of the same models, as of other GPUs. Only the memory
  /// of pictures is shared; other limits are of each queue.
  static Result<std::unique_ptr<RenderService>> start(const ModelSource& models, FrameRendererFactory make_renderer,
                                                      const ServiceLimits& limits,
                                                      std::shared_ptr<ModelQueries> queries = nullptr,
                                                      std::optional<Drawers> remote = std::nullopt,
                                                      std::vector<FrameRendererFactory> more = {});
  /// Cancels the outstanding jobs and joins the threads.
  ~RenderService();

  /// A picture of a model that is awaited (see ModelSource) waits for it; pictures of views fail at once.
  JobId draw(const Client& client, PictureJob job, PictureDone done);
  /// Replaces the picture of a job that still waits for the render thread. False if the job does not wait any more, or
  /// if the new picture is invalid.
  bool replace(JobId job, PictureJob picture);
  /// Encodes `picture` from a frame that was drawn for the same request.
  JobId encode(std::shared_ptr<const picture::Frame> frame, PictureJob picture, PictureDone done,
               const Client& client = {});
  /// True if the job was outstanding. Its callback then gets kCancelled, unless the picture is already being delivered.
  bool cancel(JobId job);

  /// Look-ups run on a thread of their own, in turns of the clients. A list has what the rights allow to know of.
  void list_models(access::Rights rights, ListDone done, ClientId client = 0);
  void describe_model(const access::AuthorizedModel& model, DescriptionDone done, ClientId client = 0);
  /// Call it after a change of an awaited model, and now and then while there is one: pictures, picks, profiles, points
  /// and descriptions that wait for it are begun, or refused after the queue's timeout.
  void models_changed();
  /// See ModelSource.
  [[nodiscard]] uint64_t edition(const access::AuthorizedModel& model) const;
  /// Finds the item in a pixel; see PickService.
  void pick(PickJob job, PickService::Done done, ClientId client = 0);
  /// Finds the points near a line; see PickService.
  void profile(ProfileJob job, PickService::ProfileDone done, ClientId client = 0);
  /// Counts the points of a region, and makes their file piece by piece; see PickService.
  void points(PointsJob job, std::shared_ptr<const std::atomic<bool>> cancelled, PickService::PointsDone done,
              ClientId client = 0);
  void next_piece(std::shared_ptr<PointStream> stream, PickService::PieceDone done, ClientId client = 0);

  /// The devices of the renderers, but for that of remote models.
  [[nodiscard]] std::vector<picture::DeviceInfo> devices() const;
  /// Their budgets together.
  [[nodiscard]] picture::MemoryBudgets memory() const;
  /// Jobs that wait for a render thread.
  [[nodiscard]] size_t queued() const;
  /// Bytes of ServiceLimits::picture_memory that are taken.
  [[nodiscard]] size_t picture_memory() const;

 private:
  struct State;
  RenderService(std::vector<std::unique_ptr<State>> local, std::unique_ptr<State> remote);
  [[nodiscard]] State& state_of(const std::string& model) const;
  [[nodiscard]] State& state_of(JobId job) const;
  [[nodiscard]] State& drawer_of(const PictureJob& job);
  [[nodiscard]] std::vector<State*> all() const;

  std::vector<std::unique_ptr<State>> local_;  ///< of each renderer; the first one has what is not of a renderer
  std::unique_ptr<State> remote_;              ///< of remote models; null: they have none of their own
  std::mutex views_mutex_;
  LruCache<uint64_t, size_t> views_;  ///< which renderer has drawn the last picture of each view
};

}  // namespace surfcast::service
