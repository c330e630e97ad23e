#include "surfel/surfel_cloud.h"

namespace surfcast::surfel {

geometry::Box SurfelCloud::bounds() const {
  geometry::Box box;
  for (const glm::dvec3& p : positions) box.include(p);
  return box;
}

}  // namespace surfcast::surfel
