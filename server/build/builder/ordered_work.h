#pragma once

#include <cstddef>
#include <functional>

#include "base/result.h"

namespace surfcast::builder {

/// Runs `work` for all numbers below `count`, at most `at_once` of them concurrently. Calls the functions that `work`
/// returns one at a time, in the order of the numbers. Stops at the first error and returns it.
Status work_in_order(size_t count, size_t at_once, const std::function<Result<std::function<Status()>>(size_t)>& work);

}  // namespace surfcast::builder
