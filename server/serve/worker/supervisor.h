#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "model/model_file.h"
#include "worker/blame.h"
#include "worker/messages.h"
#include "worker/worker_process.h"

namespace surfcast::worker {

/// What is counted of workers. Thread-safe.
struct WorkerCounts {
  std::atomic<uint64_t> started = 0;
  std::atomic<uint64_t> ended = 0;        ///< crashed, killed or hung
  std::atomic<uint64_t> quarantined = 0;  ///< blocks that have ended two workers
};

/// How often something is begun before it fails.
class Attempts {
 public:
  /// The worker has ended in the middle of it. `own_fault`: see is_its_own_fault. `blocks_blamed`: it will not happen
  /// again for the same reason.
  void ended(bool own_fault, bool blocks_blamed) {
    ++ends_;
    if (own_fault && !blocks_blamed) ++faults_;
  }
  [[nodiscard]] bool exhausted() const { return faults_ >= kMaxFaults || ends_ >= kMaxEnds; }

 private:
  static constexpr int kMaxFaults = 2;
  static constexpr int kMaxEnds = 16;

  int faults_ = 0;
  int ends_ = 0;
};

/// What it takes to start a worker.
struct WorkerStart {
  std::string name;                      ///< in errors and in the log, like "render worker"
  std::vector<std::string> command;      ///< see WorkerProcess::start
  std::vector<std::string> environment;  ///< likewise
  size_t pixel_bytes = 0;                ///< likewise
  Message configure;                     ///< the first message
};

/// A worker process that is started again after it has ended, the models that it knows, and the blame for its ends.
/// Used by one thread at a time.
class Supervisor {
 public:
  /// `counts` and `blame` outlive it.
  Supervisor(WorkerStart start, WorkerCounts& counts, Blame& blame);

  /// Starts a worker, if there is none.
  Status start();
  [[nodiscard]] bool running() const { return process_.has_value(); }
  /// Counts the workers.
  [[nodiscard]] uint64_t generation() const { return generation_; }
  /// Of the one that runs.
  [[nodiscard]] Channel& channel() { return process_->channel(); }
  [[nodiscard]] const SharedBoard& board() const { return process_->board(); }
  [[nodiscard]] pid_t id() const { return process_->id(); }
  /// Its answer to the first message, also that of one that has ended.
  [[nodiscard]] const Ready& ready() const { return ready_; }

  /// Passes a model on that the worker does not know yet, of a joined one its members, too. All have to be files, see
  /// check_passable().
  Status offer(const std::shared_ptr<const model::ModelFile>& model);
  /// Withdraws a model that will not be used again, and forgets what it was blamed for.
  void withdraw(uint64_t model);
  /// Withdraws the models that nobody has open any more, and those that were used least recently beyond this number.
  void withdraw_unused(size_t most);

  /// The worker has ended: an error, and a note that it has.
  tl::unexpected<Error> lost();
  /// The same of a worker that is killed for what it does.
  tl::unexpected<Error> misbehaved(const char* how);
  /// Whether the worker was lost since the last call.
  bool was_lost();

  struct End {
    bool own_fault = true;
    bool blocks_blamed = false;
  };
  /// Ends what is left of the worker and finds what is to blame.
  End bury();

 private:
  struct Offered {
    std::weak_ptr<const model::ModelFile> model;
    uint64_t used = 0;  ///< the higher, the later
  };

  Status configure();
  Status offer_join(const model::ModelFile& model);
  tl::unexpected<Error> not_started(const std::string& why);

  const WorkerStart start_;
  WorkerCounts& counts_;
  Blame& blame_;
  std::optional<WorkerProcess> process_;
  uint64_t generation_ = 0;
  Ready ready_;
  bool lost_ = false;
  bool misbehaved_ = false;              ///< and was killed for that
  std::map<uint64_t, Offered> offered_;  ///< by ModelFile::id: the models that the worker knows
  uint64_t uses_ = 0;
};

/// Workers reach no network, so that models of stores cannot be passed on. kReplaced if this is one: it has taken the
/// place of a file of its name.
Status check_passable(const model::ModelFile& model);

}  // namespace surfcast::worker
