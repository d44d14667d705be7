// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/parallel_tasks.h"

#include <atomic>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>

namespace octotomy::brep {
namespace {

TEST(ParallelTasks, LoopsWithinOtherTasksAreCompleteWhenOneThrows) {
  for (int round = 0; round < 200; ++round) {
    std::atomic<int> incomplete = 0;
    EXPECT_THROW(run_parallel_tasks(16,
                                    [&](std::size_t i) {
                                      if (i % 4 == 0) throw std::runtime_error("stopped");
                                      std::atomic<int> done = 0;
                                      tbb::parallel_for(0, 500, [&](int) { ++done; });
                                      incomplete += done != 500;
                                    }),
                 std::runtime_error);
    ASSERT_EQ(incomplete, 0) << round;
  }
}

TEST(ParallelTasks, TheFirstFailureIsThrown) {
  for (int round = 0; round < 50; ++round) try {
      run_parallel_tasks(32, [](std::size_t i) {
        if (i % 5 == 3) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      ASSERT_STREQ(error.what(), "3");
    }
}

TEST(ParallelTasks, EachTaskRunsOnceEvenAfterAFailure) {
  std::vector<int> runs(40, 0);
  EXPECT_THROW(run_parallel_tasks(runs.size(),
                                  [&](std::size_t i) {
                                    ++runs[i];
                                    if (i == 0) throw std::runtime_error("first");
                                  }),
               std::runtime_error);
  EXPECT_EQ(runs, std::vector<int>(40, 1));
}

}  // namespace
}  // namespace octotomy::brep
