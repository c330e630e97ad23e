#include "residency/residency.h"

#include <algorithm>

namespace surfcast::residency {
namespace {

/// About how many surfels of these blocks are drawn. Blocks that are finer than the picture's spacing are drawn with
/// the surfels that they are merged to.
double surfels_at_spacing(const ViewedModel& model, const ViewParameters& parameters,
                          std::span<const uint32_t> blocks) {
  double surfels = 0;
  for (const uint32_t number : blocks) {
    const ldc::BlockEntry& block = model.tree.tree.blocks()[number];
    const double ratio = selection::projected_spacing(block, parameters.frame) / parameters.spacing;
    surfels += block.items * std::min(1.0, ratio * ratio);
  }
  return surfels;
}

}  // namespace

Residency::Residency(TexelSink& sink, const ResidencyLimits& limits, LoadGuard* guard)
    : pool_(limits.pages, sink), loader_(limits.loader, guard), upload_bytes_(limits.upload_bytes) {}

void Residency::release_model(uint64_t model) {
  pool_.release_model(model);
  loader_.release_model(model);
  damaged_.erase(damaged_.lower_bound({model, 0}), damaged_.lower_bound({model + 1, 0}));
}

std::vector<bool> Residency::residents(const ViewedModel& model, bool attributes) const {
  std::vector<bool> residents = pool_.residents(model.source->id(), attributes);
  residents.resize(model.tree.tree.blocks().size());
  return residents;
}

selection::BlockSelection Residency::select(const ViewedModel& model, const ViewParameters& parameters,
                                            std::span<const uint32_t> was_refined) const {
  const selection::SelectionCriteria limits{
      parameters.spacing, pool_.usable_surfels(),   BlockPool::kPageTexels, parameters.clip,  parameters.hidden,
      parameters.sides,   parameters.ghost_spacing, parameters.reaches,     parameters.items, parameters.most_items,
      parameters.window,  parameters.roots,         parameters.visible};
  return selection::select_blocks(model.tree, parameters.frame, limits, residents(model, parameters.attributes),
                                  was_refined);
}

/// Selects the blocks of a picture or of its survey; pictures in motion have none. `parameters` become those of what is
/// selected.
selection::BlockSelection Residency::select_or_survey(const ViewedModel& model, ViewParameters& parameters,
                                                      std::span<const uint32_t> was_refined, PreparedView& view) const {
  selection::BlockSelection selection = select(model, parameters, was_refined);
  if (!parameters.survey || parameters.moving) return selection;
  if (surfels_at_spacing(model, parameters, selection.target) <= parameters.survey->surfels) return selection;
  view.survey = true;
  parameters.spacing = parameters.survey->spacing;
  return select(model, parameters, was_refined);
}

std::vector<uint32_t> Residency::missing(const ViewedModel& model, std::span<const uint32_t> blocks,
                                         bool attributes) const {
  const std::vector<bool> here = residents(model, attributes);
  std::vector<uint32_t> missing;
  std::copy_if(blocks.begin(), blocks.end(), std::back_inserter(missing), [&](uint32_t block) { return !here[block]; });
  return missing;
}

/// The roots that have children: they represent everything that may show while no finer block is resident.
std::vector<uint32_t> Residency::coarse_roots(const ViewedModel& model, const ViewParameters& parameters) const {
  std::vector<uint32_t> coarse;
  const std::span<const uint32_t> all = model.tree.tree.roots();
  for (const uint32_t root : parameters.roots == nullptr ? all : std::span<const uint32_t>(*parameters.roots)) {
    if (parameters.hidden != nullptr && (*parameters.hidden)[root]) continue;
    if (model.tree.tree.children(root).count > 0) coarse.push_back(root);
  }
  return coarse;
}

void Residency::use(const ViewedModel& model, std::span<const uint32_t> blocks) {
  for (const uint32_t block : blocks) pool_.use({model.source->id(), block});
}

/// Marks the blocks that are drawn, those that will be drawn, and the coarser ones that may replace them.
void Residency::use(const ViewedModel& model, const selection::BlockSelection& selection) {
  use(model, selection.refined);
  use(model, selection.target);
  use(model, selection.draw);
}

bool Residency::store(const ViewedModel& model, const LoadedBlock& loaded, PreparedView& view) {
  const Stopwatch watch;
  const ldc::BlockTree& tree = model.tree.tree;
  const bool stored = pool_.store(loaded.id, tree, **loaded.block);
  const bool root = tree.blocks()[loaded.id.block].parent == ldc::BlockEntry::kNoParent;
  if (stored && root && tree.children(loaded.id.block).count > 0) pool_.pin(loaded.id.without_attributes());
  view.upload_ms += watch.milliseconds();
  return stored;
}

/// Loads and stores blocks that are not resident. Stops early if blocks in use fill the pool.
Status Residency::load(const ViewedModel& model, std::span<const uint32_t> blocks, bool attributes,
                       const Preemption& preemption, PreparedView& view) {
  constexpr std::chrono::milliseconds kPollInterval{4};  // between two checks for more urgent work
  const WorkStopwatch watch(preemption);
  const auto give_up = [&] { loader_.set_requests(model.source, {}); };
  loader_.set_requests(model.source, blocks, attributes);
  for (size_t left = blocks.size(); left > 0;) {
    if (preemption.cancelled()) {
      give_up();
      return fail(ErrorKind::kCancelled, "cancelled");
    }
    if (preemption.yield_to_urgent()) {
      // A nested frame may have replaced the requests and stored some of these blocks.
      const std::vector<uint32_t> still = missing(model, blocks, attributes);
      loader_.set_requests(model.source, still, attributes);
      left = still.size();
      continue;
    }
    const std::optional<LoadedBlock> loaded = loader_.take();
    if (!loaded) {
      loader_.wait(kPollInterval);
      continue;
    }
    --left;
    view.decode_ms += loaded->milliseconds;
    if (!loaded->block || !store(model, *loaded, view)) {
      give_up();
      if (!loaded->block) return fail(loaded->block);
      break;
    }
  }
  view.load_ms += watch.milliseconds();
  return {};
}

Result<PreparedView> Residency::prepare_complete(const ViewedModel& model, const ViewParameters& parameters,
                                                 const Preemption& preemption) {
  PreparedView view;
  ViewParameters selected = parameters;
  pool_.begin_frame();
  const std::vector<uint32_t> roots = missing(model, coarse_roots(model, parameters), parameters.attributes);
  if (Status status = load(model, roots, parameters.attributes, preemption, view); !status) return fail(status);

  const Stopwatch select_watch;
  view.selection = select_or_survey(model, selected, {}, view);
  view.select_ms = select_watch.milliseconds();
  use(model, view.selection.target);
  const std::vector<uint32_t> wanted = missing(model, view.selection.target, parameters.attributes);
  view.waited_for = static_cast<uint32_t>(roots.size() + wanted.size());
  if (Status status = load(model, wanted, parameters.attributes, preemption, view); !status) return fail(status);

  const Stopwatch draw_watch;
  if (!wanted.empty()) view.selection = select(model, selected, {});
  view.select_ms += draw_watch.milliseconds();
  return view;
}

Result<std::shared_ptr<const PackedBlock>> Residency::packed(const ViewedModel& model, uint32_t block,
                                                             bool attributes) {
  if (auto kept = loader_.find({model.source->id(), block, attributes})) return kept;
  return model.source->load(block, attributes).map([](PackedBlock&& loaded) {
    return std::make_shared<const PackedBlock>(std::move(loaded));
  });
}

/// Stores loaded blocks, up to the limit. Returns the number of blocks stored.
size_t Residency::upload_some(const ViewedModel& model, const ViewParameters& parameters, PreparedView& view) {
  constexpr double kMotionMs = 8;  // checked between blocks, so the last block may exceed it
  size_t stored = 0;
  for (size_t bytes = 0; !parameters.moving || bytes < upload_bytes_;) {
    if (parameters.moving && view.upload_ms > kMotionMs) break;
    const std::optional<LoadedBlock> loaded = loader_.take(model.source->id());
    if (!loaded) break;
    view.decode_ms += loaded->milliseconds;
    if (!loaded->block) {
      // A store that does not answer now may answer later: the next picture requests the block again.
      if (loaded->block.error().kind != ErrorKind::kUnavailable) damaged_.insert(loaded->id.without_attributes());
    } else if (store(model, *loaded, view)) {
      bytes += (*loaded->block)->bytes();
      ++stored;
    }
  }
  return stored;
}

/// Adds the requested blocks that are not damaged.
void Residency::add(const ViewedModel& model, std::span<const selection::WantedBlock> wanted,
                    std::vector<uint32_t>& blocks) const {
  for (const selection::WantedBlock& one : wanted) {
    if (!damaged_.contains({model.source->id(), one.block})) blocks.push_back(one.block);
  }
}

/// The missing blocks of a view. At rest only blocks of the target are loaded, because coarser substitutes would delay
/// them, unless the picture has holes.
std::vector<selection::WantedBlock> Residency::blocks_to_load(const ViewParameters& parameters,
                                                              const selection::BlockSelection& selection) {
  std::vector<selection::WantedBlock> wanted = selection.wanted;
  if (parameters.moving || selection.holes > 0) return wanted;
  std::erase_if(wanted, [&](const selection::WantedBlock& one) {
    return !std::ranges::binary_search(selection.target, one.block);
  });
  return wanted;
}

/// The blocks to load next: the roots, then the missing blocks of the view.
std::vector<uint32_t> Residency::load_requests(const ViewedModel& model, const ViewParameters& parameters,
                                               const selection::BlockSelection& selection) const {
  std::vector<uint32_t> blocks = missing(model, coarse_roots(model, parameters), parameters.attributes);
  std::erase_if(blocks, [&](uint32_t block) { return damaged_.contains({model.source->id(), block}); });
  add(model, blocks_to_load(parameters, selection), blocks);
  if (blocks.empty()) add(model, selection.wanted, blocks);  // substitutes for damaged blocks
  return blocks;
}

/// Adds the blocks that the view will miss when the camera reaches `ahead`.
void Residency::add_requests_ahead(const ViewedModel& model, const ViewParameters& parameters,
                                   const selection::BlockSelection& selection, const geometry::CameraFrame& ahead,
                                   std::vector<uint32_t>& blocks) const {
  ViewParameters ahead_parameters = parameters;
  ahead_parameters.frame = ahead;
  add(model, select(model, ahead_parameters, selection.refined).wanted, blocks);
}

/// Prefetches the blocks of the view at rest, or of its survey. The camera may stop at any time, and a view at rest
/// needs many more blocks than one in motion.
void Residency::prefetch_rest(const ViewedModel& model, const ViewParameters& parameters) {
  constexpr double kEveryMs = 150;  // minimum interval: the selection is too slow for every motion frame
  if (!parameters.rest_spacing) return loader_.prefetch(model.source, {}, parameters.attributes);
  if (since_prefetch_ && since_prefetch_->milliseconds() < kEveryMs) return;
  since_prefetch_ = Stopwatch();
  ViewParameters rest = parameters;
  rest.spacing = *parameters.rest_spacing;
  rest.moving = false;
  rest.items = nullptr;
  std::vector<uint32_t> blocks;
  PreparedView view;  // only the selection matters
  const selection::BlockSelection selection = select_or_survey(model, rest, {}, view);
  add(model, blocks_to_load(rest, selection), blocks);
  loader_.prefetch(model.source, blocks, parameters.attributes);
}

/// A picture that lacks nothing leaves the loading of other models going: a preview of a scan that of its model.
void Residency::request(const ViewedModel& model, std::span<const uint32_t> blocks, const ViewParameters& parameters) {
  // In motion the list changes before the loaders come to its end.
  constexpr size_t kAnnouncedInMotion = 64;
  if (blocks.empty() && requested_model_ != model.source->id()) return;
  loader_.set_requests(model.source, blocks, parameters.attributes,
                       parameters.moving ? kAnnouncedInMotion : BlockLoader::kAll);
  requested_model_ = model.source->id();
}

PreparedView Residency::prepare_resident(const ViewedModel& model, const ViewParameters& parameters,
                                         std::span<const uint32_t> was_refined,
                                         const std::optional<geometry::CameraFrame>& ahead) {
  PreparedView view;
  ViewParameters selected = parameters;
  pool_.begin_frame();
  const Stopwatch watch;
  view.selection = select_or_survey(model, selected, was_refined, view);
  view.waited_for = static_cast<uint32_t>(view.selection.wanted.size());
  use(model, view.selection);
  if (upload_some(model, parameters, view) > 0) {
    view.selection = select(model, selected, was_refined);
    use(model, view.selection);
  }
  std::vector<uint32_t> blocks = load_requests(model, selected, view.selection);
  view.nothing_pending = blocks.empty();
  view.missing = static_cast<uint32_t>(blocks.size());
  if (ahead) add_requests_ahead(model, parameters, view.selection, *ahead, blocks);
  request(model, blocks, parameters);
  prefetch_rest(model, parameters);
  view.select_ms = watch.milliseconds() - view.upload_ms;
  return view;
}

}  // namespace surfcast::residency
