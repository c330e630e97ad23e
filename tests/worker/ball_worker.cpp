// A render worker that draws surfels and balls. The environment says how it fails: SURFCAST_WORKER_CRASHING_BLOCK is
// the number of a block of balls that ends the process when it is loaded, SURFCAST_WORKER_LYING=1 makes it answer the
// first picture with nonsense.

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>

#include "kinds/ball_kind.h"
#include "worker/channel.h"
#include "worker/run_worker.h"

namespace {

using namespace surfcast;

class CrashingBalls : public testing::BallKind {
 public:
  [[nodiscard]] Result<residency::PackedBlock> load(const model::ModelFile& model, uint32_t block,
                                                    bool attributes) const override {
    const char* const crashing = std::getenv("SURFCAST_WORKER_CRASHING_BLOCK");
    if (crashing != nullptr && std::to_string(block) == crashing) std::raise(SIGSEGV);
    return BallKind::load(model, block, attributes);
  }
};

/// Says that it draws, and answers each picture with a message that is no answer.
[[noreturn]] void lie(worker::Channel channel) {
  for (;;) {
    const auto received = channel.receive(std::chrono::seconds(60));
    if (!received || !received->has_value()) std::_Exit(EXIT_SUCCESS);
    if (std::holds_alternative<worker::Configure>((*received)->message)) {
      (void)channel.send(worker::Ready{{"liar", "liar", "0"}, 4096});
    } else if (std::holds_alternative<worker::Draw>((*received)->message)) {
      (void)channel.send(worker::Continue{});
    }
  }
}

}  // namespace

int main() {
  Descriptor socket(worker::kWorkerSocket);
  Descriptor memory(worker::kWorkerMemory);
  if (std::getenv("SURFCAST_WORKER_LYING") != nullptr) lie(worker::Channel(std::move(socket)));
  static const CrashingBalls kBalls;
  static const std::array<const kinds::Kind*, 2> kKinds{kinds::built_in_kinds()[0], &kBalls};
  worker::run_worker(std::move(socket), std::move(memory), kKinds);
}
