#include "worker/run_worker.h"

#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/file_source.h"
#include "base/log_format.h"
#include "base/stopwatch.h"
#include "gl/device_status.h"
#include "model/model_file.h"
#include "render/renderer.h"
#include "service/guarded.h"
#include "worker/board_guard.h"
#include "worker/channel.h"
#include "worker/offered_models.h"
#include "worker/sandbox.h"
#include "worker/shared_board.h"
#include "worker/worker_life.h"

namespace surfcast::worker {
namespace {

class RenderWorker {
 public:
  RenderWorker(Channel channel, SharedBoard board)
      : channel_(std::move(channel)), board_(std::move(board)), guard_(board_) {}

  [[noreturn]] void run(kinds::KindTable kinds) {
    answer_server(channel_, start(kinds));
    if (!renderer_) end_worker(EXIT_FAILURE);
    for (;;) serve(next_message(channel_));
  }

 private:
  /// The answer to the first message.
  Message start(kinds::KindTable kinds) {
    Message first = next_message(channel_).message;
    auto* const configure = std::get_if<Configure>(&first);
    if (configure == nullptr) end_worker(EXIT_FAILURE);
    set_log_format(configure->log_format);
    configure->renderer.kinds = kinds;
    configure->renderer.load_guard = &guard_;
    auto created = service::guarded([&] { return create(*configure); });
    if (!created) return Refused{created.error()};
    renderer_ = std::move(*created);
    return Ready{renderer_->device(), renderer_->max_resolution()};
  }

  static Result<std::unique_ptr<render::Renderer>> create(const Configure& configure) {
    if (configure.sandbox) {
      OpenFiles files{driver_paths(), configure.writable};
      files.readable.insert(files.readable.end(), configure.readable.begin(), configure.readable.end());
      if (Status confined = confine_files(files); !confined) return fail(confined);
    }
    Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create(configure.renderer);
    if (!renderer || !configure.sandbox) return renderer;
    if (Status confined = confine_calls(); !confined) return fail(confined);
    return renderer;
  }

  /// Does what a message asks for, other than Continue.
  void serve(Received received) {
    if (auto* const offer = std::get_if<OfferModel>(&received.message)) {
      accept(std::move(*offer), std::move(received.descriptor));
    } else if (const auto* const join = std::get_if<OfferJoin>(&received.message)) {
      keep(*join, joined_model(*join, models_));
    } else if (const auto* const withdraw = std::get_if<WithdrawModel>(&received.message)) {
      drop(withdraw->model);
    } else if (const auto* const draw = std::get_if<Draw>(&received.message)) {
      answer_server(channel_, drawn(*draw));
    } else {
      end_worker(EXIT_FAILURE);
    }
  }

  void accept(OfferModel offer, Descriptor file) {
    Result<model::ModelFile> model = service::guarded([&]() -> Result<model::ModelFile> {
      Result<PositionedFile> opened = PositionedFile::adopt(file.release(), offer.path);
      if (!opened) return fail(opened);
      return model::ModelFile::open(std::make_unique<FileSource>(std::move(*opened), offer.path));
    });
    keep(offer, std::move(model).map([](model::ModelFile opened) {
      return std::make_shared<const model::ModelFile>(std::move(opened));
    }));
  }

  /// Keeps a model, or the error of opening it, under the number of its offer.
  template <typename Offer>
  void keep(const Offer& offer, OfferedModel model) {
    if (model) {
      guard_.add((*model)->id(), {offer.model,
                                  offer.path,
                                  {offer.quarantined.begin(), offer.quarantined.end()},
                                  {offer.suspected.begin(), offer.suspected.end()}});
    }
    models_[offer.model] = std::move(model);
  }

  void drop(uint64_t number) {
    const auto found = models_.find(number);
    if (found == models_.end()) return;
    if (found->second) {
      renderer_->release_model(**found->second);
      dropped_.push_back((*found->second)->id());
    }
    models_.erase(found);
    forget_dropped();
  }

  /// A picture that is being drawn may still load blocks of a model that was withdrawn.
  void forget_dropped() {
    if (depth_ > 0) return;
    for (const uint64_t id : dropped_) guard_.remove(id);
    dropped_.clear();
  }

  Message drawn(const Draw& draw) {
    const auto found = models_.find(draw.model);
    if (found == models_.end()) return Refused{{ErrorKind::kInternal, "a picture of a model that was not offered"}};
    if (!found->second) return Refused{found->second.error()};
    if (depth_ >= kDeepestPictures) return Refused{{ErrorKind::kInternal, "too many pictures in the middle of others"}};
    const std::shared_ptr<const model::ModelFile> model = *found->second;
    const Preemption preemption(board_.cancelled(depth_), [this] { return ask_urgent(); });
    ++depth_;
    Result<picture::Frame> frame = service::guarded([&] { return renderer_->draw(model, draw.request, preemption); });
    --depth_;
    forget_dropped();
    since_asked_ = Stopwatch();
    if (gl::context_was_reset()) end_worker(kGpuWasReset);
    if (!frame) return Refused{std::move(frame.error())};
    const bool pixels = !frame->image.pixels.empty();
    if (frame->image.pixels.size() > board_.pixels().size()) {
      return Refused{{ErrorKind::kLimit, "the picture is larger than what the render worker may draw"}};
    }
    if (pixels) std::memcpy(board_.pixels().data(), frame->image.pixels.data(), frame->image.pixels.size());
    frame->image.pixels.clear();
    return Drawn{std::move(*frame), pixels};
  }

  /// Asks the server whether another picture comes first, and draws those that do. Not more often than each 2 ms, so
  /// that asking takes no noticeable part of the time.
  bool ask_urgent() {
    constexpr double kPauseMs = 2;
    if (since_asked_.milliseconds() < kPauseMs) return false;
    answer_server(channel_, AskUrgent{});
    for (;;) {
      Received received = next_message(channel_);
      if (const auto* const go_on = std::get_if<Continue>(&received.message)) {
        since_asked_ = Stopwatch();
        return go_on->preempted;
      }
      serve(std::move(received));
    }
  }

  Channel channel_;
  SharedBoard board_;
  BoardGuard guard_;
  OfferedModels models_;
  std::unique_ptr<render::Renderer> renderer_;  ///< ends before the guard
  std::vector<uint64_t> dropped_;               ///< IDs of models withdrawn
  size_t depth_ = 0;                            ///< pictures being drawn, each in the middle of the one before
  Stopwatch since_asked_;
};

}  // namespace

void run_worker(Descriptor socket, Descriptor memory, kinds::KindTable kinds) {
  SharedBoard board = begin_worker(std::move(memory));
  RenderWorker(Channel(std::move(socket)), std::move(board)).run(kinds);
}

}  // namespace surfcast::worker
