#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "picture/file_format.h"
#include "picture/picture.h"
#include "service/frame_renderer.h"
#include "service/job_queue.h"
#include "service/model_source.h"
#include "service/pick_service.h"

namespace surfcast::service {

struct ServiceLimits {
  size_t queued_jobs = 256;         ///< pictures that may wait for the render thread, over all sessions
  size_t pixels = size_t{1} << 25;  ///< of one picture (8192 x 4096)
  int side = 16384;                 ///< of one picture, pixels; the renderer may draw less
  unsigned encoders = 2;            ///< threads that encode still pictures and look up models
  size_t frames_in_encoding = 3;    ///< drawn pictures of either priority in memory before no more are drawn
  std::chrono::milliseconds queue_timeout{20'000};  ///< of a picture that waits for the render thread
  PickLimits picks{};
};

/// A picture somebody wants, as a file.
struct PictureJob {
  std::string model;
  picture::PictureRequest request;  ///< its pixel format follows from `format`
  bool up_from_model = false;       ///< take the model's vertical axis as the camera's view_up
  picture::FileFormat format = picture::FileFormat::kPng;
  int quality = 90;  ///< of JPEG and WebP, 1 to 100
  Priority priority = Priority::kStill;
  JobId supersedes = 0;     ///< a job that nobody wants to see any more once this one is drawn; 0: none
  bool keep_frame = false;  ///< hand the frame over with the picture
};

/// A picture as a file, and what it shows.
struct EncodedPicture {
  std::vector<std::byte> bytes;  ///< none where the frame has no pixels, see Frame
  picture::FileFormat format = picture::FileFormat::kPng;
  int width = 0;            ///< pixels
  int height = 0;           ///< pixels
  geometry::Camera camera;  ///< the one that was used
  picture::Normalization normalization = picture::Normalization::kPixel;
  double spacing = 0;            ///< as in PictureRequest
  bool converged = false;        ///< as in Frame
  bool nothing_pending = false;  ///< as in Frame
  uint64_t cut = 0;              ///< as in Frame
  double waited_ms = 0;          ///< for the render thread
  double draw_ms = 0;
  double encode_ms = 0;
  std::shared_ptr<const picture::Frame> frame;  ///< see PictureJob::keep_frame
  picture::FrameStats stats;                    ///< its stages begin with "queue" and end with "encode"
};

/// Turns requests into encoded pictures. One render thread owns the renderer and takes jobs from a queue that is fair
/// between sessions; a small pool encodes, and a thread of its own what motions wait for. These are also drawn in the
/// middle of still pictures (see DrawShares). Every method may be called from any thread.
///
/// Callbacks run on a thread of the service or, for a job that is refused or cancelled while it waits, on the caller's
/// own before the call returns. They must not throw or block. Each is called exactly once.
class RenderService {
 public:
  using PictureDone = std::function<void(Result<EncodedPicture>)>;
  using NamesDone = std::function<void(std::vector<std::string>)>;
  using DescriptionDone = std::function<void(Result<ModelDescription>)>;

  /// Starts the threads; fails when the renderer cannot be made. `models` must outlive the service.
  static Result<std::unique_ptr<RenderService>> start(const ModelSource& models, FrameRendererFactory make_renderer,
                                                      const ServiceLimits& limits);
  /// Cancels what is outstanding and joins the threads.
  ~RenderService();

  JobId draw(SessionId session, PictureJob job, PictureDone done);
  /// Lets a job that still waits for the render thread draw something else in its place. False if it does not wait any
  /// more, or if there can be no such picture.
  bool replace(JobId job, PictureJob picture);
  /// Encodes `picture` from a frame that has been drawn for that very request.
  JobId encode(std::shared_ptr<const picture::Frame> frame, PictureJob picture, PictureDone done);
  /// True when the job was outstanding; its callback then gets kCancelled, unless the picture is just being handed
  /// over.
  bool cancel(JobId job);

  void list_models(NamesDone done);
  void describe_model(const std::string& name, DescriptionDone done);
  /// What a pixel shows; see PickService.
  void pick(PickJob job, PickService::Done done);

  [[nodiscard]] const picture::DeviceInfo& device() const;
  /// Jobs that wait for the render thread.
  [[nodiscard]] size_t queued() const;

 private:
  struct State;
  explicit RenderService(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast::service
