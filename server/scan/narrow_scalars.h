#pragma once

#include "surfel/scalar_attribute.h"

namespace surfcast {

/// Numbers read from text as the smallest type that holds them all: an integer type when all are integers (of 8, 16 or
/// 32 bits, unsigned if none is negative), else double.
ScalarValues narrow_scalars(ScalarValues values);

}  // namespace surfcast
