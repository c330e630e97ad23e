#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "builder/append_steps.h"
#include "builder/ordered_work.h"
#include "scan/merge_schemas.h"

namespace surfcast::builder {
namespace {

/// The rows of some points by the parts that need them. `own`: each of them belongs to a part, the nearest one where
/// rounding moved it out of all.
std::vector<PartRows> rows_by_part(const scan::ScanPoints& points, const BuildFrame& frame, bool own) {
  std::map<std::pair<uint32_t, bool>, std::vector<uint32_t>> rows;
  for (uint32_t i = 0; i < points.size(); ++i) {
    const glm::dvec3& p = points.positions[i];
    const uint64_t code = geometry::morton_code(frame.root, p);
    uint32_t part = own ? frame.finder.part_of(code) : PartFinder::kNoPart;
    if (own && part == PartFinder::kNoPart) part = frame.finder.nearest_part(p);
    if (own) rows[{part, true}].push_back(i);
    frame.finder.for_each_halo(p, code, part, [&](uint32_t near) { rows[{near, false}].push_back(i); });
  }
  std::vector<PartRows> parts;
  parts.reserve(rows.size());
  for (auto& [key, list] : rows) parts.push_back({key.first, key.second, std::move(list)});
  return parts;
}

/// Distributes former and new points to the regions, and counts what former leaves give up.
class Distribution {
 public:
  Distribution(const AppendInputs& inputs, const AppendPlan& plan, const BuildFrame& frame, PartStore& store)
      : inputs_(inputs), plan_(plan), frame_(frame), store_(store) {}

  Status add_all(StageClock& clock, estimation::SurfelReport& report) {
    const std::vector<uint32_t> leaves = needed_leaves();
    clock.begin("sorting points", leaves.size() + inputs_.added.pieces());
    Status status =
        work_in_order(leaves.size(), append_threads(), [&](size_t i) { return add_leaf(leaves[i], clock); });
    if (!status) return status;
    return work_in_order(inputs_.added.pieces(), append_threads(),
                         [&](size_t i) { return add_piece(i, clock, report); });
  }

  /// Statistics of the former leaves that are made anew.
  [[nodiscard]] const model::AttributeStatistics& given_up() const { return given_up_; }

 private:
  using Step = Result<std::function<Status()>>;

  /// Those that are made anew, and those with points near them.
  [[nodiscard]] std::vector<uint32_t> needed_leaves() const {
    std::vector<uint32_t> needed;
    for (const uint32_t leaf : leaves_of(inputs_.model)) {
      bool need = plan_.region_of[leaf] != AppendPlan::kNoRegion;
      for (uint32_t part = 0; part < frame_.parts.size() && !need; ++part) {
        need = frame_.finder.may_need(part, inputs_.model.blocks()[leaf].bounds);
      }
      if (need) needed.push_back(leaf);
    }
    return needed;
  }

  Step add_leaf(uint32_t leaf, StageClock& clock) {
    Result<model::DecodedBlock> block = inputs_.model.decode(leaf);
    if (!block) return fail(block);
    const bool own = plan_.region_of[leaf] != AppendPlan::kNoRegion;
    const double spacing = inputs_.model.blocks()[leaf].spacing;
    const auto is_affected = [&](const glm::dvec3& position, float radius) {
      const double reach = kReachOverRadius * std::max(spacing, double{radius});
      return own && inputs_.places.any_near({position, position}, reach);
    };
    model::AttributeStatistics statistics;
    if (own) statistics = statistics_of(*block, inputs_.model.info());
    const InputPiece piece{lattice_of(block->grid, inputs_.former),
                           points_of_leaf(std::move(*block), inputs_.model.info().color_bits, inputs_.former,
                                          inputs_.schema, is_affected)};
    const std::vector<PartRows> rows = rows_by_part(piece.points, frame_, own);
    return [this, &clock, statistics = std::move(statistics),
            packed = std::make_shared<PackedPiece>(pack_piece(piece, rows))] {
      given_up_.add(statistics);
      clock.step();
      return store_.add(*packed);
    };
  }

  Step add_piece(size_t number, StageClock& clock, estimation::SurfelReport& report) {
    estimation::SurfelReport own;
    Result<InputPiece> piece = inputs_.added.read(number, own);
    if (!piece) return fail(piece);
    piece->source += inputs_.former.lattices.size();
    piece->points = scan::conform(std::move(piece->points), inputs_.schema);
    const std::vector<PartRows> rows = rows_by_part(piece->points, frame_, true);
    return [this, &clock, &report, own, packed = std::make_shared<PackedPiece>(pack_piece(*piece, rows))] {
      report.add(own);
      clock.step();
      return store_.add(*packed);
    };
  }

  const AppendInputs& inputs_;
  const AppendPlan& plan_;
  const BuildFrame& frame_;
  PartStore& store_;
  model::AttributeStatistics given_up_;
};

}  // namespace

Result<model::AttributeStatistics> distribute_points(const AppendInputs& inputs, const AppendPlan& plan,
                                                     const BuildFrame& frame, PartStore& store, StageClock& clock,
                                                     estimation::SurfelReport& report) {
  Distribution distribution(inputs, plan, frame, store);
  if (Status status = distribution.add_all(clock, report); !status) return fail(status);
  return distribution.given_up();
}

}  // namespace surfcast::builder
