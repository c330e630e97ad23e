#include "cmd/scan_builds.h"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include "base/log.h"
#include "base/stopwatch.h"
#include "builder/input_files.h"
#include "service/model_name.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;
using State = service::ScanStatus::State;

constexpr uint64_t kRefinement = 4;   ///< points of a preview over those of the one before
constexpr uint64_t kLargestPart = 8;  ///< of the scan that a further preview may be: one in so many

bool wants_first_preview(const ScanWork& scan, const PreviewRule& rule) {
  return !scan.ended && !scan.previews_failed && scan.preview_points == 0 && rule.points > 0 &&
         scan.bytes >= rule.least_bytes;
}

/// Points of the next preview; 0: none is worth its time.
uint64_t further_preview(const ScanWork& scan) {
  const uint64_t points = kRefinement * scan.preview_points;
  return !scan.previews_failed && points <= scan.points / kLargestPart ? points : 0;
}

/// Points, samples and Gaussians of a model.
uint64_t items_of(const model::ModelFile& model) {
  uint64_t items = 0;
  for (const auto& kind : model.info().kinds) items += kind.items;
  return items;
}

}  // namespace

std::optional<BuildTask> next_task(std::span<const ScanWork> scans, const PreviewRule& rule) {
  for (size_t i = 0; i < scans.size(); ++i) {
    if (wants_first_preview(scans[i], rule)) return BuildTask{i, rule.points};
  }
  for (size_t i = 0; i < scans.size(); ++i) {
    if (scans[i].ended) continue;
    if (const uint64_t points = further_preview(scans[i]); points > 0) return BuildTask{i, points};
    if (scans[i].looked_up) return BuildTask{i, 0};
  }
  return std::nullopt;
}

ScanBuilds::ScanBuilds(service::ModelCatalogue& models, std::unique_ptr<ScanBuilder> builder, const PreviewRule& rule)
    : models_(models), builder_(std::move(builder)), rule_(rule), finder_([this] { look_up_all(); }), builds_([this] {
        build_all();
      }) {}

ScanBuilds::~ScanBuilds() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = stop_ = cancelled_ = true;
  }
  wake_.notify_all();
}

bool ScanBuilds::add(const fs::path& scan) {
  std::string name = service::model_name(scan);
  if (!models_.add_scan(name)) return false;
  const uint64_t bytes = builder::bytes_of_input(scan);
  {
    const std::lock_guard lock(mutex_);
    scans_.push_back({scan, std::move(name), {}});
    works_.push_back({.bytes = bytes});
  }
  wake_.notify_all();
  return true;
}

ScanBuilds::Scan ScanBuilds::scan_at(size_t scan) {
  const std::lock_guard lock(mutex_);
  return scans_[scan];
}

void ScanBuilds::look_up_all() {
  for (;;) {
    size_t scan = 0;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return stopping_ || looked_up_ < scans_.size(); });
      if (stopping_) return;
      scan = looked_up_++;
    }
    look_up(scan);
  }
}

void ScanBuilds::look_up(size_t scan) {
  Result<CacheSlot> slot = builder_->find(scan_at(scan).path, stop_);
  if (!slot) return fail_scan(scan, slot.error());
  if (slot->model) return complete(scan, std::move(*slot->model));
  {
    const std::lock_guard lock(mutex_);
    scans_[scan].target = std::move(slot->target);
    works_[scan].looked_up = true;
  }
  wake_.notify_all();
}

std::optional<BuildTask> ScanBuilds::wait_for_task() {
  std::unique_lock lock(mutex_);
  std::optional<BuildTask> task;
  wake_.wait(lock, [&] { return stopping_ || (task = next_task(works_, rule_)); });
  if (stopping_) return std::nullopt;
  current_ = task->scan;
  cancelled_ = false;
  return task;
}

void ScanBuilds::build_all() {
  while (const std::optional<BuildTask> task = wait_for_task()) {
    run(*task);
    const std::lock_guard lock(mutex_);
    current_.reset();
  }
}

void ScanBuilds::run(const BuildTask& task) {
  const BuildWatch watch{cancelled_,
                         [this, scan = task.scan, model = task.preview_points == 0](double done, double seconds_left) {
                           if (model) note_progress(scan, done, seconds_left);
                         }};
  logged_tenths_ = 0;
  if (task.preview_points > 0) return make_preview(task, watch);
  make_model(task.scan, watch);
}

void ScanBuilds::make_preview(const BuildTask& task, const BuildWatch& watch) {
  const Scan scan = scan_at(task.scan);
  models_.note({.model = scan.name, .state = State::kBuilding});
  const Stopwatch stopwatch;
  Result<ScanPreview> preview = builder_->preview(scan.path, task.preview_points, watch);
  if (!preview && preview.error().kind == ErrorKind::kCancelled) return;
  const std::lock_guard lock(mutex_);
  ScanWork& work = works_[task.scan];
  if (work.ended) return;  // the model was in the cache
  if (!preview) {
    work.previews_failed = true;
    return;
  }
  work.points = preview->points_in_scan;
  work.preview_points = task.preview_points;
  spdlog::info("{}: a preview of {} of {} items is served, after {:.1f} s", scan.path.string(),
               items_of(*preview->model), work.points, stopwatch.seconds());
  models_.publish(scan.name, {std::move(preview->model), true});
  models_.note({.model = scan.name});
}

void ScanBuilds::make_model(size_t scan, const BuildWatch& watch) {
  const Scan of = scan_at(scan);
  spdlog::info("{}: building a model of it", of.path.string());
  note_progress(scan, 0, 0);
  Result<CachedModel> model = builder_->build(of.path, of.target, watch);
  if (model) return complete(scan, std::move(*model));
  if (model.error().kind != ErrorKind::kCancelled) fail_scan(scan, model.error());
}

void ScanBuilds::note_progress(size_t scan, double done, double seconds_left) {
  const Scan of = scan_at(scan);
  models_.note({.model = of.name, .state = State::kBuilding, .done = done, .seconds_left = seconds_left});
  const int tenths = static_cast<int>(std::floor(10 * done));
  if (tenths <= logged_tenths_) return;
  logged_tenths_ = tenths;
  spdlog::info("{}: {} % built, {:.0f} s left", of.path.string(), 10 * tenths, seconds_left);
}

/// Publishes a model, and gives up a preview that is being made of it.
void ScanBuilds::complete(size_t scan, CachedModel model) {
  Result<model::ModelFile> opened = model::ModelFile::open(model.path);
  if (!opened) return fail_scan(scan, opened.error());
  end(scan);
  const Scan of = scan_at(scan);
  auto file = std::make_shared<const model::ModelFile>(std::move(*opened));
  spdlog::info("{}: the model is complete: {} items", of.path.string(), items_of(*file));
  models_.publish(of.name, {std::move(file), false, std::move(model.in_use)});
}

void ScanBuilds::fail_scan(size_t scan, const Error& error) {
  if (error.kind == ErrorKind::kCancelled) return;
  end(scan);
  const Scan of = scan_at(scan);
  spdlog::error("{}", error.message);
  models_.note({.model = of.name, .state = State::kFailed, .problem = error.message});
}

void ScanBuilds::end(size_t scan) {
  const std::lock_guard lock(mutex_);
  works_[scan].ended = true;
  if (current_ == scan) cancelled_ = true;
}

}  // namespace surfcast::cmd
