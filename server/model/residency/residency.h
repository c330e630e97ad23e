#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "base/preemption.h"
#include "base/stopwatch.h"
#include "residency/block_loader.h"
#include "residency/block_pool.h"
#include "selection/select_blocks.h"

namespace surfcast::residency {

/// A model with the data that its views share: its blocks and the tree for selection.
struct ViewedModel {
  explicit ViewedModel(std::shared_ptr<const BlockSource> blocks) : source(std::move(blocks)), tree(source->tree()) {}

  std::shared_ptr<const BlockSource> source;
  selection::SelectionTree tree;
};

/// The parameters of a picture that determine which blocks it needs.
struct ViewParameters {
  geometry::CameraFrame frame;
  double spacing = 0;                    ///< see SelectionCriteria
  const geometry::Clip* clip = nullptr;  ///< see SelectionCriteria; outlives the preparation
  bool attributes = false;               ///< blocks are needed with their attributes
  bool moving = false;  ///< another picture follows soon, so the upload of blocks must not delay this one
  const std::vector<bool>* hidden = nullptr;  ///< see SelectionCriteria; outlives the preparation
  std::optional<double> rest_spacing{};       ///< value of `spacing` at rest, if the camera stops here
  selection::Sides sides = selection::Sides::kFront;
  std::optional<double> ghost_spacing{};         ///< see SelectionCriteria
  const std::vector<double>* reaches = nullptr;  ///< see SelectionCriteria; outlives the preparation
  /// See SelectionCriteria; outlives the preparation. A picture at rest has no limit.
  const std::vector<uint32_t>* items = nullptr;
  uint64_t most_items = std::numeric_limits<uint64_t>::max();
  std::optional<selection::Window> window{};       ///< see SelectionCriteria
  const std::vector<uint32_t>* roots = nullptr;    ///< see SelectionCriteria; outlives the preparation
  const selection::Visibility* visible = nullptr;  ///< see SelectionCriteria; outlives the preparation
  /// A picture that is prepared instead.
  struct Survey {
    double surfels = 0;  ///< if more of them would be drawn
    double spacing = 0;  ///< see SelectionCriteria
  };
  std::optional<Survey> survey{};  ///< of a view in motion: of the picture at rest
};

/// The blocks that a picture is drawn from, and the cost of making them resident.
struct PreparedView {
  selection::BlockSelection selection;
  uint32_t waited_for = 0;      ///< requested blocks that were not resident at first
  uint32_t missing = 0;         ///< requested blocks that are not resident yet
  bool nothing_pending = true;  ///< no missing block is still to be loaded
  bool survey = false;          ///< of the spacing of ViewParameters::survey
  double select_ms = 0;
  double load_ms = 0;    ///< waiting for blocks
  double decode_ms = 0;  ///< total time of the worker threads for blocks that arrived meanwhile
  double upload_ms = 0;
};

struct ResidencyLimits {
  uint32_t pages = 0;  ///< of BlockPool::kPageTexels, for all models together
  LoaderLimits loader;
  size_t upload_bytes = size_t{16} << 20;  ///< per picture in motion: small enough not to delay it noticeably
};

/// Keeps the blocks of all models within their memory budgets and chooses the blocks of each picture. The blocks of a
/// view stay resident until the next view is prepared. Used by the render thread.
class Residency {
 public:
  /// `guard`, if any, must outlive this object.
  Residency(TexelSink& sink, const ResidencyLimits& limits, LoadGuard* guard = nullptr);

  /// Prepares a picture of full quality: waits for every block of the cut, which only the budget limits. Fails if a
  /// block is damaged, and with kCancelled soon after it is cancelled.
  Result<PreparedView> prepare_complete(const ViewedModel& model, const ViewParameters& parameters,
                                        const Preemption& preemption);

  /// Prepares a picture without waiting for blocks. Uses the resident blocks and uploads, up to a limit, those that
  /// were loaded since the last call. Requests the missing blocks, then those that the camera frame `ahead`, where the
  /// camera is moving to, would miss. Prefetches the missing blocks of ViewParameters::rest_spacing in idle time.
  /// Leaves out damaged blocks. `was_refined`: see select_blocks.
  PreparedView prepare_resident(const ViewedModel& model, const ViewParameters& parameters,
                                std::span<const uint32_t> was_refined,
                                const std::optional<geometry::CameraFrame>& ahead);

  /// Views prepared between these two calls belong to pictures that preempt another one, whose blocks stay resident.
  void begin_nested_frame() { pool_.begin_nested_frame(); }
  void end_nested_frame() { pool_.end_nested_frame(); }

  /// A block as it is drawn. One that is not in host memory is loaded again.
  [[nodiscard]] Result<std::shared_ptr<const PackedBlock>> packed(const ViewedModel& model, uint32_t block,
                                                                  bool attributes);

  [[nodiscard]] const BlockPool& pool() const { return pool_; }
  void release_model(uint64_t model);

 private:
  [[nodiscard]] std::vector<bool> residents(const ViewedModel& model, bool attributes) const;
  [[nodiscard]] selection::BlockSelection select(const ViewedModel& model, const ViewParameters& parameters,
                                                 std::span<const uint32_t> was_refined) const;
  [[nodiscard]] selection::BlockSelection select_or_survey(const ViewedModel& model, ViewParameters& parameters,
                                                           std::span<const uint32_t> was_refined,
                                                           PreparedView& view) const;
  [[nodiscard]] std::vector<uint32_t> missing(const ViewedModel& model, std::span<const uint32_t> blocks,
                                              bool attributes) const;
  [[nodiscard]] std::vector<uint32_t> coarse_roots(const ViewedModel& model, const ViewParameters& parameters) const;
  void add(const ViewedModel& model, std::span<const selection::WantedBlock> wanted,
           std::vector<uint32_t>& blocks) const;
  [[nodiscard]] static std::vector<selection::WantedBlock> blocks_to_load(const ViewParameters& parameters,
                                                                          const selection::BlockSelection& selection);
  [[nodiscard]] std::vector<uint32_t> load_requests(const ViewedModel& model, const ViewParameters& parameters,
                                                    const selection::BlockSelection& selection) const;
  void add_requests_ahead(const ViewedModel& model, const ViewParameters& parameters,
                          const selection::BlockSelection& selection, const geometry::CameraFrame& ahead,
                          std::vector<uint32_t>& blocks) const;
  void request(const ViewedModel& model, std::span<const uint32_t> blocks, const ViewParameters& parameters);
  void prefetch_rest(const ViewedModel& model, const ViewParameters& parameters);
  Status load(const ViewedModel& model, std::span<const uint32_t> blocks, bool attributes, const Preemption& preemption,
              PreparedView& view);
  bool store(const ViewedModel& model, const LoadedBlock& loaded, PreparedView& view);
  size_t upload_some(const ViewedModel& model, const ViewParameters& parameters, PreparedView& view);
  void use(const ViewedModel& model, std::span<const uint32_t> blocks);
  void use(const ViewedModel& model, const selection::BlockSelection& selection);

  BlockPool pool_;
  BlockLoader loader_;
  size_t upload_bytes_;
  std::optional<uint64_t> requested_model_;  ///< whose blocks were requested last
  std::set<BlockId> damaged_;
  std::optional<Stopwatch> since_prefetch_;  ///< since the last selection of blocks for rest
};

}  // namespace surfcast::residency
