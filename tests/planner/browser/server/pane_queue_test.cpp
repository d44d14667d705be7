// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/pane_queue.h"

#include <gtest/gtest.h>
#include <thread>

namespace octotomy::planner::serve {
namespace {

PaneQueue::PaneRequest asked(std::int64_t id, int pane = 0, bool is_moving = true, std::uint64_t window = 1) {
  return {{window, pane}, {id, "pane", {}}, is_moving};
}

/// The next request's number, 0 where none is ready.
std::int64_t next_id(PaneQueue& queue) {
  std::stop_source stop;
  stop.request_stop();
  const auto next = queue.next(stop.get_token());
  return next ? next->request.id : 0;
}

TEST(PaneQueue, OnlyTheNewestOfAPaneWaits) {
  PaneQueue queue;
  for (const std::int64_t id : {1, 2, 3}) queue.ask(asked(id));
  EXPECT_EQ(next_id(queue), 3);
  EXPECT_EQ(next_id(queue), 0);
}

TEST(PaneQueue, AWithdrawnRequestIsNotServed) {
  PaneQueue queue;
  EXPECT_FALSE(queue.withdraw({1, 0}));
  queue.ask(asked(1));
  queue.ask(asked(2, 1));
  EXPECT_EQ(queue.withdraw({1, 0})->request.id, 1);
  EXPECT_FALSE(queue.withdraw({1, 0}));
  EXPECT_EQ(next_id(queue), 2);
  EXPECT_EQ(next_id(queue), 0);
}

TEST(PaneQueue, AMovingPaneWaitsForThePageAndAPictureAtRestDoesNot) {
  PaneQueue queue;
  for (const std::int64_t id : {1, 2}) {
    queue.ask(asked(id));
    EXPECT_EQ(next_id(queue), id);
  }
  queue.ask(asked(3));
  EXPECT_EQ(next_id(queue), 0) << "two are in flight";
  queue.ask(asked(4, 1));
  EXPECT_EQ(next_id(queue), 4) << "the other pane is free";
  queue.shown({1, 0}, 1);
  EXPECT_EQ(next_id(queue), 3);
  queue.ask(asked(5, 0, false));
  EXPECT_EQ(next_id(queue), 5);
  queue.ask(asked(6));
  EXPECT_EQ(next_id(queue), 0);
  queue.shown({1, 0}, 3);  // and with it the second
  EXPECT_EQ(next_id(queue), 6);
}

TEST(PaneQueue, PanesTakeTurns) {
  PaneQueue queue;
  std::vector<std::int64_t> served;
  for (std::int64_t round = 0; round < 6; ++round) {
    for (int pane = 0; pane < 3; ++pane) queue.ask(asked(10 * round + pane, pane, false));
    served.push_back(next_id(queue) % 10);
  }
  EXPECT_EQ(served, (std::vector<std::int64_t>{0, 1, 2, 0, 1, 2}));
}

TEST(PaneQueue, CountsThePanesThatMove) {
  PaneQueue queue;
  EXPECT_EQ(queue.moving_panes(), 1);
  for (int pane = 0; pane < 4; ++pane) queue.ask(asked(pane, pane));
  queue.ask(asked(9, 5, false));
  EXPECT_EQ(queue.moving_panes(), 4);
}

TEST(PaneQueue, AWindowThatHasGoneLeavesNothing) {
  PaneQueue queue;
  queue.ask(asked(1));
  queue.ask(asked(2, 0, true, 2));
  queue.close_window(1);
  EXPECT_EQ(next_id(queue), 2);
  queue.ask(asked(3, 0, true, 2));
  EXPECT_EQ(queue.close({2, 0})->request.id, 3);
  EXPECT_FALSE(queue.close({2, 0}));
  queue.shown({7, 7}, 1);
}

/// A queue that has given out a request, whose picture is drawn, and its token.
std::stop_token token_of_drawn(PaneQueue& queue, PaneQueue::PaneRequest request) {
  queue.ask(std::move(request));
  return queue.next({})->stop.get_token();
}

TEST(PaneQueue, ANewerRequestOfThePaneStopsItsPictureAtRest) {
  PaneQueue queue;
  std::stop_token drawn = token_of_drawn(queue, asked(1, 0, false));
  queue.ask(asked(2, 1, false));
  queue.ask(asked(3, 0, false, 2));
  EXPECT_FALSE(drawn.stop_requested()) << "they are of another pane and another window";
  queue.ask(asked(4));
  EXPECT_TRUE(drawn.stop_requested());
  while (next_id(queue) != 0) continue;
  drawn = token_of_drawn(queue, asked(5));
  queue.ask(asked(6));
  EXPECT_FALSE(drawn.stop_requested()) << "a drag that asks faster than it is drawn would show nothing";
  queue.ask(asked(7, 0, false));
  EXPECT_TRUE(drawn.stop_requested());
}

TEST(PaneQueue, WhatIsClosedOrCancelledIsStopped) {
  PaneQueue queue;
  std::stop_token drawn = token_of_drawn(queue, asked(1, 0, false));
  EXPECT_FALSE(queue.stop(1, 2));
  EXPECT_FALSE(queue.stop(2, 1));
  EXPECT_FALSE(drawn.stop_requested());
  EXPECT_TRUE(queue.stop(1, 1));
  EXPECT_TRUE(drawn.stop_requested());
  drawn = token_of_drawn(queue, asked(2, 0, false));
  queue.close({1, 1});
  EXPECT_FALSE(drawn.stop_requested());
  queue.close({1, 0});
  EXPECT_TRUE(drawn.stop_requested());
  drawn = token_of_drawn(queue, asked(3, 0, false));
  queue.close_window(2);
  EXPECT_FALSE(drawn.stop_requested());
  queue.close_window(1);
  EXPECT_TRUE(drawn.stop_requested());
  queue.ask(asked(4));
  EXPECT_FALSE(queue.withdraw(1, 3));
  EXPECT_EQ(queue.withdraw(1, 4)->request.id, 4);
  EXPECT_EQ(next_id(queue), 0);
  EXPECT_FALSE(queue.stop(1, 3)) << "it was drawn before";
}

TEST(PaneQueue, WaitsForARequest) {
  PaneQueue queue;
  std::int64_t got = 0;
  {
    std::jthread drawing([&](const std::stop_token& stop) { got = queue.next(stop)->request.id; });
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    queue.ask(asked(8));
    while (queue.moving_panes() != 1) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(got, 8);
}

}  // namespace
}  // namespace octotomy::planner::serve
