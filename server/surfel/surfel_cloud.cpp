#include "surfel/surfel_cloud.h"

namespace surfcast {

Box SurfelCloud::bounds() const {
  Box box;
  for (const glm::dvec3& p : positions) box.include(p);
  return box;
}

}  // namespace surfcast
