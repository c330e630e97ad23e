#include "builder/memory_budget.h"

#include <algorithm>
#include <charconv>
#include <string>

#include "base/host_memory.h"
#include "estimation/links.h"

namespace surfcast::builder {
namespace {

constexpr uint64_t kMebibyte = uint64_t{1} << 20;
/// Memory beside the points: the program, input pieces and blocks in flight.
constexpr uint64_t kReserve = 256 * kMebibyte;
/// Smaller parts would consist mostly of their halo.
constexpr uint64_t kMinPart = 250000;
/// Estimated ratio of the points of a part with its halo to those without. Fewer parts are processed at once if it is
/// exceeded.
constexpr double kWithHalo = 1.5;
/// Parts that should fit into memory together, so that cores stay busy during the serial steps of one part.
constexpr uint64_t kPartsAtOnce = 3;
/// Bytes per point during processing, beside its attributes (measured): sites, neighbours, links and hashes while
/// surfels are made; a point tree, a spatial order and coarse levels while surfels are weighted and written.
constexpr uint64_t kWorkPerPoint = 260;

uint64_t point_bytes(const scan::ScanSchema& schema) {
  // Every surfel finally has a position, a normal, a radius and a weight.
  uint64_t bytes = 24 + 12 + 4 + 4 + (schema.color_bits != 0 ? 6 : 0);
  for (const scan::ScalarField& field : schema.scalars) bytes += scan::size_of(field.type);
  return bytes;
}

std::string in_mebibytes(uint64_t bytes) {
  return std::to_string((bytes + kMebibyte - 1) / kMebibyte) + "M";
}

}  // namespace

std::optional<uint64_t> parse_memory_size(std::string_view text) {
  uint64_t number = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc() || number == 0) return std::nullopt;
  const std::string_view unit = text.substr(static_cast<size_t>(end - text.data()));
  const int shift = unit.empty() ? 0 : unit == "K" ? 10 : unit == "M" ? 20 : unit == "G" ? 30 : -1;
  if (shift < 0 || number > (UINT64_MAX >> shift)) return std::nullopt;
  return number << shift;
}

uint64_t machine_memory() {
  return read_host_memory().total;
}

Result<uint64_t> memory_budget(std::optional<uint64_t> wanted) {
  const uint64_t machine = machine_memory();
  if (!wanted || *wanted <= machine) return wanted.value_or(machine / 4);
  return fail(ErrorKind::kLimit, "a memory budget of " + in_mebibytes(*wanted) + " is more than the " +
                                     in_mebibytes(machine) + " of this machine");
}

Result<MemoryPlan> plan_memory(uint64_t budget, uint64_t held, const scan::ScanSchema& schema) {
  MemoryPlan plan;
  plan.budget = budget;
  plan.per_point = point_bytes(schema) + kWorkPerPoint;
  const uint64_t least =
      held + kReserve + static_cast<uint64_t>(kWithHalo * static_cast<double>(kMinPart * plan.per_point));
  if (budget < least) {
    return fail(ErrorKind::kLimit, "a memory budget of " + in_mebibytes(budget) +
                                       " is too small for these points: it takes at least " + in_mebibytes(least));
  }
  plan.for_parts = budget - kReserve - held;
  plan.whole_points = std::min<uint64_t>(plan.for_parts / plan.per_point, uint64_t{estimation::kMaxSites});
  const double points = static_cast<double>(plan.for_parts) / (kWithHalo * static_cast<double>(plan.per_point));
  plan.part_points = std::max(kMinPart, static_cast<uint64_t>(points / kPartsAtOnce));
  return plan;
}

}  // namespace surfcast::builder
