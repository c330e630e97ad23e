// A query worker that knows all kinds and balls. The environment says how it fails: SURFCAST_WORKER_CRASHING_BLOCK is
// the number of a block of balls that ends the process when it is decoded, SURFCAST_WORKER_STOPPING_BLOCK one that
// stops it there until it is told to go on. SURFCAST_WORKER_LYING=1 makes it answer with what has no meaning.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "kinds/ball_kind.h"
#include "worker/channel.h"
#include "worker/run_worker.h"

namespace {

using namespace surfcast;

bool is_named(const char* variable, uint32_t block) {
  const char* const named = std::getenv(variable);
  return named != nullptr && std::to_string(block) == named;
}

class FailingBalls : public testing::BallKind {
 public:
  [[nodiscard]] Result<std::shared_ptr<const kinds::SourceBlock>> decode(const model::ModelFile& model,
                                                                         uint32_t block) const override {
    auto decoded = BallKind::decode(model, block);
    if (!decoded) return decoded;
    if (is_named("SURFCAST_WORKER_CRASHING_BLOCK", block)) std::raise(SIGSEGV);
    if (is_named("SURFCAST_WORKER_STOPPING_BLOCK", block)) std::raise(SIGSTOP);
    return decoded;
  }
};

/// An answer that no worker gives.
struct Lie {
  worker::Message operator()(const worker::FindBand& find) const {
    worker::BandPart part{find.query.most, 1, {}, {}, {}, true};
    part.points.resize(find.query.most + 1);
    return part;
  }
  worker::Message operator()(const worker::SearchSurface& /*search*/) const {
    return worker::SurfacePart{std::vector<std::byte>(40)};
  }
  template <typename Other>
  worker::Message operator()(const Other& /*message*/) const {
    return worker::Continue{};
  }
};

[[noreturn]] void lie(worker::Channel channel) {
  for (;;) {
    const auto received = channel.receive(std::chrono::seconds(60));
    if (!received || !received->has_value()) std::_Exit(EXIT_SUCCESS);
    const worker::Message& message = (*received)->message;
    if (std::holds_alternative<worker::OfferModel>(message)) continue;
    const bool first = std::holds_alternative<worker::ConfigureQueries>(message);
    (void)channel.send(first ? worker::Message(worker::Ready{}) : std::visit(Lie{}, message));
  }
}

}  // namespace

int main() {
  Descriptor socket(worker::kWorkerSocket);
  Descriptor memory(worker::kWorkerMemory);
  if (std::getenv("SURFCAST_WORKER_LYING") != nullptr) lie(worker::Channel(std::move(socket)));
  static const FailingBalls kBalls;
  std::vector<const kinds::Kind*> kinds(kinds::built_in_kinds().begin(), kinds::built_in_kinds().end());
  kinds.push_back(&kBalls);
  worker::run_query_worker(std::move(socket), std::move(memory), kinds);
}
