// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/progress_line.h"

#include <gtest/gtest.h>
#include <thread>

#include "planner/operation/table/stopwatch.h"

namespace octotomy::planner::cli {
namespace {

/// What a call writes to standard error.
template <typename Call>
std::string said_by(const Call& call) {
  testing::internal::CaptureStderr();
  call();
  return testing::internal::GetCapturedStderr();
}

TEST(ProgressLine, TheRestIsReckonedOnceThereIsSomethingToReckonBy) {
  EXPECT_EQ(left_text(0.5, 0.5, Seconds(1.9)), "");
  EXPECT_EQ(left_text(0.01, 0.99, Seconds(10.0)), "");
  EXPECT_EQ(left_text(0.25, 0.75, Seconds(10.0)), "about 30 s left");
  EXPECT_EQ(left_text(0.02, 0.98, Seconds(10.0)), "about 8 min left");
  EXPECT_EQ(left_text(1.0, 0.0, Seconds(10.0)), "");
}

TEST(ProgressLine, WhatTellsNoShareIsNamedWithItsTime) {
  Timings timings;
  const Stopwatch outer(timings, "measure");
  const Stopwatch watch(timings, "half_width");
  EXPECT_EQ(said_by(show_silent_work), "") << "it has only begun";
  std::this_thread::sleep_for(Seconds(1.6));
  EXPECT_EQ(said_by(show_silent_work), "\r\x1b[2K       half width, for 2 s");
  EXPECT_EQ(said_by(show_silent_work), "") << "once a second is enough";
  EXPECT_EQ(said_by(erase_progress), "\r\x1b[2K");
}

TEST(ProgressLine, AShareHasItsTimeLeftAndWhatFollowsItInSilenceItsTime) {
  EXPECT_EQ(said_by([] { show_progress("filling", 0.0); }), "\r\x1b[2K  0 %  filling");
  std::this_thread::sleep_for(Seconds(2.2));
  EXPECT_EQ(said_by([] { show_progress("filling", 0.5); }), "\r\x1b[2K 50 %  filling, about 2 s left");
  std::this_thread::sleep_for(Seconds(1.3));
  EXPECT_TRUE(said_by(show_silent_work).starts_with("\r\x1b[2K 50 %  filling, for "));
  EXPECT_EQ(said_by([] { show_progress("filling", 1.0); }), "\r\x1b[2K100 %  filling\r\x1b[2K");
  EXPECT_EQ(said_by([] { show_progress("writing", 0.25); }), "\r\x1b[2K 25 %  writing");
  end_progress();
  EXPECT_EQ(said_by([] { show_progress("writing", 0.5); }), "");
}

}  // namespace
}  // namespace octotomy::planner::cli
