#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "base/result.h"
#include "cmd/scan_cache.h"
#include "model/model_file.h"
#include "service/model_catalogue.h"

namespace surfcast::cmd {

/// Progress of a build, and whether it is still wanted.
struct BuildWatch {
  const std::atomic<bool>& cancelled;
  std::function<void(double done, double seconds_left)> progress;
};

/// A model of a part of a scan's points, or of every few samples of a grid.
struct ScanPreview {
  std::shared_ptr<const model::ModelFile> model;
  uint64_t points_in_scan = 0;
};

/// Makes models of scans. `find` may run beside the other two, which run one at a time. All return kCancelled soon
/// after they are cancelled.
class ScanBuilder {
 public:
  virtual ~ScanBuilder() = default;
  virtual Result<CacheSlot> find(const std::filesystem::path& scan, const std::atomic<bool>& cancelled) = 0;
  virtual Result<ScanPreview> preview(const std::filesystem::path& scan, uint64_t points, const BuildWatch& watch) = 0;
  virtual Result<CachedModel> build(const std::filesystem::path& scan, const std::filesystem::path& target,
                                    const BuildWatch& watch) = 0;
};

/// Which previews are made.
struct PreviewRule {
  uint64_t points = 250'000;                 ///< of the first one; 0: none are made
  uint64_t least_bytes = uint64_t{4} << 20;  ///< of a scan's files; smaller ones are built at once
};

/// What is known of a scan while it is not complete.
struct ScanWork {
  uint64_t bytes = 0;            ///< of its files
  uint64_t points = 0;           ///< or samples, or Gaussians; 0: not known yet
  uint64_t preview_points = 0;   ///< of the last preview; 0: none
  bool previews_failed = false;  ///< building tells why
  bool looked_up = false;        ///< the cache does not have the model
  bool ended = false;            ///< complete or failed
};

/// What to do next: a preview of a scan, or its model.
struct BuildTask {
  size_t scan = 0;
  uint64_t preview_points = 0;  ///< 0: the model
};

/// First previews come first, in the order of the scans, so that there is soon something of every scan. Then the scans
/// are completed one after another. Each further preview has four times the points of the one before, as long as that
/// is at most an eighth of all: all previews together take at most a sixth of the time of the build. None: nothing can
/// be done yet.
std::optional<BuildTask> next_task(std::span<const ScanWork> scans, const PreviewRule& rule);

/// Builds the models of scans one after another in the background and publishes them, with previews until they are
/// complete. A scan that cannot be built is listed with the reason.
class ScanBuilds {
 public:
  /// The catalogue must outlive this object.
  ScanBuilds(service::ModelCatalogue& models, std::unique_ptr<ScanBuilder> builder, const PreviewRule& rule);
  /// Cancels what is being built.
  ~ScanBuilds();
  ScanBuilds(const ScanBuilds&) = delete;
  ScanBuilds& operator=(const ScanBuilds&) = delete;

  /// Serves a scan under its file's name without the extension. False if another model has that name. Any thread.
  [[nodiscard]] bool add(const std::filesystem::path& scan);

 private:
  struct Scan {
    std::filesystem::path path;
    std::string name;
    std::filesystem::path target;  ///< of the model in the cache, once it was looked up
  };

  void look_up_all();
  void build_all();
  void look_up(size_t scan);
  void run(const BuildTask& task);
  void make_preview(const BuildTask& task, const BuildWatch& watch);
  void make_model(size_t scan, const BuildWatch& watch);
  void complete(size_t scan, CachedModel model);
  void fail_scan(size_t scan, const Error& error);
  void end(size_t scan);
  void note_progress(size_t scan, double done, double seconds_left);
  [[nodiscard]] std::optional<BuildTask> wait_for_task();
  [[nodiscard]] Scan scan_at(size_t scan);

  service::ModelCatalogue& models_;
  const std::unique_ptr<ScanBuilder> builder_;
  const PreviewRule rule_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Scan> scans_;
  std::vector<ScanWork> works_;  ///< of the scans
  size_t looked_up_ = 0;         ///< scans whose models were looked for in the cache
  bool stopping_ = false;
  std::optional<size_t> current_;  ///< the scan that is worked on
  std::atomic<bool> stop_{false};
  std::atomic<bool> cancelled_{false};  ///< what is worked on is not wanted any more
  int logged_tenths_ = 0;

  std::jthread finder_;
  std::jthread builds_;
};

}  // namespace surfcast::cmd
