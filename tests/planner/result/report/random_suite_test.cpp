// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/random_suite.h"

#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

/// The random questions on scans, which lie in a folder for temporary files of the test's own.
class RandomScans : public tests::CommandLine {
 protected:
  RandomScans() { std::filesystem::create_directory(folder_ / "temporary"); }

  /// Asks questions and, once a scan is there, ends the program by `end`.
  tests::CommandAnswer ask(const std::string& count, const std::string& end) const {
    return tests::run_command("{ export TMPDIR=" + at("temporary") +
                                  "; { " OCTOTOMY_BINARY_DIR "/octotomy verify --tier bounded --random " +
                                  count + " & } && " + end + "wait $!; }",
                              folder_ / "");
  }
  bool are_left() const { return !std::filesystem::is_empty(folder_ / "temporary"); }
};

const std::string when_written =
    "for i in $(seq 3000); do [ -e $TMPDIR/octotomy-random-*/waves.nrrd ] && break; sleep 0.01; done; ";

TEST_F(RandomScans, DoNotOutliveAnInterruptedRun) {
  const tests::CommandAnswer answer =
      ask("100000", when_written + "kill -STOP $!; kill -TERM $!; kill -INT $!; kill -CONT $!; ");
  EXPECT_EQ(answer.status, 3) << answer.errors;
  EXPECT_FALSE(are_left());
}

TEST_F(RandomScans, OfAKilledRunAreRemovedByTheNext) {
  ask("100000", when_written + "kill -KILL $!; ");
  EXPECT_TRUE(are_left());
  EXPECT_LE(ask("1", "").status, 1) << "one question has an answer, of substance or not";
  EXPECT_FALSE(are_left());
}

}  // namespace
}  // namespace octotomy::planner
