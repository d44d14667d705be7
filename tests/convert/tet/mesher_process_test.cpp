// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/mesher_process.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <thread>
#include <unistd.h>

#include "tests/convert/surfaces.h"

namespace octotomy::convert {
namespace {

/// Enough triangles to keep a mesher busy for a second or more; with a depth of 5 a fifth of that.
MesherInput long_work(int depth = 6) {
  const brep::Triangles surface = tests::ball({0, 0, 0}, 30.0, depth);
  return {surface.points_mm, surface.faces, {}};
}

/// A child of this process by the name of its executable; -1 if there is none.
pid_t child_named(const std::string& name) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;) {
      std::error_code gone;
      const auto executable = std::filesystem::read_symlink("/proc/" + std::to_string(child) + "/exe", gone);
      if (!gone && executable.filename() == name) return child;
    }
  }
  return -1;
}

/// The outcome of TetGen's run if its process receives a signal as soon as it exists.
MesherOutcome struck_by(int signal, std::chrono::milliseconds time) {
  std::jthread striker([signal](const std::stop_token& stop) {
    while (!stop.stop_requested())
      if (const pid_t child = child_named("octotomy-tetgen"); child > 0) {
        kill(child, signal);
        return;
      }
  });
  return run_tetgen(long_work(), "pYq1.4Q", {time, 4ULL << 30, {}});
}

TEST(MesherProcess, ACrashIsNamedByItsSignalAndOtherSwitchesAreWorthATry) {
  const MesherOutcome outcome = struck_by(SIGSEGV, std::chrono::seconds(60));
  ASSERT_TRUE(outcome.failure);
  EXPECT_NE(outcome.failure->find("TetGen -pYq1.4Q crashed with signal 11 (SIGSEGV)"), std::string::npos)
      << *outcome.failure;
  EXPECT_TRUE(outcome.worth_another_try);
  EXPECT_TRUE(outcome.tetrahedra.empty());
}

TEST(MesherProcess, AHangEndsByTheClockAndLeavesNoProcess) {
  const MesherOutcome outcome = struck_by(SIGSTOP, std::chrono::milliseconds(400));
  ASSERT_TRUE(outcome.failure);
  EXPECT_NE(outcome.failure->find("did not end within the time limit of 400 ms"), std::string::npos)
      << *outcome.failure;
  EXPECT_EQ(child_named("octotomy-tetgen"), -1);
}

TEST(MesherProcess, TimeInWhichItHasNoProcessorIsNotCounted) {
  const MesherOutcome alone = run_tetgen(long_work(5), "pYq1.4Q", {});
  ASSERT_FALSE(alone.failure);
  constexpr std::chrono::seconds time{6};
  bool was_held = false;
  const auto hold = [&](double share) {
    const pid_t child = child_named("octotomy-tetgen");
    if (was_held || child <= 0) return;
    was_held = true;
    kill(child, SIGSTOP);
    std::this_thread::sleep_for(time + std::chrono::seconds(1));
    kill(child, SIGCONT);
    EXPECT_LT(share, 0.5);
  };
  const MesherOutcome held = run_tetgen(long_work(5), "pYq1.4Q", {time, 4ULL << 30, {{}, hold}});
  EXPECT_TRUE(was_held);
  ASSERT_FALSE(held.failure) << *held.failure;
  EXPECT_EQ(held.points_mm, alone.points_mm);
  EXPECT_EQ(held.tetrahedra, alone.tetrahedra);
}

TEST(MesherProcess, OneEndedFromOutsideIsToldAsThat) {
  const MesherOutcome outcome = struck_by(SIGKILL, std::chrono::seconds(60));
  ASSERT_TRUE(outcome.failure);
  EXPECT_NE(outcome.failure->find("ended from outside"), std::string::npos) << *outcome.failure;
}

TEST(MesherProcess, LeftAloneTheSameWorkIsDone) {
  const MesherOutcome outcome = run_tetgen(long_work(), "pYq1.4Q", {});
  EXPECT_FALSE(outcome.failure);
  EXPECT_GT(outcome.tetrahedra.size(), 10000U);
}

TEST(MesherProcess, Mesh3OutOfMemorySaysHowMuchItHad) {
  MesherInput input = long_work();
  for (std::size_t i = 0; i < input.points_mm.size(); i += 1000) input.holes_mm.push_back(input.points_mm[i]);
  input.sizes_mm.assign(input.points_mm.size(), 0.3);
  const MesherOutcome outcome = run_mesh3(input, {}, {std::chrono::seconds(60), 100ULL << 20, {}});
  ASSERT_TRUE(outcome.failure);
  EXPECT_NE(outcome.failure->find("memory limit of 100 MiB"), std::string::npos) << *outcome.failure;
}

TEST(MesherProcess, Mesh3SaysWhichTriangleItCannotJoin) {
  MesherInput input = long_work();
  input.triangles.push_back(input.triangles.front());
  input.holes_mm = {input.points_mm.front()};
  input.sizes_mm.assign(input.points_mm.size(), 1.0);
  const MesherOutcome outcome = run_mesh3(input, {}, {});
  ASSERT_TRUE(outcome.failure);
  EXPECT_NE(
      outcome.failure->find("triangle " + std::to_string(input.triangles.size() - 1) + " does not join"),
      std::string::npos)
      << *outcome.failure;
}

}  // namespace
}  // namespace octotomy::convert
