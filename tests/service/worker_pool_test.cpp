#include "service/worker_pool.h"

#include <future>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace surfcast::service {
namespace {

/// A pool whose only thread is busy until it is told to go on.
struct BusyPool {
  explicit BusyPool(unsigned small_threads = 0, size_t most_waiting = SIZE_MAX) : pool(1, small_threads, most_waiting) {
    std::promise<void> begun;
    pool.post(
        [&begun, this] {
          begun.set_value();
          end_of_work.get_future().wait();
        },
        1);
    begun.get_future().wait();
  }

  std::promise<void> end_of_work;
  WorkerPool pool;
};

TEST(WorkerPoolTest, AClientDoesNotWaitForAllTasksOfAnother) {
  std::string order;
  {
    BusyPool busy;
    for (int i = 0; i < 3; ++i) {
      busy.pool.post(
          [&order] {
            order += 'a';
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
          },
          1);
    }
    busy.pool.post([&order] { order += 'b'; }, 2);
    busy.end_of_work.set_value();
  }
  EXPECT_EQ(order, "baaa") << "the time that was spent on the first one counts";
}

TEST(WorkerPoolTest, SmallTasksDoNotWaitForLargeOnes) {
  BusyPool busy(/*small_threads=*/1);
  std::promise<void> small;
  busy.pool.post([] {}, 2);
  busy.pool.post([&small] { small.set_value(); }, 3, TaskSize::kSmall);
  small.get_future().wait();
  busy.end_of_work.set_value();
}

TEST(WorkerPoolTest, OneClientLeavesRoomForOthers) {
  BusyPool busy(0, 8);
  for (int i = 0; i < 7; ++i) EXPECT_TRUE(busy.pool.post([] {}, 1));
  EXPECT_FALSE(busy.pool.post([] {}, 1));
  EXPECT_TRUE(busy.pool.post([] {}, 2));
  EXPECT_FALSE(busy.pool.post([] {}, 3)) << "it is full";
  busy.end_of_work.set_value();
}

TEST(WorkerPoolTest, ATaskThatThrowsIsTheOnlyOneThatIsLost) {
  std::promise<void> next;
  WorkerPool pool(1);
  pool.post([] { throw std::runtime_error("out of memory"); });
  pool.post([&next] { next.set_value(); });
  next.get_future().wait();
}

}  // namespace
}  // namespace surfcast::service
