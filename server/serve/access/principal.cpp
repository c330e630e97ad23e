#include "access/principal.h"

namespace surfcast::access {

bool has_expired(const Principal& principal, Principal::Time now) {
  return principal.expires && *principal.expires <= now;
}

}  // namespace surfcast::access
