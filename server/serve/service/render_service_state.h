#pragma once

#include <array>
#include <condition_variable>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/preemption.h"
#include "base/stopwatch.h"
#include "service/draw_shares.h"
#include "service/encode_times.h"
#include "service/frame_renderer.h"
#include "service/job_queue.h"
#include "service/pick_service.h"
#include "service/render_job.h"
#include "service/render_service.h"
#include "service/worker_pool.h"

namespace surfcast::service {

/// The number of no job: jobs count from 1.
inline constexpr JobId kNoJob = 0;

/// The service of some models, with a queue and threads of their own. Its render thread is in render_thread.cpp, the
/// rest in render_service_state.cpp.
struct RenderService::State {
  using JobPointer = std::shared_ptr<RenderJob>;
  /// Gets an error if the model is not there in time.
  using Proceed = std::function<void(const Status& there)>;

  /// `jobs_before`: the first job has the next number. `memory` is to be set before the threads start.
  State(const ModelSource& source, const ServiceLimits& service_limits, JobId jobs_before)
      : models(source), limits(service_limits), queue(service_limits.queued_jobs), last_id(jobs_before) {}

  [[nodiscard]] Status start_threads(FrameRendererFactory make_renderer, std::shared_ptr<PickService> shared_picks);

  // Render thread.
  void run(const FrameRendererFactory& make_renderer, std::promise<Status> started);
  [[nodiscard]] bool warm_up(FrameRenderer& renderer);
  [[nodiscard]] bool idle_for_a_moment();
  [[nodiscard]] WaitingStills waiting_stills() const;
  [[nodiscard]] bool may_draw(Priority priority) const;
  [[nodiscard]] bool has_room(JobId id) const;
  [[nodiscard]] bool moves_first(ClientId other) const;
  void refuse_late(std::unique_lock<std::mutex>& lock);
  void charge(const RenderJob& job, double milliseconds);
  void leave_queue(const RenderJob& job);
  [[nodiscard]] std::optional<Priority> next_priority() const;
  JobPointer start(JobId id, std::unique_lock<std::mutex>& lock);
  JobPointer next_job();
  JobPointer next_motion(const RenderJob& current);
  JobPointer next_still_of_others(const RenderJob& current, int depth);
  Result<picture::Frame> render_frame(FrameRenderer& renderer, RenderJob& job, const Preemption& preemption);
  Result<double> encoding_ms(FrameRenderer& renderer, const RenderJob& job, picture::PictureRequest request,
                             const Preemption& preemption);
  void draw_one(FrameRenderer& renderer, const JobPointer& job, const Preemption& preemption);
  void draw_motion(FrameRenderer& renderer, const JobPointer& job, int depth, WaitingStills unfinished);
  bool draw_waiting_motion(FrameRenderer& renderer, const RenderJob& current, int depth);
  void draw_still(FrameRenderer& renderer, const JobPointer& job, int depth);
  void cancel_superseded(JobId id);

  static size_t picture_memory_limit(const ServiceLimits& limits);
  void look_again();

  // Pool.
  void encode_one(const JobPointer& job, Result<SharedFrame> frame);
  void count_kept_frame(const RenderJob& job, EncodedPicture& picture) const;

  // Any thread.
  [[nodiscard]] Status check(const PictureJob& picture) const;
  JobId add(const Client& client, PictureJob picture, PictureDone done);
  void search(const JobPointer& job);
  [[nodiscard]] std::vector<JobPointer>::iterator next_search();
  void start_searches();
  bool leave_searches(JobId id);
  void end_search(const JobPointer& job, Result<std::vector<pick::FrontPixel>> front);
  [[nodiscard]] bool enqueue(const RenderJob& job);
  void proceed(const JobPointer& job);
  void end_waiting(const JobPointer& job, const Status& there);
  [[nodiscard]] bool await_model(JobId job, const std::string& model, Proceed proceed);
  [[nodiscard]] bool waits_for_model(const PictureJob& picture) const;
  void when_available(const std::string& model, const Proceed& proceed);
  void models_changed();
  bool cancel(JobId id);
  [[nodiscard]] bool has(JobId id) const;
  [[nodiscard]] size_t queued() const;
  void finish(const JobPointer& job, Result<EncodedPicture> result);
  void stop();

  const ModelSource& models;
  const ServiceLimits limits;
  DrawShares shares;           ///< of the render thread
  picture::DeviceInfo device;  ///< set before start() returns, constant afterwards
  int max_resolution = 0;      ///< likewise
  EncodeTimes encode_times;    ///< of pictures at rest

  mutable std::mutex mutex;  ///< guards the following members
  std::condition_variable wake;
  JobQueue queue;
  /// What waits for a model.
  struct Awaiting {
    JobId job = kNoJob;  ///< of a picture
    std::string model;
    Stopwatch since;
    Proceed proceed;
  };
  std::vector<Awaiting> awaiting;
  std::map<JobId, JobPointer> jobs;  ///< outstanding: waiting, being drawn or being encoded
  JobId last_id;
  std::array<size_t, 2> in_encoding{};    ///< pictures being drawn or encoded, by priority, but for small ones at rest
  size_t small_in_encoding = 0;           ///< these
  std::shared_ptr<PictureMemory> memory;  ///< of all models
  size_t searching = 0;                   ///< jobs whose front surface is being found, or is to be
  std::vector<JobPointer> to_search{};    ///< the latter, which wait for memory
  bool stopping = false;

  // Declared last, so the threads end before the members that they use.
  std::shared_ptr<PickService> picks;  ///< of all renderers of the same models
  std::unique_ptr<WorkerPool> pool;
  std::unique_ptr<WorkerPool> motion_pool;  ///< one thread
  std::unique_ptr<WorkerPool> lookups;      ///< one thread, which waits for the disk
  std::jthread render_thread;
};

}  // namespace surfcast::service
