#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/file_source.h"
#include "base/load_module.h"
#include "base/log_format.h"
#include "model/model_file.h"
#include "pick/front_surface.h"
#include "pick/source_blocks.h"
#include "service/guarded.h"
#include "service/local_queries.h"
#include "worker/block_watch.h"
#include "worker/channel.h"
#include "worker/offered_models.h"
#include "worker/run_worker.h"
#include "worker/worker_life.h"

namespace surfcast::worker {
namespace {

/// Bytes of a message with a part of an answer, about.
constexpr size_t kPartBytes = size_t{8} << 20;

/// PROJ, which is loaded where a file is wanted in the system of its source, and what it reads.
std::vector<std::string> system_paths() {
  std::vector<std::string> paths{
      "/usr", "/lib", "/lib64", "/etc/ld.so.cache", "/etc/localtime", module_folder().string()};
  for (const char* variable : {"PROJ_DATA", "PROJ_LIB"}) {
    if (const char* const path = std::getenv(variable); path != nullptr) paths.emplace_back(path);
  }
  return paths;
}

/// Points of a band in one message.
size_t points_of_part(size_t attributes) {
  return std::max<size_t>(1, kPartBytes / (sizeof(pick::BandPoint) + attributes * sizeof(double)));
}

/// The part of a band from this point on.
BandPart part_of(const pick::Band& band, size_t first, size_t attributes) {
  const size_t count = std::min(points_of_part(attributes), band.points.size() - first);
  const auto at = [](const auto& values, size_t index) { return values.begin() + static_cast<std::ptrdiff_t>(index); };
  BandPart part{band.total, band.length, band.grid, {}, {}};
  part.points.assign(at(band.points, first), at(band.points, first + count));
  part.values.assign(at(band.values, first * attributes), at(band.values, (first + count) * attributes));
  part.last = first + count == band.points.size();
  return part;
}

class QueryWorker {
 public:
  QueryWorker(Channel channel, SharedBoard board, kinds::KindTable kinds)
      : channel_(std::move(channel)), board_(std::move(board)), watch_(board_), kinds_(kinds) {}

  [[noreturn]] void run() {
    start();
    for (;;) {
      serve(next_message(channel_));
      watch_.ends();
    }
  }

 private:
  using ModelPointer = std::shared_ptr<const model::ModelFile>;

  /// Points of a region, and the bytes of their file that the last piece was too large for.
  struct Stream {
    std::unique_ptr<service::PointStream> points;
    service::PointPiece rest;
  };

  void start() {
    const Message first = next_message(channel_).message;
    const auto* const configure = std::get_if<ConfigureQueries>(&first);
    if (configure == nullptr) end_worker(EXIT_FAILURE);
    set_log_format(configure->log_format);
    if (const Status confined = confine(*configure); !confined) {
      answer(Refused{confined.error()});
      end_worker(EXIT_FAILURE);
    }
    limit_memory(configure->memory);
    queries_ = service::local_queries(configure->block_bytes, kinds_);
    searched_blocks_ = std::make_unique<pick::SourceBlocks>(configure->block_bytes, kinds_);
    answer(Ready{});
  }

  static Status confine(const ConfigureQueries& configure) {
    if (!configure.sandbox) return {};
    OpenFiles files{system_paths(), {}, /*devices=*/false};
    files.readable.insert(files.readable.end(), configure.readable.begin(), configure.readable.end());
    if (Status confined = confine_files(files); !confined) return confined;
    return confine_calls();
  }

  void answer(const Message& message) { answer_server(channel_, message); }

  /// What a question gives, or the error why it has no answer.
  template <typename Ask>
  void answer_with(const Ask& ask) {
    Result<Message> message = service::guarded(ask);
    if (!message) return answer(Refused{std::move(message.error())});
    answer(*message);
  }

  void serve(Received received) {
    const auto serve_one = [&](auto& message) { handle(message, received.descriptor); };
    std::visit(serve_one, received.message);
  }

  /// What a server does not send.
  template <typename Other>
  void handle(Other& /*message*/, Descriptor& /*descriptor*/) {
    end_worker(EXIT_FAILURE);
  }

  void handle(OfferModel& offer, Descriptor& descriptor) {
    models_[offer.model] = service::guarded([&] { return open(offer, std::move(descriptor)); });
  }
  void handle(OfferJoin& join, Descriptor& /*descriptor*/) { models_[join.model] = joined_model(join, models_); }
  void handle(WithdrawModel& withdraw, Descriptor& /*descriptor*/) { models_.erase(withdraw.model); }

  void handle(Pick& pick, Descriptor& /*descriptor*/) {
    answer_with([&]() -> Result<Message> {
      const Result<ModelPointer> model = model_of(pick.model);
      if (!model) return fail(model);
      auto picked = queries_->pick(*model, pick.query, board_.cancelled(0));
      if (!picked) return fail(picked);
      return Picked{std::move(*picked)};
    });
  }

  void handle(FindBand& find, Descriptor& /*descriptor*/) {
    answer_with([&]() -> Result<Message> {
      const Result<ModelPointer> model = model_of(find.model);
      if (!model) return fail(model);
      const Result<pick::Band> band = queries_->band(*model, find.query, board_.cancelled(0));
      if (!band) return fail(band);
      const size_t attributes = (*model)->info().scalar_names.size();
      BandPart part = part_of(*band, 0, attributes);
      for (size_t sent = 0; !part.last; part = part_of(*band, sent, attributes)) {
        sent += part.points.size();
        answer(part);
      }
      return part;
    });
  }

  /// The parts are sent as they are found, so that this process never holds more than one of them.
  void handle(SearchSurface& search, Descriptor& /*descriptor*/) {
    const auto send = [&](const pick::SurfaceRegion& /*region*/, std::span<const pick::FrontPixel> pixels) -> Status {
      const std::span<const std::byte> bytes = std::as_bytes(pixels);
      answer(SurfacePart{{bytes.begin(), bytes.end()}});
      return {};
    };
    const Status searched = service::guarded([&]() -> Status {
      const Result<ModelPointer> model = model_of(search.model);
      if (!model) return fail(model);
      const Result<kinds::PickQuery> query = service::query_of(**model, search.query);
      if (!query) return fail(query);
      return pick::search_front_surface(**model, *query, *searched_blocks_, board_.cancelled(0), send);
    });
    if (!searched) answer(Refused{searched.error()});
  }

  void handle(OpenPoints& open_points, Descriptor& /*descriptor*/) {
    answer_with([&]() -> Result<Message> {
      const Result<ModelPointer> model = model_of(open_points.model);
      if (!model) return fail(model);
      const std::shared_ptr<const std::atomic<bool>> cancelled(std::shared_ptr<void>(), &board_.cancelled(0));
      auto points = queries_->points(*model, open_points.query, cancelled);
      if (!points) return fail(points);
      const PointsCounted counted{(*points)->facts(), false};
      streams_[open_points.stream] = {std::move(*points), {}};
      return counted;
    });
  }
  void handle(CountPoints& count, Descriptor& /*descriptor*/) {
    answer_with([&]() -> Result<Message> {
      const auto found = streams_.find(count.stream);
      if (found == streams_.end()) end_worker(EXIT_FAILURE);
      const Result<bool> whole = found->second.points->count();
      if (!whole) return fail(whole);
      return PointsCounted{found->second.points->facts(), *whole};
    });
  }
  void handle(NextPiece& next, Descriptor& /*descriptor*/) {
    answer_with([&]() -> Result<Message> {
      const auto found = streams_.find(next.stream);
      if (found == streams_.end()) end_worker(EXIT_FAILURE);
      return piece_of(found->second, std::min<size_t>(next.bytes, kPartBytes));
    });
  }
  void handle(ClosePoints& close, Descriptor& /*descriptor*/) { streams_.erase(close.stream); }

  static Result<Message> piece_of(Stream& stream, size_t bytes) {
    service::PointPiece& rest = stream.rest;
    if (rest.bytes.empty() && !rest.last) {
      Result<service::PointPiece> made = stream.points->next(bytes);
      if (!made) return fail(made);
      rest = std::move(*made);
    }
    const auto end = rest.bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes, rest.bytes.size()));
    PointsPiece piece{{{rest.bytes.begin(), end}, false}};
    rest.bytes.erase(rest.bytes.begin(), end);
    piece.piece.last = rest.last && rest.bytes.empty();
    return piece;
  }

  Result<ModelPointer> open(const OfferModel& offer, Descriptor descriptor) {
    Result<PositionedFile> file = PositionedFile::adopt(descriptor.release(), offer.path);
    if (!file) return fail(file);
    auto watched = std::make_unique<WatchedFile>(FileSource(std::move(*file), offer.path), watch_);
    WatchedFile* const watching = watched.get();
    Result<model::ModelFile> model = model::ModelFile::open(std::move(watched));
    if (!model) return fail(model);
    watching->begin(offer.model, model->blocks(), offer.quarantined);
    return std::make_shared<const model::ModelFile>(std::move(*model));
  }

  [[nodiscard]] Result<ModelPointer> model_of(uint64_t number) const {
    const auto found = models_.find(number);
    if (found == models_.end()) end_worker(EXIT_FAILURE);
    return found->second;
  }

  Channel channel_;
  SharedBoard board_;
  BlockWatch watch_;
  const kinds::KindTable kinds_;
  std::unique_ptr<service::ModelQueries> queries_;
  std::unique_ptr<pick::SourceBlocks> searched_blocks_;
  OfferedModels models_;
  std::map<uint64_t, Stream> streams_;  ///< by the server's number
};

}  // namespace

void run_query_worker(Descriptor socket, Descriptor memory, kinds::KindTable kinds) {
  SharedBoard board = begin_worker(std::move(memory));
  QueryWorker(Channel(std::move(socket)), std::move(board), kinds).run();
}

}  // namespace surfcast::worker
