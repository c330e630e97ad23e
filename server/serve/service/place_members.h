#pragma once

#include <optional>
#include <vector>

#include "base/result.h"
#include "model/georeference.h"
#include "model/model_file.h"

namespace surfcast::service {

/// The largest error of the place of a block, in spacings of its surfels.
inline constexpr double kMaxPlaceError = 0.25;

/// Brings models that are to be joined into the system of the first that states one. Models that state none lie as they
/// are. Each block is placed by an affine map, the derivative of the transformation at its centre, which PROJ tells. At
/// the corners of the block the map is compared with the transformation itself.
class MemberPlacer {
 public:
  /// States Member::places of a model of another system. Fails if a map is off by more than kMaxPlaceError, or if
  /// there is no way into that system. Errors name the member.
  Status place(model::Member& member);

 private:
  std::optional<model::CoordinateSystem> common_;
};

/// Places all of them; fails at the first that cannot be placed.
Status place_members(std::vector<model::Member>& members);

}  // namespace surfcast::service
