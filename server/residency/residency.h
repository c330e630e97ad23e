#pragma once

#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "base/preemption.h"
#include "base/stopwatch.h"
#include "residency/block_loader.h"
#include "residency/surfel_pool.h"
#include "selection/select_blocks.h"

namespace surfcast::residency {

/// A model that can be looked at: its blocks and their tree.
struct ViewedModel {
  explicit ViewedModel(std::shared_ptr<const BlockSource> blocks) : source(std::move(blocks)), tree(source->tree()) {}

  std::shared_ptr<const BlockSource> source;
  selection::SelectionTree tree;
};

/// What a picture shows of a model.
struct ViewParameters {
  geometry::CameraFrame frame;
  double spacing = 0;                    ///< see SelectionCriteria
  const geometry::Clip* clip = nullptr;  ///< likewise; outlives the preparation
  bool attributes = false;               ///< blocks are wanted with theirs
  bool moving = false;  ///< the next picture is soon to follow: storing blocks must not hold this one up
  std::optional<double> rest_spacing{};  ///< what `spacing` will be once the movement ends, if it does so here
};

/// The blocks that a picture is drawn from, and what getting them took.
struct PreparedView {
  selection::BlockSelection selection;
  uint32_t waited_for = 0;      ///< blocks that were wanted and not resident at first
  uint32_t missing = 0;         ///< blocks that are about to come
  bool nothing_pending = true;  ///< no block that it misses is about to come
  double select_ms = 0;
  double load_ms = 0;    ///< until the blocks were there
  double decode_ms = 0;  ///< time of the workers, all together, for blocks that arrived meanwhile
  double upload_ms = 0;
};

struct ResidencyLimits {
  uint32_t pages = 0;  ///< of SurfelPool::kPageSurfels, for all models together
  LoaderLimits loader;
  size_t upload_bytes = size_t{16} << 20;  ///< in a picture in motion: little enough not to be felt
};

/// Keeps the blocks of all models within their budgets, and decides what each picture is drawn from. The blocks that a
/// view was prepared of stay resident until the next one is. Used by the render thread.
class Residency {
 public:
  Residency(SurfelSink& sink, const ResidencyLimits& limits);

  /// For a picture as good as it gets: waits for every block of the cut. Only the budget limits it. Fails when a block
  /// is damaged, and with kCancelled soon after it is interrupted for good.
  Result<PreparedView> prepare_complete(const ViewedModel& model, const ViewParameters& parameters,
                                        const Preemption& preemption);

  /// For a picture at once: takes what is resident, and up to a limit what has been loaded since the last call; asks
  /// for what is missing, and after that for what `ahead` (where the camera is going) would miss. Never waits for a
  /// block. What is damaged is done without. What is missing of ViewParameters::rest_spacing is loaded in idle time.
  /// `was_refined`: see select_blocks.
  PreparedView prepare_resident(const ViewedModel& model, const ViewParameters& parameters,
                                std::span<const uint32_t> was_refined,
                                const std::optional<geometry::CameraFrame>& ahead);

  /// Between the two, views are prepared for pictures that interrupt another one, whose blocks stay resident, too.
  void begin_nested_frame() { pool_.begin_nested_frame(); }
  void end_nested_frame() { pool_.end_nested_frame(); }

  [[nodiscard]] const SurfelPool& pool() const { return pool_; }
  void release_model(uint64_t model);

 private:
  [[nodiscard]] std::vector<bool> residents(const ViewedModel& model, bool attributes) const;
  [[nodiscard]] selection::BlockSelection select(const ViewedModel& model, const ViewParameters& parameters,
                                                 std::span<const uint32_t> was_refined) const;
  [[nodiscard]] std::vector<uint32_t> missing(const ViewedModel& model, std::span<const uint32_t> blocks,
                                              bool attributes) const;
  [[nodiscard]] std::vector<uint32_t> coarse_roots(const ViewedModel& model) const;
  void add(const ViewedModel& model, std::span<const selection::WantedBlock> wanted,
           std::vector<uint32_t>& blocks) const;
  [[nodiscard]] static std::vector<selection::WantedBlock> blocks_to_load(const ViewParameters& parameters,
                                                                          const selection::BlockSelection& selection);
  [[nodiscard]] std::vector<uint32_t> load_requests(const ViewedModel& model, const ViewParameters& parameters,
                                                    const selection::BlockSelection& selection) const;
  void add_requests_ahead(const ViewedModel& model, const ViewParameters& parameters,
                          const selection::BlockSelection& selection, const geometry::CameraFrame& ahead,
                          std::vector<uint32_t>& blocks) const;
  void prefetch_rest(const ViewedModel& model, const ViewParameters& parameters);
  Status load(const ViewedModel& model, std::span<const uint32_t> blocks, bool attributes, const Preemption& preemption,
              PreparedView& view);
  bool store(const ViewedModel& model, const LoadedBlock& loaded, PreparedView& view);
  size_t upload_some(const ViewedModel& model, const ViewParameters& parameters, PreparedView& view);
  void use(const ViewedModel& model, std::span<const uint32_t> blocks);
  void use(const ViewedModel& model, const selection::BlockSelection& selection);

  SurfelPool pool_;
  BlockLoader loader_;
  size_t upload_bytes_;
  std::set<BlockId> damaged_;
  std::optional<Stopwatch> since_prefetch_;  ///< since what a rest would miss was last looked for
};

}  // namespace surfcast::residency
