// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/engine.h"

#include <fcntl.h>

#include "tests/planner/cli/program/command_line.h"
#include "tests/planner/cohort/orphans.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// The program on a cohort of three subjects.
class CohortEngine : public tests::CommandLine {
 protected:
  /// Makes the scans: files with this beginning and size, which occupy no room on the disk.
  void make_scans(const std::string& beginning, std::uintmax_t bytes) const {
    write("scan.nrrd", beginning);
    fs::resize_file(folder_ / "scan.nrrd", bytes);
    write("scans.csv", "participant_id,scan\n1,scan.nrrd\n2,scan.nrrd\n3,scan.nrrd\n");
  }
  /// Participants that hash their scans for minutes.
  void make_long_work() const { make_scans("", std::uintmax_t{1} << 40); }

  pid_t begin(const std::string& engine, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{std::string(OCTOTOMY_BINARY_DIR) + "/octotomy",
                                   "cohort",
                                   (folder_ / "scans.csv").string(),
                                   (folder_ / "out").string(),
                                   "participant",
                                   "--plan",
                                   (folder_ / "ball.plan.json").string(),
                                   "--engine",
                                   engine};
    words.insert(words.end(), more.begin(), more.end());
    return tests::in_process([words]() mutable {
      std::vector<char*> arguments;
      for (std::string& word : words) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      const int nowhere = ::open("/dev/null", O_RDWR);
      for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
      ::execv(arguments[0], arguments.data());
    });
  }
  /// Whether a participant is working on its subject.
  bool is_at_work() const {
    return tests::holds_soon([this] { return fs::exists(folder_ / "out/code/locks/1"); });
  }
  /// Every process ends after the program has ended by these signals.
  void expect_all_end(const std::string& engine, const std::vector<int>& signals) const {
    const tests::Orphans orphans;
    make_long_work();
    const pid_t program = begin(engine);
    EXPECT_TRUE(is_at_work());
    for (const int signal : signals) {
      ::kill(program, signal);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // else two are one
    }
    EXPECT_TRUE(orphans.end_by_themselves());
  }
};

TEST_F(CohortEngine, AParticipantEndsWithAProgramThatIsKilled) {
  expect_all_end("serial", {SIGKILL});
}

TEST_F(CohortEngine, AParticipantEndsWithAProgramThatIsInterruptedTwice) {
  expect_all_end("serial", {SIGTERM, SIGTERM});
}

TEST_F(CohortEngine, AParticipantEndsWithTheProgramsTime) {
  const tests::Orphans orphans;
  make_long_work();
  begin("serial", {"--time-limit", "5"});
  EXPECT_TRUE(is_at_work());
  EXPECT_TRUE(orphans.end_by_themselves());
}

TEST_F(CohortEngine, GnuParallelAndItsParticipantsEndWithAProgramThatIsKilled) {
  OCTOTOMY_NEEDS_PROGRAM("parallel", "parallel");
  expect_all_end("parallel", {SIGKILL});
}

TEST_F(CohortEngine, GnuParallelAndItsParticipantsEndWithAProgramThatIsInterruptedTwice) {
  OCTOTOMY_NEEDS_PROGRAM("parallel", "parallel");
  expect_all_end("parallel", {SIGINT, SIGINT});
}

TEST_F(CohortEngine, MemoryBindsEveryParticipant) {
#ifdef OCTOTOMY_SANITIZED
  GTEST_SKIP() << "a sanitizer's shadow takes terabytes of data";
#endif
  const std::string header =
      "NRRD0005\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 512 512 600\n"
      "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nendian: little\nencoding: raw\n\n";
  make_scans(header, header.size() + std::uintmax_t{512} * 512 * 600 * 2);
  const tests::CommandAnswer answer = run("cohort " + at("scans.csv") + " " + at("out") +
                                          " participant --memory 0.2 --plan " + at("ball.plan.json"));
  EXPECT_EQ(answer.status, 3);
  std::size_t refused = 0;
  for (std::size_t found = 0; (found = answer.errors.find("raise --memory", found)) != std::string::npos;
       ++found)
    ++refused;
  EXPECT_EQ(refused, 3u) << answer.errors;
}

}  // namespace
}  // namespace octotomy::planner
