#include "worker/worker_renderer.h"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "base/contract.h"
#include "base/log.h"
#include "base/stopwatch.h"
#include "worker/blame.h"
#include "worker/run_worker.h"
#include "worker/worker_process.h"

namespace surfcast::worker {
namespace {

using std::chrono::milliseconds;

/// Pictures above this size give their shared memory back.
constexpr size_t kKeptPixelBytes = size_t{64} << 20;

size_t pixels_of(const picture::PictureRequest& request) {
  return static_cast<size_t>(request.width) * static_cast<size_t>(request.height);
}

size_t pixel_bytes(const picture::PictureRequest& request) {
  return pixels_of(request) * (request.format == picture::PixelFormat::kLinearFloat ? 4 * sizeof(float) : 4);
}

/// A hostile worker may state any kind.
Error checked(Error error) {
  if (error.kind < ErrorKind::kInvalidInput || error.kind > ErrorKind::kInternal) error.kind = ErrorKind::kInternal;
  return error;
}

/// How often a picture is begun before it fails.
class Attempts {
 public:
  /// The worker has ended in the middle of the picture. `own_fault`: see is_its_own_fault. `blocks_blamed`: it will not
  /// happen again for the same reason.
  void ended(bool own_fault, bool blocks_blamed) {
    ++ends_;
    if (own_fault && !blocks_blamed) ++faults_;
  }
  [[nodiscard]] bool exhausted() const { return faults_ >= kMostFaults || ends_ >= kMostEnds; }

 private:
  static constexpr int kMostFaults = 2;
  static constexpr int kMostEnds = 16;

  int faults_ = 0;
  int ends_ = 0;
};

class WorkerRenderer : public service::ModelRenderer {
 public:
  WorkerRenderer(WorkerConfig config, WorkerCounts& counts) : config_(std::move(config)), counts_(counts) {}

  /// Starts a worker, if there is none.
  Status start() {
    if (process_) return {};
    Result<WorkerProcess> process =
        WorkerProcess::start(config_.command, config_.environment, config_.pixels * 4 * sizeof(float));
    if (!process) return fail(std::move(process.error()));
    process_.emplace(std::move(*process));
    ++generation_;
    offered_.clear();
    Status ready = configure();
    if (!ready) process_.reset();
    return ready;
  }

  Result<picture::Frame> draw(const std::shared_ptr<const model::ModelFile>& model,
                              const picture::PictureRequest& request, const Preemption& preemption) override {
    if (pixels_of(request) > config_.pixels)
      return fail(ErrorKind::kLimit, "the picture has more pixels than may be drawn");
    for (Attempts attempts; !attempts.exhausted();) {
      if (Status started = start(); !started) return fail(std::move(started.error()));
      const uint64_t generation = generation_;
      ++depth_;
      Result<picture::Frame> frame = exchange(*model, request, preemption);
      --depth_;
      if (!worker_lost_) return frame;
      worker_lost_ = false;
      // Unless a picture in the middle of this one has seen the end of the worker: that one is to blame.
      const End end = generation == generation_ && process_ ? bury() : End{false, false};
      attempts.ended(end.own_fault, end.blocks_blamed);
      if (preemption.cancelled()) return fail(ErrorKind::kCancelled, "no longer wanted");
    }
    return fail(ErrorKind::kUnavailable, "the picture has ended every render worker that was to draw it");
  }

  void release_model(const model::ModelFile& model) override {
    blame_.forget(model.id());
    // If the worker has ended, the next picture notices.
    if (offered_.erase(model.id()) > 0 && process_) (void)process_->channel().send(WithdrawModel{model.id()});
  }

  [[nodiscard]] const picture::DeviceInfo& device() const override { return ready_.device; }
  [[nodiscard]] int max_resolution() const override { return ready_.max_resolution; }

 private:
  struct End {
    bool own_fault = true;
    bool blocks_blamed = false;
  };

  Status configure() {
    constexpr milliseconds kStart{60'000};  // a driver's first start compiles its own programs
    Channel& channel = process_->channel();
    const Configure message{config_.renderer, config_.log_format, config_.sandbox, config_.readable, config_.writable};
    if (Status sent = channel.send(message); !sent) return not_started(sent.error().message);
    Result<std::optional<Received>> received = channel.receive(kStart);
    if (!received) return not_started(received.error().message);
    if (!received->has_value()) return not_started("it does not answer");
    if (auto* const refused = std::get_if<Refused>(&(*received)->message))
      return fail(checked(std::move(refused->error)));
    auto* const ready = std::get_if<Ready>(&(*received)->message);
    if (ready == nullptr) return not_started("its answer is not understood");
    ready_ = std::move(*ready);
    ++counts_.started;
    spdlog::info("render worker {} draws with {}", process_->id(), ready_.device.renderer);
    return {};
  }

  Status not_started(const std::string& why) {
    const ProcessEnd end = process_->end();
    return fail(ErrorKind::kUnavailable, "the render worker did not start: " + why + ", " + text_of(end));
  }

  /// Sets worker_lost_ and returns any error if the worker has ended meanwhile.
  Result<picture::Frame> exchange(const model::ModelFile& model, const picture::PictureRequest& request,
                                  const Preemption& preemption) {
    const size_t depth = depth_ - 1;
    const uint64_t generation = generation_;
    process_->board().cancelled(depth) = preemption.cancelled();
    if (!offer(model) || !process_->channel().send(Draw{model.id(), request})) return lost();
    for (Stopwatch silence;;) {
      Result<std::optional<Received>> received = process_->channel().receive(kLookUp);
      if (!received) return received.error().kind == ErrorKind::kIo ? lost() : misbehaved("is not understood");
      if (!received->has_value()) {
        process_->board().cancelled(depth) = preemption.cancelled();
        if (silence.milliseconds() > static_cast<double>(config_.silence.count())) return misbehaved("hangs");
        continue;
      }
      Message& message = (*received)->message;
      if (auto* const drawn = std::get_if<Drawn>(&message)) return frame_of(std::move(*drawn), request);
      if (auto* const refused = std::get_if<Refused>(&message)) return fail(checked(std::move(refused->error)));
      if (!std::holds_alternative<AskUrgent>(message)) return misbehaved("is not understood");
      const bool preempted = preemption.yield_to_urgent();
      if (generation != generation_ || !process_) return lost();
      process_->board().cancelled(depth) = preemption.cancelled();
      if (!process_->channel().send(Continue{preempted})) return lost();
      silence = Stopwatch();
    }
  }

  /// Passes a model on that the worker does not know yet.
  Status offer(const model::ModelFile& model) {
    if (!offered_.insert(model.id()).second) return {};
    SURFCAST_EXPECTS(model.source().descriptor() >= 0);
    const OfferModel message{model.id(), model.path().string(), blame_.quarantined(model.id()),
                             blame_.suspected(model.id())};
    return process_->channel().send(message, model.source().descriptor());
  }

  /// The worker may be hostile: nothing of its answer but the size of the request says how much is copied.
  Result<picture::Frame> frame_of(Drawn drawn, const picture::PictureRequest& request) {
    picture::Image& image = drawn.frame.image;
    image.width = request.width;
    image.height = request.height;
    image.format = request.format;
    if (!drawn.pixels) return std::move(drawn.frame);
    const size_t bytes = pixel_bytes(request);
    const std::span<const std::byte> pixels = process_->board().pixels();
    SURFCAST_EXPECTS(bytes <= pixels.size());
    image.pixels.assign(pixels.begin(), pixels.begin() + static_cast<std::ptrdiff_t>(bytes));
    if (bytes > kKeptPixelBytes) process_->board().release_pixels(bytes);
    return std::move(drawn.frame);
  }

  tl::unexpected<Error> lost() {
    worker_lost_ = true;
    return fail(ErrorKind::kUnavailable, "the render worker has ended");
  }
  tl::unexpected<Error> misbehaved(const char* how) {
    spdlog::error("render worker {} {}, and is killed", process_->id(), how);
    misbehaved_ = true;
    ::kill(process_->id(), SIGKILL);
    return lost();
  }

  /// Ends what is left of the worker and finds what is to blame.
  End bury() {
    End verdict;
    const pid_t id = process_->id();
    const ProcessEnd end = process_->end();
    ++counts_.ended;
    verdict.own_fault = std::exchange(misbehaved_, false) || is_its_own_fault(end);
    if (verdict.own_fault) {
      const std::vector<BoardBlock> quarantined = blame_.worker_ended(process_->board().loading());
      counts_.quarantined += quarantined.size();
      verdict.blocks_blamed = !quarantined.empty();
      for (const BoardBlock& block : quarantined) {
        spdlog::error("block {} has ended two render workers, and is not loaded any more", block.block);
      }
    }
    spdlog::error("render worker {} has ended: {}{}", id, text_of(end),
                  end.exit_code == kGpuWasReset ? ", the GPU was reset" : "");
    process_.reset();
    return verdict;
  }

  static constexpr milliseconds kLookUp{5};  ///< how often cancellations are passed on

  const WorkerConfig config_;
  WorkerCounts& counts_;
  std::optional<WorkerProcess> process_;
  uint64_t generation_ = 0;  ///< counts the workers
  Ready ready_;
  size_t depth_ = 0;            ///< pictures being drawn, each in the middle of the one before
  bool misbehaved_ = false;     ///< and was killed for that
  bool worker_lost_ = false;    ///< see exchange
  std::set<uint64_t> offered_;  ///< ModelFile::id of the models that the worker knows
  Blame blame_;
};

}  // namespace

service::ModelRendererFactory worker_renderers(const WorkerConfig& config, WorkerCounts& counts) {
  return [config, &counts]() -> Result<std::unique_ptr<service::ModelRenderer>> {
    auto renderer = std::make_unique<WorkerRenderer>(config, counts);
    if (Status started = renderer->start(); !started) return fail(std::move(started.error()));
    return renderer;
  };
}

}  // namespace surfcast::worker
