#include "worker/supervisor.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <utility>

#include "base/contract.h"
#include "base/log.h"
#include "worker/run_worker.h"

namespace surfcast::worker {

using std::chrono::milliseconds;

Supervisor::Supervisor(WorkerStart start, WorkerCounts& counts, Blame& blame)
    : start_(std::move(start)), counts_(counts), blame_(blame) {}

Status Supervisor::start() {
  if (process_) return {};
  Result<WorkerProcess> process = WorkerProcess::start(start_.command, start_.environment, start_.pixel_bytes);
  if (!process) return fail(process);
  process_.emplace(std::move(*process));
  ++generation_;
  offered_.clear();
  Status ready = configure();
  if (!ready) process_.reset();
  return ready;
}

Status Supervisor::configure() {
  constexpr milliseconds kStart{60'000};  // a driver's first start compiles its own programs
  if (Status sent = channel().send(start_.configure); !sent) return not_started(sent.error().message);
  Result<std::optional<Received>> received = channel().receive(kStart);
  if (!received) return not_started(received.error().message);
  if (!received->has_value()) return not_started("it does not answer");
  if (auto* const refused = std::get_if<Refused>(&(*received)->message))
    return fail(checked(std::move(refused->error)));
  auto* const ready = std::get_if<Ready>(&(*received)->message);
  if (ready == nullptr) return not_started("its answer is not understood");
  ready_ = std::move(*ready);
  ++counts_.started;
  return {};
}

tl::unexpected<Error> Supervisor::not_started(const std::string& why) {
  const ProcessEnd end = process_->end();
  return fail(ErrorKind::kUnavailable, "the " + start_.name + " did not start: " + why + ", " + text_of(end));
}

Status check_passable(const model::ModelFile& model) {
  for (const model::Member& member : model.members()) {
    if (Status passable = check_passable(*member.model); !passable) return passable;
  }
  if (!model.members().empty()) return {};
  if (model.source().descriptor() >= 0) return {};
  return fail(ErrorKind::kReplaced, "the model lies in a store now");
}

Status Supervisor::offer(const std::shared_ptr<const model::ModelFile>& model) {
  const auto [place, unknown] = offered_.try_emplace(model->id());
  place->second = {model, ++uses_};
  if (!unknown) return {};
  if (!model->members().empty()) return offer_join(*model);
  SURFCAST_EXPECTS(model->source().descriptor() >= 0);
  const OfferModel message{model->id(), model->path().string(), blame_.quarantined(model->id()),
                           blame_.suspected(model->id())};
  return channel().send(message, model->source().descriptor());
}

Status Supervisor::offer_join(const model::ModelFile& model) {
  OfferJoin message{
      model.id(), {}, model.path().string(), blame_.quarantined(model.id()), blame_.suspected(model.id())};
  for (const model::Member& member : model.members()) {
    if (Status offered = offer(member.model); !offered) return offered;
    message.parts.push_back({member.model->id(), member.name, member.places});
  }
  return channel().send(message);
}

void Supervisor::withdraw(uint64_t model) {
  blame_.forget(model);
  // If the worker has ended, the next request notices.
  if (offered_.erase(model) > 0 && process_) (void)channel().send(WithdrawModel{model});
}

void Supervisor::withdraw_unused(size_t most) {
  std::vector<uint64_t> closed;
  for (const auto& [id, offered] : offered_) {
    if (offered.model.expired()) closed.push_back(id);
  }
  for (const uint64_t id : closed) withdraw(id);
  while (offered_.size() > most) {
    const auto oldest = std::ranges::min_element(offered_, {}, [](const auto& entry) { return entry.second.used; });
    if (process_) (void)channel().send(WithdrawModel{oldest->first});
    offered_.erase(oldest);
  }
}

tl::unexpected<Error> Supervisor::lost() {
  lost_ = true;
  return fail(ErrorKind::kUnavailable, "the " + start_.name + " has ended");
}

tl::unexpected<Error> Supervisor::misbehaved(const char* how) {
  spdlog::error("{} {} {}, and is killed", start_.name, id(), how);
  misbehaved_ = true;
  ::kill(id(), SIGKILL);
  return lost();
}

bool Supervisor::was_lost() {
  return std::exchange(lost_, false);
}

Supervisor::End Supervisor::bury() {
  End verdict;
  const pid_t process = id();
  const ProcessEnd end = process_->end();
  ++counts_.ended;
  verdict.own_fault = std::exchange(misbehaved_, false) || is_its_own_fault(end);
  if (verdict.own_fault) {
    const std::vector<BoardBlock> quarantined = blame_.worker_ended(board().loading());
    counts_.quarantined += quarantined.size();
    verdict.blocks_blamed = !quarantined.empty();
    for (const BoardBlock& block : quarantined) {
      spdlog::error("block {} has ended two {}s, and is not loaded any more", block.block, start_.name);
    }
  }
  spdlog::error("{} {} has ended: {}{}", start_.name, process, text_of(end),
                end.exit_code == kGpuWasReset ? ", the GPU was reset" : "");
  process_.reset();
  return verdict;
}

}  // namespace surfcast::worker
