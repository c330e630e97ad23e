#include "service/local_point_stream.h"

#include <utility>

#include "base/stopwatch.h"

namespace surfcast::service {
namespace {

/// Of a thread that others wait for. Not a setting: only how the work is split depends on it.
constexpr double kTurnMilliseconds = 100;

}  // namespace

LocalPointStream::LocalPointStream(exporter::ModelPoints points, const PointsQuery& query,
                                   std::shared_ptr<const std::atomic<bool>> cancelled)
    : PointStream(query.most),
      points_(std::move(points)),
      format_(query.format),
      only_count_(query.only_count),
      wanted_(query.only_count ? exporter::WantedFacts::kNumber : exporter::facts_for(query.format)),
      cancelled_(std::move(cancelled)) {}

Result<std::unique_ptr<PointStream>> LocalPointStream::open(std::shared_ptr<const model::ModelFile> model,
                                                            const PointsQuery& query,
                                                            std::shared_ptr<const std::atomic<bool>> cancelled) {
  Result<exporter::ModelPoints> points = exporter::ModelPoints::open(std::move(model), query.model, query.selection);
  if (!points) return fail(points);
  return std::unique_ptr<PointStream>(new LocalPointStream(std::move(*points), query, std::move(cancelled)));
}

Status LocalPointStream::check() const {
  if (cancelled_->load(std::memory_order_relaxed)) return fail(ErrorKind::kCancelled, "cancelled");
  if (only_count_ || facts_.count <= most()) return {};
  return fail(ErrorKind::kLimit, "the region has more than " + std::to_string(most()) +
                                     " points, the most there may be: ask for a smaller one, or for every n-th point");
}

Result<bool> LocalPointStream::count() {
  const Stopwatch watch;
  while (counted_ < points_.pieces() && watch.milliseconds() < kTurnMilliseconds) {
    const Result<exporter::PointFacts> piece = points_.count(counted_, wanted_);
    if (!piece) return fail(piece);
    facts_.add(*piece);
    ++counted_;
    if (Status status = check(); !status) return fail(status);
  }
  if (counted_ < points_.pieces()) return false;
  return prepare().map([] { return true; });
}

Status LocalPointStream::prepare() {
  if (only_count_) return {};
  auto encoder = exporter::make_point_encoder(format_, points_.schema(), facts_);
  if (!encoder) return fail(encoder);
  encoder_ = std::move(*encoder);
  return {};
}

Status LocalPointStream::add_block(PointPiece& piece) {
  if (Status status = check(); !status) return status;
  const Result<scan::ScanPoints> points = points_.read(next_++);
  if (!points) return fail(points);
  if (points->size() == 0) return {};
  const Result<std::vector<std::byte>> rows = encoder_->rows(*points);
  if (!rows) return fail(rows);
  piece.bytes.insert(piece.bytes.end(), rows->begin(), rows->end());
  return {};
}

Result<PointPiece> LocalPointStream::next(size_t bytes) {
  const Stopwatch watch;
  PointPiece piece;
  Status status;
  if (!std::exchange(begun_, true)) piece.bytes = encoder_->head();
  while (status && next_ < points_.pieces() && piece.bytes.size() < bytes && watch.milliseconds() < kTurnMilliseconds) {
    status = add_block(piece);
  }
  if (!status) return fail(status);
  if (next_ < points_.pieces()) return piece;
  const std::vector<std::byte> tail = encoder_->tail();
  piece.bytes.insert(piece.bytes.end(), tail.begin(), tail.end());
  piece.last = true;
  return piece;
}

}  // namespace surfcast::service
