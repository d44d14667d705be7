// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/background_tasks.h"

#include <array>
#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <stdexcept>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>
#include <thread>

namespace octotomy::planner {
namespace {

TEST(BackgroundTasks, WorksOnEveryPieceAndThrowsWhatAPieceThrewWhereItIsWaitedFor) {
  for (const std::size_t threads : {1, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    std::array<std::atomic<int>, 3> done{};
    BackgroundTasks tasks({});
    for (std::size_t i = 0; i < done.size(); ++i)
      tasks.begin([&done, i](const std::stop_token&) {
        if (i == 1) throw std::runtime_error("the second piece");
        tbb::parallel_for(0, 100, [&](int) { ++done[i]; });
      });
    tasks.wait(0);
    EXPECT_EQ(done[0], 100) << threads << " threads";
    EXPECT_THROW(tasks.wait(1), std::runtime_error);
    tasks.wait(2);
    EXPECT_EQ(done[2], 100) << threads << " threads";
  }
}

/// Whether the caller takes up a piece while it waits for the other thread, within without_tasks() or not.
bool takes_up_a_piece(bool apart) {
  using namespace std::chrono_literals;
  std::atomic<bool> is_held = false, has_piece = false, is_begun = false, was_begun = false;
  tbb::task_group held;
  held.run([&] {
    is_held = true;
    while (!has_piece) std::this_thread::sleep_for(1ms);
    for (int i = 0; i < (apart ? 100 : 10000) && !is_begun; ++i) std::this_thread::sleep_for(1ms);
    was_begun = is_begun.load();
  });
  while (!is_held) std::this_thread::sleep_for(1ms);
  BackgroundTasks tasks({});
  tasks.begin([&](const std::stop_token&) { is_begun = true; });
  has_piece = true;
  if (apart)
    tasks.without_tasks([&] { held.wait(); });
  else
    held.wait();
  tasks.wait(0);
  EXPECT_TRUE(is_begun);
  return was_begun;
}

TEST(BackgroundTasks, TakesUpNoPieceWithinWorkThatStandsApart) {
  if (std::thread::hardware_concurrency() < 2)
    GTEST_SKIP() << "one processor has no other thread to wait for";
#ifdef OCTOTOMY_PLAIN_THREADS
  GTEST_SKIP() << "plain threads take up no work of others";
#endif
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_TRUE(takes_up_a_piece(false));
  EXPECT_FALSE(takes_up_a_piece(true));
}

TEST(BackgroundTasks, ItsEndAndTheCallersTokenStopThePieces) {
  using namespace std::chrono_literals;
  if (std::thread::hardware_concurrency() < 2)
    GTEST_SKIP() << "one processor begins no piece beside its own work";
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 2);
  std::stop_source source;
  std::atomic<int> stopped = 0;
  const auto until_stopped = [&](const std::stop_token& stop) {
    while (!stop.stop_requested()) std::this_thread::sleep_for(1ms);
    ++stopped;
  };
  {
    BackgroundTasks tasks(source.get_token());
    tasks.begin(until_stopped);
    source.request_stop();
    tasks.wait(0);
    EXPECT_EQ(stopped, 1);
  }
  std::atomic<bool> is_begun = false;
  {
    BackgroundTasks tasks({});
    tasks.begin([&](const std::stop_token& stop) {
      is_begun = true;
      until_stopped(stop);
    });
    while (!is_begun) std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(stopped, 2);
}

TEST(BackgroundTasks, ItsEndLeavesNothingOutOfALoopThatHasBegun) {
  using namespace std::chrono_literals;
  if (std::thread::hardware_concurrency() < 2)
    GTEST_SKIP() << "one processor begins no piece beside its own work";
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 2);
  std::atomic<bool> is_begun = false;
  std::atomic<int> done = 0;
  {
    BackgroundTasks tasks({});
    tasks.begin([&](const std::stop_token& stop) {
      is_begun = true;
      while (!stop.stop_requested()) std::this_thread::sleep_for(1ms);
      tbb::parallel_for(0, 1000, [&](int) { ++done; });
    });
    while (!is_begun) std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(done, 1000);
}

}  // namespace
}  // namespace octotomy::planner
