#include "worker/worker_renderer.h"

#include <optional>
#include <span>
#include <utility>

#include "base/contract.h"
#include "base/log.h"
#include "base/stopwatch.h"
#include "worker/blame.h"
#include "worker/supervisor.h"

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

class WorkerRenderer : public service::ModelRenderer {
 public:
  WorkerRenderer(const WorkerConfig& config, WorkerCounts& counts)
      : most_pixels_(config.pixels), silence_(config.silence), worker_(start_of(config), counts, blame_) {}

  /// Starts a worker, if there is none.
  Status start() {
    if (worker_.running()) return {};
    if (Status started = worker_.start(); !started) return started;
    spdlog::info("render worker {} draws with {}", worker_.id(), device().renderer);
    return {};
  }

  Result<picture::Frame> draw(const std::shared_ptr<const model::ModelFile>& model,
                              const picture::PictureRequest& request, const Preemption& preemption) override {
    if (pixels_of(request) > most_pixels_)
      return fail(ErrorKind::kLimit, "the picture has more pixels than may be drawn");
    if (Status passable = check_passable(*model); !passable) return fail(passable);
    for (Attempts attempts; !attempts.exhausted();) {
      if (Status started = start(); !started) return fail(started);
      const uint64_t generation = worker_.generation();
      ++depth_;
      Result<picture::Frame> frame = exchange(model, request, preemption);
      --depth_;
      if (!worker_.was_lost()) return frame;
      // Unless a picture in the middle of this one has seen the end of the worker: that one is to blame.
      const bool to_blame = generation == worker_.generation() && worker_.running();
      const Supervisor::End end = to_blame ? worker_.bury() : Supervisor::End{false, false};
      attempts.ended(end.own_fault, end.blocks_blamed);
      if (preemption.cancelled()) return fail(ErrorKind::kCancelled, "cancelled: the client no longer needs it");
    }
    return fail(ErrorKind::kUnavailable, "the picture has ended every render worker that was to draw it");
  }

  void release_model(const model::ModelFile& model) override { worker_.withdraw(model.id()); }

  [[nodiscard]] const picture::DeviceInfo& device() const override { return worker_.ready().device; }
  [[nodiscard]] int max_resolution() const override { return worker_.ready().max_resolution; }

 private:
  static WorkerStart start_of(const WorkerConfig& config) {
    return {"render worker", config.command, config.environment, config.pixels * 4 * sizeof(float),
            Configure{config.renderer, config.log_format, config.sandbox, config.readable, config.writable}};
  }

  /// An error of the supervisor, which notes that, if the worker has ended meanwhile.
  Result<picture::Frame> exchange(const std::shared_ptr<const model::ModelFile>& model,
                                  const picture::PictureRequest& request, const Preemption& preemption) {
    const size_t depth = depth_ - 1;
    const uint64_t generation = worker_.generation();
    worker_.board().cancelled(depth) = preemption.cancelled();
    if (!worker_.offer(model) || !worker_.channel().send(Draw{model->id(), request})) return worker_.lost();
    for (Stopwatch silence;;) {
      Result<std::optional<Received>> received = worker_.channel().receive(kLookUp);
      if (!received) {
        return received.error().kind == ErrorKind::kIo ? worker_.lost() : worker_.misbehaved("is not understood");
      }
      if (!received->has_value()) {
        worker_.board().cancelled(depth) = preemption.cancelled();
        if (silence.milliseconds() > static_cast<double>(silence_.count())) return worker_.misbehaved("hangs");
        continue;
      }
      Message& message = (*received)->message;
      if (auto* const drawn = std::get_if<Drawn>(&message)) return frame_of(std::move(*drawn), request);
      if (auto* const refused = std::get_if<Refused>(&message)) return fail(checked(std::move(refused->error)));
      if (!std::holds_alternative<AskUrgent>(message)) return worker_.misbehaved("is not understood");
      const bool preempted = preemption.yield_to_urgent();
      if (generation != worker_.generation() || !worker_.running()) return worker_.lost();
      worker_.board().cancelled(depth) = preemption.cancelled();
      if (!worker_.channel().send(Continue{preempted})) return worker_.lost();
      silence = Stopwatch();
    }
  }

  /// The worker may be hostile: nothing of its answer but the size of the request says how much is copied.
  Result<picture::Frame> frame_of(Drawn drawn, const picture::PictureRequest& request) {
    picture::Image& image = drawn.frame.image;
    image.width = request.width;
    image.height = request.height;
    image.format = request.format;
    if (!drawn.pixels) return std::move(drawn.frame);
    const size_t bytes = pixel_bytes(request);
    const std::span<const std::byte> pixels = worker_.board().pixels();
    SURFCAST_EXPECTS(bytes <= pixels.size());
    image.pixels.assign(pixels.begin(), pixels.begin() + static_cast<std::ptrdiff_t>(bytes));
    if (bytes > kKeptPixelBytes) worker_.board().release_pixels(bytes);
    return std::move(drawn.frame);
  }

  static constexpr milliseconds kLookUp{5};  ///< how often cancellations are passed on

  const size_t most_pixels_;
  const milliseconds silence_;
  Blame blame_;
  Supervisor worker_;
  size_t depth_ = 0;  ///< pictures being drawn, each in the middle of the one before
};

}  // namespace

service::ModelRendererFactory worker_renderers(const WorkerConfig& config, WorkerCounts& counts) {
  return [config, &counts]() -> Result<std::unique_ptr<service::ModelRenderer>> {
    auto renderer = std::make_unique<WorkerRenderer>(config, counts);
    if (Status started = renderer->start(); !started) return fail(started);
    return renderer;
  };
}

}  // namespace surfcast::worker
