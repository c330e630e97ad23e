#pragma once

#include <cstddef>
#include <functional>

#include "base/result.h"

namespace surfcast::builder {

/// Does `work` for all numbers below `count`, at most `at_once` of them at the same time, and calls what it returns one
/// after another in the order of the numbers. Ends with the first failure.
Status work_in_order(size_t count, size_t at_once, const std::function<Result<std::function<Status()>>(size_t)>& work);

}  // namespace surfcast::builder
