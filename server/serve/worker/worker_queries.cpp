#include "worker/worker_queries.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <type_traits>
#include <utility>

#include "base/log.h"
#include "base/stopwatch.h"
#include "worker/blame.h"
#include "worker/messages.h"

namespace surfcast::worker {
namespace {

using ModelPointer = service::ModelQueries::ModelPointer;

/// What was made of a message.
enum class Taken { kMore, kWhole, kNonsense };

/// Models that a query worker holds open.
constexpr size_t kMaxModels = 64;

/// Numbers of streams of points that nobody wants any more, of which their worker has not been told. Thread-safe.
class ClosedStreams {
 public:
  void add(uint64_t stream) {
    const std::lock_guard lock(mutex_);
    streams_.push_back(stream);
  }
  std::vector<uint64_t> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(streams_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<uint64_t> streams_;
};

/// A query worker. Used by one thread at a time.
class QueryProcess {
 public:
  QueryProcess(const QueryWorkerConfig& config, size_t block_bytes, WorkerCounts& counts, Blame& blame)
      : silence_(config.silence), worker_(start_of(config, block_bytes), counts, blame) {}

  Status start() {
    if (worker_.running()) return {};
    if (Status started = worker_.start(); !started) return started;
    spdlog::info("query worker {} answers", worker_.id());
    return {};
  }
  /// While nothing is asked: closes what the server has closed, and replaces a worker that has ended.
  void tend() {
    if (!worker_.running()) return;
    static_cast<void>(prepare(nullptr));  // what cannot be sent is noticed below
    worker_.withdraw_unused(kMaxModels);
    // It says nothing unless it is asked: what there is to receive is its end.
    const Result<std::optional<Received>> received = worker_.channel().receive(std::chrono::milliseconds(0));
    if (received && !received->has_value()) return;
    static_cast<void>(received ? worker_.misbehaved("is not understood") : worker_.lost());
    if (worker_.was_lost()) worker_.bury();
    if (const Status started = start(); !started) spdlog::error("{}", started.error().message);
  }
  [[nodiscard]] uint64_t generation() const { return worker_.generation(); }
  [[nodiscard]] const std::shared_ptr<ClosedStreams>& closed_streams() const { return closed_; }

  /// Asks, and asks another worker if this one ends. `take(message, answer)` makes an answer of the messages, and says
  /// what they are.
  template <typename Answer, typename Take>
  Result<Answer> ask(const ModelPointer& model, const Message& question, const std::atomic<bool>& cancelled,
                     const Take& take) {
    if (Status passable = check_passable(*model); !passable) return fail(passable);
    for (Attempts attempts; !attempts.exhausted();) {
      if (Status started = start(); !started) return fail(started);
      Supervisor::End end;
      Result<Answer> answer = ask_once<Answer>(model, question, cancelled, take, &end);
      if (answer || worker_.running()) return answer;
      attempts.ended(end.own_fault, end.blocks_blamed);
      if (cancelled) return fail(ErrorKind::kCancelled, "cancelled: the client no longer needs it");
    }
    return fail(ErrorKind::kUnavailable, "the question has ended every query worker that was to answer it");
  }

  /// Asks the worker that runs. There is none any more if it ends: `end` says how.
  template <typename Answer, typename Take>
  Result<Answer> ask_once(const ModelPointer& model, const Message& question, const std::atomic<bool>& cancelled,
                          const Take& take, Supervisor::End* end = nullptr) {
    Answer answer{};
    Status answered = exchange(model, question, cancelled, [&](Message& message) { return take(message, answer); });
    if (worker_.was_lost()) {
      const Supervisor::End verdict = worker_.bury();
      if (end != nullptr) *end = verdict;
    }
    if (!answered) return fail(answered);
    return answer;
  }

 private:
  static WorkerStart start_of(const QueryWorkerConfig& config, size_t block_bytes) {
    return {"query worker",
            config.command,
            {},
            0,
            ConfigureQueries{config.log_format, config.sandbox, config.readable, block_bytes, config.memory}};
  }

  /// Tells the worker what it has to know before a question. `model` may be null.
  Status prepare(const ModelPointer& model) {
    for (const uint64_t stream : closed_->take()) {
      if (Status sent = worker_.channel().send(ClosePoints{stream}); !sent) return sent;
    }
    if (!model) return {};
    Status offered = worker_.offer(model);
    worker_.withdraw_unused(kMaxModels);
    return offered;
  }

  /// An error of the supervisor, which notes that, if the worker has ended meanwhile.
  Status exchange(const ModelPointer& model, const Message& question, const std::atomic<bool>& cancelled,
                  const std::function<Taken(Message&)>& take) {
    constexpr std::chrono::milliseconds kLookUp{5};  // how often a cancellation is passed on
    const SharedBoard& board = worker_.board();
    board.cancelled(0) = cancelled.load();
    uint64_t progress = board.progress();
    if (!prepare(model) || !worker_.channel().send(question)) return worker_.lost();
    for (Stopwatch silence;;) {
      Result<std::optional<Received>> received = worker_.channel().receive(kLookUp);
      if (!received) {
        return received.error().kind == ErrorKind::kIo ? worker_.lost() : worker_.misbehaved("is not understood");
      }
      if (!received->has_value()) {
        board.cancelled(0) = cancelled.load();
        // A worker that goes on with what nobody wants is taken for hung, too.
        if (std::exchange(progress, board.progress()) != progress && !cancelled) silence = Stopwatch();
        if (silence.milliseconds() > static_cast<double>(silence_.count())) return worker_.misbehaved("hangs");
        continue;
      }
      silence = Stopwatch();
      if (auto* const refused = std::get_if<Refused>(&(*received)->message)) {
        return fail(checked(std::move(refused->error)));
      }
      const Taken taken = take((*received)->message);
      if (taken == Taken::kWhole) return {};
      if (taken == Taken::kNonsense) return worker_.misbehaved("is not understood");
    }
  }

  const std::chrono::milliseconds silence_;
  Supervisor worker_;
  std::shared_ptr<ClosedStreams> closed_ = std::make_shared<ClosedStreams>();
};

/// Query workers of one purpose. Thread-safe.
class QueryProcesses {
 public:
  /// Together they keep `block_bytes`.
  QueryProcesses(const QueryWorkerConfig& config, size_t count, size_t block_bytes, WorkerCounts& counts,
                 Blame& blame) {
    for (size_t i = 0; i < count; ++i) {
      places_.push_back({std::make_unique<QueryProcess>(config, block_bytes / count, counts, blame)});
    }
  }

  /// Uses the first one that is idle. Those that are seldom needed are started late, and the blocks that one question
  /// after the other needs are found in the same process.
  template <typename Use>
  auto with(const Use& use) {
    const std::unique_ptr<Place, std::function<void(Place*)>> place(take(),
                                                                    [this](Place* taken) { give_back(*taken); });
    return use(*place->process);
  }

  /// See QueryProcess::tend.
  void tend() {
    for (Place& place : places_) {
      if (!take(place)) continue;
      place.process->tend();
      give_back(place);
    }
  }

 private:
  struct Place {
    std::unique_ptr<QueryProcess> process;
    bool busy = false;
  };

  Place* take() {
    std::unique_lock lock(mutex_);
    auto idle = places_.end();
    freed_.wait(lock, [&] { return (idle = std::ranges::find(places_, false, &Place::busy)) != places_.end(); });
    idle->busy = true;
    return &*idle;
  }
  /// False if it is busy.
  bool take(Place& place) {
    const std::lock_guard lock(mutex_);
    return !std::exchange(place.busy, true);
  }
  void give_back(Place& place) {
    {
      const std::lock_guard lock(mutex_);
      place.busy = false;
    }
    freed_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable freed_;
  std::vector<Place> places_;  ///< constant but for `busy`
};

/// Takes an answer that is one message.
template <typename OfMessage>
Taken take_one(Message& message, OfMessage& answer) {
  auto* const found = std::get_if<OfMessage>(&message);
  if (found == nullptr) return Taken::kNonsense;
  answer = std::move(*found);
  return Taken::kWhole;
}

bool is_finite(const glm::dvec3& vector) {
  return std::isfinite(vector.x) && std::isfinite(vector.y) && std::isfinite(vector.z);
}

/// Whether a file of points on this lattice can be written, see surfel::Grid::index.
bool lies_on(const surfel::Grid& grid, const glm::dvec3& position) {
  constexpr double kMaxSteps = 0x1p62;
  if (!is_finite(position)) return false;
  const glm::dvec3 steps = glm::abs((position - grid.offset) / grid.scale);
  return steps.x < kMaxSteps && steps.y < kMaxSteps && steps.z < kMaxSteps;
}

/// Adds a part to a band of at most so many points. False if a well-behaved worker does not say so.
bool add_part(BandPart part, size_t most, size_t attributes, pick::Band& band) {
  const surfel::Grid& grid = part.grid;
  const bool ordered = grid.scale.x > 0 && grid.scale.y > 0 && grid.scale.z > 0 && is_finite(grid.scale) &&
                       is_finite(grid.offset) && std::isfinite(part.length);
  const bool counted = band.points.size() + part.points.size() <= most && (part.last || !part.points.empty()) &&
                       part.values.size() == part.points.size() * attributes;
  const auto fits = [&](const pick::BandPoint& point) {
    return lies_on(grid, point.position) && std::isfinite(point.place.along) && std::isfinite(point.place.across);
  };
  if (!ordered || !counted || !std::ranges::all_of(part.points, fits)) return false;
  band.total = part.total;
  band.length = part.length;
  band.grid = grid;
  band.points.insert(band.points.end(), part.points.begin(), part.points.end());
  band.values.insert(band.values.end(), part.values.begin(), part.values.end());
  return true;
}

/// The pixels of the regions that have come.
struct Surface {
  std::vector<pick::FrontPixel> pixels;
  size_t regions = 0;
};

/// Adds the pixels of the next region. False if they are not as many as it has.
bool add_region(const SurfacePart& part, const pick::SurfaceRegion& region, int width, Surface& surface) {
  static_assert(std::is_trivially_copyable_v<pick::FrontPixel>);
  const size_t count = static_cast<size_t>(region.size().x) * static_cast<size_t>(region.size().y);
  if (part.pixels.size() != count * sizeof(pick::FrontPixel)) return false;
  std::vector<pick::FrontPixel> pixels(count);
  std::memcpy(pixels.data(), part.pixels.data(), part.pixels.size());
  pick::place_region(region, pixels, width, surface.pixels);
  ++surface.regions;
  return true;
}

/// The points of a region, which a query worker reads.
class WorkerPointStream : public service::PointStream {
 public:
  /// `processes`: outlives all uses but the destruction.
  WorkerPointStream(QueryProcesses& processes, const QueryProcess& process, uint64_t number, uint64_t most,
                    std::shared_ptr<const std::atomic<bool>> cancelled)
      : PointStream(most),
        processes_(processes),
        closed_(process.closed_streams()),
        generation_(process.generation()),
        number_(number),
        cancelled_(std::move(cancelled)) {}
  ~WorkerPointStream() override { closed_->add(number_); }

  Result<bool> count() override {
    return ask<PointsCounted>(CountPoints{number_}).map([this](const PointsCounted& counted) {
      facts_ = counted.facts;
      return counted.whole;
    });
  }

  Result<service::PointPiece> next(size_t bytes) override {
    Result<PointsPiece> made = ask<PointsPiece>(NextPiece{number_, bytes});
    if (!made) return fail(made);
    return std::move(made->piece);
  }

  [[nodiscard]] const exporter::PointFacts& facts() const override { return facts_; }

 private:
  template <typename Answer>
  Result<Answer> ask(const Message& question) {
    return processes_.with([&](QueryProcess& process) -> Result<Answer> {
      if (process.generation() != generation_) {
        return fail(ErrorKind::kUnavailable, "the query worker that read these points has ended");
      }
      return process.ask_once<Answer>(nullptr, question, *cancelled_, take_one<Answer>);
    });
  }

  QueryProcesses& processes_;
  const std::shared_ptr<ClosedStreams> closed_;
  const uint64_t generation_;
  const uint64_t number_;
  const std::shared_ptr<const std::atomic<bool>> cancelled_;
  exporter::PointFacts facts_;
};

class WorkerQueries : public service::ModelQueries {
 public:
  WorkerQueries(const QueryWorkerConfig& config, WorkerCounts& counts)
      : picks_(config, config.limits.threads, config.limits.block_bytes, counts, blame_),
        searches_(config, 1, config.limits.block_bytes, counts, blame_),
        keeper_([this, pause = config.pause](const std::stop_token& stop) { keep(stop, pause); }) {}

  Status start() {
    return picks_.with([](QueryProcess& process) { return process.start(); });
  }

  Result<std::optional<kinds::PickedSurfel>> pick(const ModelPointer& model, const service::PixelQuery& query,
                                                  const std::atomic<bool>& cancelled) override {
    Result<Picked> picked = picks_.with([&](QueryProcess& process) {
      return process.ask<Picked>(model, Pick{model->id(), query}, cancelled, take_one<Picked>);
    });
    if (!picked) return fail(picked);
    return std::move(picked->item);
  }

  Result<std::vector<pick::FrontPixel>> front_surface(const ModelPointer& model, const service::SurfaceQuery& query,
                                                      const std::atomic<bool>& cancelled) override {
    const int width = query.request.width;
    const std::vector<pick::SurfaceRegion> regions = pick::surface_regions(width, query.request.height);
    const auto take = [&](Message& message, Surface& surface) {
      const auto* const part = std::get_if<SurfacePart>(&message);
      surface.pixels.resize(static_cast<size_t>(width) * static_cast<size_t>(query.request.height));
      if (part == nullptr || !add_region(*part, regions[surface.regions], width, surface)) return Taken::kNonsense;
      return surface.regions < regions.size() ? Taken::kMore : Taken::kWhole;
    };
    Result<Surface> surface = searches_.with([&](QueryProcess& process) {
      return process.ask<Surface>(model, SearchSurface{model->id(), query}, cancelled, take);
    });
    if (!surface) return fail(surface);
    return std::move(surface->pixels);
  }

  Result<pick::Band> band(const ModelPointer& model, const pick::BandQuery& query,
                          const std::atomic<bool>& cancelled) override {
    const auto take = [&](Message& message, pick::Band& band) {
      auto* const part = std::get_if<BandPart>(&message);
      if (part == nullptr) return Taken::kNonsense;
      const bool last = part->last;
      if (!add_part(std::move(*part), query.most, model->info().scalar_names.size(), band)) return Taken::kNonsense;
      return last ? Taken::kWhole : Taken::kMore;
    };
    return searches_.with([&](QueryProcess& process) {
      return process.ask<pick::Band>(model, FindBand{model->id(), query}, cancelled, take);
    });
  }

  Result<std::unique_ptr<service::PointStream>> points(const ModelPointer& model, const service::PointsQuery& query,
                                                       std::shared_ptr<const std::atomic<bool>> cancelled) override {
    return searches_.with([&](QueryProcess& process) -> Result<std::unique_ptr<service::PointStream>> {
      const uint64_t number = ++last_stream_;
      const Result<PointsCounted> opened = process.ask<PointsCounted>(model, OpenPoints{number, model->id(), query},
                                                                      *cancelled, take_one<PointsCounted>);
      if (!opened) return fail(opened);
      return std::make_unique<WorkerPointStream>(searches_, process, number, query.most, std::move(cancelled));
    });
  }

 private:
  void keep(const std::stop_token& stop, std::chrono::milliseconds pause) {
    std::mutex mutex;
    std::condition_variable_any stopped;
    std::unique_lock lock(mutex);
    while (!stopped.wait_for(lock, stop, pause, [&] { return stop.stop_requested(); })) {
      picks_.tend();
      searches_.tend();
    }
  }

  Blame blame_;
  std::atomic<uint64_t> last_stream_ = 0;
  QueryProcesses picks_;
  QueryProcesses searches_;  ///< one, because one thread asks
  std::jthread keeper_;      ///< looks after them while they are idle; the last member, so that it ends first
};

}  // namespace

Result<std::unique_ptr<service::ModelQueries>> worker_queries(const QueryWorkerConfig& config, WorkerCounts& counts) {
  auto queries = std::make_unique<WorkerQueries>(config, counts);
  if (Status started = queries->start(); !started) return fail(started);
  return queries;
}

}  // namespace surfcast::worker
