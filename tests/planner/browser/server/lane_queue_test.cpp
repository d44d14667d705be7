// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/lane_queue.h"

#include <atomic>
#include <future>
#include <gtest/gtest.h>
#include <vector>

namespace octotomy::planner::serve {
namespace {

/// Work that runs until it is stopped, and says so.
LaneQueue::Work endless(std::int64_t id, std::promise<void>& begun, std::promise<void>& stopped) {
  return {1, id,
          [&](const std::stop_token& stop) {
            begun.set_value();
            while (!stop.stop_requested()) std::this_thread::yield();
            stopped.set_value();
          },
          [] {}};
}

TEST(LaneQueue, DoesOneAfterTheOther) {
  std::vector<int> done;
  std::promise<void> all;
  {
    LaneQueue lane(false);
    for (int i = 0; i < 10; ++i)
      lane.put({1, i, [&done, i](const std::stop_token&) { done.push_back(i); }, [] {}});
    lane.put({1, 10, [&](const std::stop_token&) { all.set_value(); }, [] {}});
    all.get_future().wait();
  }
  EXPECT_EQ(done, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(LaneQueue, ANewerRequestStopsWhatRunsAndDropsWhatWaits) {
  std::promise<void> begun, stopped, last;
  std::atomic<int> dropped{0}, ran{0};
  LaneQueue lane(true);
  lane.put(endless(1, begun, stopped));
  begun.get_future().wait();
  lane.put({2, 2, [&](const std::stop_token&) { ++ran; }, [&] { ++dropped; }});  // another window's stays
  for (const std::int64_t id : {3, 4})
    lane.put({1, id, [&](const std::stop_token&) { last.set_value(); }, [&] { ++dropped; }});
  last.get_future().wait();
  stopped.get_future().wait();
  EXPECT_EQ(dropped, 1);
  EXPECT_EQ(ran, 1);
}

TEST(LaneQueue, ARequestIsCancelledWhereverItIs) {
  std::promise<void> begun, stopped, dropped;
  LaneQueue lane(false);
  lane.put(endless(1, begun, stopped));
  begun.get_future().wait();
  lane.put(
      {1, 2, [](const std::stop_token&) { FAIL() << "it was cancelled"; }, [&] { dropped.set_value(); }});
  EXPECT_FALSE(lane.cancel(2, 1)) << "another window's";
  EXPECT_TRUE(lane.cancel(1, 2));
  dropped.get_future().wait();
  EXPECT_TRUE(lane.cancel(1, 1));
  stopped.get_future().wait();
}

TEST(LaneQueue, AWindowThatHasGoneStopsItsWork) {
  std::promise<void> begun, stopped;
  LaneQueue lane(false);
  lane.put(endless(1, begun, stopped));
  begun.get_future().wait();
  lane.put({1, 2, [](const std::stop_token&) { FAIL(); }, [] { FAIL() << "nobody is told"; }});
  lane.close_window(1);
  stopped.get_future().wait();
}

}  // namespace
}  // namespace octotomy::planner::serve
