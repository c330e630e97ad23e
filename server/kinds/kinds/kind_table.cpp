#include "kinds/kind_table.h"

#include <algorithm>
#include <array>

#include "kinds/built_in_kinds.h"

namespace surfcast::kinds {

KindTable built_in_kinds() {
  static const SurfelKind kSurfels;
  static const GridKind kGrids;
  static const GaussianKind kGaussians;
  static const EllipsoidKind kEllipsoids;
  static const std::array<const Kind*, 4> kKinds{&kSurfels, &kGrids, &kGaussians, &kEllipsoids};
  return kKinds;
}

Result<std::vector<uint32_t>> find_kinds(const model::ModelFile& model, KindTable table) {
  std::vector<uint32_t> numbers;
  for (const model::KindCount& count : model.info().kinds) {
    const auto found = std::ranges::find(table, count.kind, &Kind::name);
    if (found == table.end()) {
      return fail(ErrorKind::kUnsupported,
                  model.path().string() + ": has blocks of the unknown kind '" + count.kind + "'");
    }
    numbers.push_back(static_cast<uint32_t>(found - table.begin()));
  }
  return numbers;
}

}  // namespace surfcast::kinds
