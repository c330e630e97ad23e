#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "encode/encode_picture.h"
#include "render/picture.h"
#include "service/job_queue.h"
#include "service/model_source.h"
#include "service/painter.h"
#include "service/pick_service.h"

namespace surfcast {

struct ServiceLimits {
  size_t queued_jobs = 256;                    ///< pictures that may wait for the render thread, over all sessions
  size_t pixels = size_t{1} << 25;             ///< of one picture (8192 x 4096)
  unsigned encoders = 2;                       ///< threads that encode patient pictures and look up models
  size_t frames_in_encoding = 3;               ///< drawn pictures of either urgency in memory before no more are drawn
  std::chrono::milliseconds patience{20'000};  ///< of a picture that waits for the render thread
};

/// A picture somebody wants, as a file.
struct PictureJob {
  std::string model;
  PictureRequest request;      ///< its pixel format follows from `format`
  bool up_from_model = false;  ///< take the model's vertical axis as the camera's view_up
  FileFormat format = FileFormat::kPng;
  int quality = 90;  ///< of JPEG and WebP, 1 to 100
  Urgency urgency = Urgency::kPatient;
  JobId supersedes = 0;     ///< a job that nobody wants to see any more once this one is drawn; 0: none
  bool keep_frame = false;  ///< hand the frame over with the picture
};

/// A picture as a file, and what it shows.
struct EncodedPicture {
  std::vector<std::byte> bytes;  ///< none where the frame has no pixels, see Frame
  FileFormat format = FileFormat::kPng;
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  Camera camera;   ///< the one that was used
  Normalization normalization = Normalization::kPixel;
  double spacing = 0;      ///< as in PictureRequest
  bool converged = false;  ///< as in Frame
  bool settled = false;    ///< as in Frame
  uint64_t cut = 0;        ///< as in Frame
  double waited_ms = 0;    ///< for the render thread
  double draw_ms = 0;
  double encode_ms = 0;
  std::shared_ptr<const Frame> frame;  ///< see PictureJob::keep_frame
  FrameStats stats;                    ///< its stages begin with "queue" and end with "encode"
};

/// Turns wishes into encoded pictures. One render thread owns the painter and takes jobs from a queue that is fair
/// between sessions; a small pool encodes, and a thread of its own what motions wait for. These are also drawn in the
/// middle of patient pictures (see DrawShares). Every method may be called from any thread.
///
/// Callbacks run on a thread of the service or, for a job that is refused or cancelled while it waits, on the caller's
/// own before the call returns. They must not throw or block. Each is called exactly once.
class RenderService {
 public:
  using PictureDone = std::function<void(Result<EncodedPicture>)>;
  using NamesDone = std::function<void(std::vector<std::string>)>;
  using DescriptionDone = std::function<void(Result<ModelDescription>)>;

  /// Starts the threads; fails when the painter cannot be made. `models` must outlive the service.
  static Result<std::unique_ptr<RenderService>> start(const ModelSource& models, PainterFactory make_painter,
                                                      const ServiceLimits& limits);
  /// Cancels what is outstanding and joins the threads.
  ~RenderService();

  JobId draw(SessionId session, PictureJob job, PictureDone done);
  /// Lets a job that still waits for the render thread draw something else in its place. False if it does not wait any
  /// more, or if there can be no such picture.
  bool replace(JobId job, PictureJob wish);
  /// The picture that `wish` asks for, from a frame that has been drawn for that very request.
  JobId encode(std::shared_ptr<const Frame> frame, PictureJob wish, PictureDone done);
  /// True when the job was outstanding; its callback then gets kCancelled, unless the picture is just being handed
  /// over.
  bool cancel(JobId job);

  void list_models(NamesDone done);
  void describe_model(const std::string& name, DescriptionDone done);
  /// What a pixel shows; see PickService.
  void pick(PickJob job, PickService::Done done);

  [[nodiscard]] const DeviceInfo& device() const;
  /// Jobs that wait for the render thread.
  [[nodiscard]] size_t queued() const;

 private:
  struct State;
  explicit RenderService(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast
