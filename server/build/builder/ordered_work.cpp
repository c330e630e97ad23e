#include "builder/ordered_work.h"

#include <atomic>
#include <utility>

#include <oneapi/tbb/parallel_pipeline.h>

namespace surfcast::builder {

Status work_in_order(size_t count, size_t at_once, const std::function<Result<std::function<Status()>>(size_t)>& work) {
  namespace tbb = oneapi::tbb;
  using Finish = Result<std::function<Status()>>;
  size_t next = 0;
  Status status;
  std::atomic<bool> failed = false;
  const auto take = [&](tbb::flow_control& control) -> size_t {
    if (next < count && !failed) return next++;
    control.stop();
    return 0;
  };
  const auto start = [&](size_t number) -> Finish {
    if (failed) return fail(ErrorKind::kCancelled, "");
    Finish finish = work(number);
    if (!finish) failed = true;
    return finish;
  };
  const auto end = [&](const Finish& finish) {
    if (!status) return;
    status = finish ? (*finish)() : fail(finish);
    if (!status) failed = true;
  };
  tbb::parallel_pipeline(at_once, tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, take) &
                                      tbb::make_filter<size_t, Finish>(tbb::filter_mode::parallel, start) &
                                      tbb::make_filter<Finish, void>(tbb::filter_mode::serial_in_order, end));
  return status;
}

}  // namespace surfcast::builder
