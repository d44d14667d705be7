// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/history.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

std::string plan_text(int number) {
  return R"({"octotomy_plan": 1, "name": "p", "scans": {"ct": {"path": "a.nrrd"}}, "steps": [{"id": "s", "do":
"window", "scan": "ct", "low": )" +
         std::to_string(number) + "}]}\n";
}

class History : public testing::Test {
 protected:
  History() { write(plan_text(0)); }
  void write(const std::string& text) const { std::ofstream(plan_) << text; }
  std::string file() const { return tests::bytes_of(plan_); }

  tests::ScratchFolder folder_;
  fs::path plan_ = folder_ / "my.plan.json";
};

TEST_F(History, UndoAndRedoWalkTheStatesAndTheFileFollows) {
  PlanHistory history(plan_);
  for (int number = 1; number <= 200; ++number)
    history.record(plan_text(number), "low " + std::to_string(number));
  EXPECT_EQ(history.edit_count(), 201);
  EXPECT_EQ(history.record(plan_text(200), "again"), 201) << "the same text is no edit";
  for (int number = 199; number >= 0; --number) {
    ASSERT_TRUE(history.undo());
    ASSERT_EQ(file(), plan_text(number));
  }
  EXPECT_FALSE(history.undo());
  for (int number = 1; number <= 200; ++number) {
    ASSERT_TRUE(history.redo());
    ASSERT_EQ(file(), plan_text(number));
  }
  EXPECT_FALSE(history.redo());
  EXPECT_EQ(history.newest(1)[0].what, "low 200");
}

TEST_F(History, WhatAnEditAfterUndoLeavesAsideIsNotLost) {
  PlanHistory history(plan_);
  history.record(plan_text(1), "one");
  history.name_version("approved");
  history.record(plan_text(2), "two");
  history.undo();
  history.record(plan_text(3), "three");
  EXPECT_EQ(history.text_of(3), plan_text(2));
  history.go_to("approved");
  EXPECT_EQ(file(), plan_text(1));
  history.begin_branch("bold");
  history.record(plan_text(4), "four");
  history.go_to("main");
  EXPECT_EQ(file(), plan_text(3));
  EXPECT_EQ(history.branch(), "main");
  history.go_to("bold");
  EXPECT_EQ(file(), plan_text(4));
  try {
    history.go_to("aproved");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'approved'?"), std::string::npos) << error.what();
  }
  EXPECT_THROW(history.name_version("bold"), std::runtime_error);
  EXPECT_THROW(history.name_version("3rd"), std::runtime_error);
}

TEST_F(History, AFileThatAnEditorChangedBecomesAnEdit) {
  { PlanHistory(plan_).record(plan_text(1), "one"); }
  write(plan_text(7));
  PlanHistory history(plan_);
  EXPECT_EQ(history.text(), plan_text(7));
  EXPECT_EQ(history.newest(1)[0].what, "changed outside");
  EXPECT_TRUE(history.undo());
  EXPECT_EQ(file(), plan_text(1));
}

TEST_F(History, TwoWritersAreDetectedAndNeitherOverwritesTheOther) {
  PlanHistory mine(plan_), theirs(plan_);
  theirs.record(plan_text(1), "theirs");
  EXPECT_THROW(mine.record(plan_text(2), "mine"), std::runtime_error);
  EXPECT_EQ(file(), plan_text(1));
  PlanHistory again(plan_);
  write(plan_text(3));  // by an editor, while it is open
  EXPECT_THROW(again.record(plan_text(4), "mine"), std::runtime_error);
  EXPECT_EQ(file(), plan_text(3));
}

TEST_F(History, AFileThatIsNoDatabaseIsRefusedByName) {
  std::ofstream(PlanHistory::path_of(plan_)) << std::string(4096, 'x');
  try {
    const PlanHistory history(plan_);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("is not the history of a plan"), std::string::npos)
        << error.what();
  }
}

TEST_F(History, AFileOfAnyOtherNameBesideThePlanIsNotWritten) {
  PlanHistory history(plan_);
  history.record(plan_text(1), "one");
  std::ofstream(folder_ / "notes.txt") << "precious";
  for (const char* ending : {".writing", ".part", ".tmp"})
    fs::create_symlink("notes.txt", plan_.string() + ending);
  ASSERT_TRUE(history.undo());
  EXPECT_EQ(file(), plan_text(0));
  EXPECT_FALSE(fs::is_symlink(plan_));
  EXPECT_EQ(tests::bytes_of(folder_ / "notes.txt"), "precious");
}

TEST_F(History, OfALinkedPlanIsThePlansOwn) {
  const fs::path link = folder_ / "link.plan.json";
  fs::create_symlink("my.plan.json", link);
  PlanHistory(link).record(plan_text(1), "one");
  EXPECT_EQ(PlanHistory::path_of(link), PlanHistory::path_of(plan_));
  PlanHistory history(plan_);
  EXPECT_EQ(history.edit_count(), 2);
  ASSERT_TRUE(PlanHistory(link).undo());
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(file(), plan_text(0));
}

TEST_F(History, ThePlansPermissionsStayAndAreItsHistorysToo) {
  const fs::perms mine = fs::perms::owner_read | fs::perms::owner_write;
  fs::permissions(plan_, mine);
  PlanHistory history(plan_);
  history.record(plan_text(1), "one");
  EXPECT_EQ(fs::status(plan_).permissions(), mine);
  EXPECT_EQ(fs::status(PlanHistory::path_of(plan_)).permissions(), mine);
}

TEST_F(History, OfAPlanThatNobodyMayWriteItsOwnerMay) {
  fs::permissions(plan_, fs::perms::owner_read);
  const PlanHistory history(plan_);
  EXPECT_EQ(fs::status(PlanHistory::path_of(plan_)).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(History, ADamagedStateIsRefusedByItsNumber) {
  for (int number = 1; number <= 3; ++number) PlanHistory(plan_).record(plan_text(number), "edit");
  const std::string sound = tests::bytes_of(PlanHistory::path_of(plan_));
  const auto refuses = [&](const std::string& damage) {
    std::ofstream(PlanHistory::path_of(plan_), std::ios::binary) << sound;
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(PlanHistory::path_of(plan_).c_str(), &database), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(database, damage.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
    try {
      PlanHistory(plan_).undo();
      ADD_FAILURE() << damage << " is not refused";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("the history is damaged at state"), std::string::npos)
          << damage << ": " << error.what();
    }
  };
  refuses("UPDATE edits SET parent = 3 WHERE id = 3");
  refuses("UPDATE edits SET parent = 4 WHERE id = 3");
  refuses("UPDATE edits SET tail = 99999999 WHERE id = 3");
  refuses("UPDATE edits SET head = -1 WHERE id = 3");
  refuses("UPDATE edits SET middle = 'other' WHERE id = 3");
  refuses("UPDATE state SET current = 77");
}

TEST_F(History, NamesAreOfALineAndBounded) {
  PlanHistory history(plan_);
  EXPECT_THROW(history.begin_branch(std::string(201, 'a')), std::runtime_error);
  EXPECT_THROW(history.begin_branch("two\nlines"), std::runtime_error);
  EXPECT_THROW(history.name_version("bell\a"), std::runtime_error);
  EXPECT_NO_THROW(history.name_version(std::string(200, 'a')));
}

bool is_beside(const fs::path& plan, const char* ending) {
  return fs::exists(PlanHistory::path_of(plan).string() + ending);
}

TEST_F(History, ACopyOfItsOneFileHasEveryEditWhileItIsOpen) {
  PlanHistory history(plan_);
  for (int number = 1; number <= 3; ++number) history.record(plan_text(number), "edit");
  for (const char* ending : {"-wal", "-shm", "-journal"}) EXPECT_FALSE(is_beside(plan_, ending)) << ending;
  const fs::path copy = folder_ / "copy.plan.json";
  fs::copy_file(plan_, copy);
  fs::copy_file(PlanHistory::path_of(plan_), PlanHistory::path_of(copy));
  const PlanHistory copied(copy);
  EXPECT_EQ(copied.edit_count(), 4);
  EXPECT_EQ(copied.newest(1)[0].what, "edit");
}

/// Adds to a history the log that older histories have.
void give_a_log(const fs::path& plan) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(PlanHistory::path_of(plan).c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  ASSERT_EQ(tests::bytes_of(PlanHistory::path_of(plan))[18], 2) << "the format's mark of a log";
}

TEST_F(History, AnOlderOneGivesUpItsLogAndKeepsItsEdits) {
  { PlanHistory(plan_).record(plan_text(1), "one"); }
  give_a_log(plan_);
  PlanHistory history(plan_);
  EXPECT_EQ(history.newest(1)[0].what, "one");
  EXPECT_EQ(tests::bytes_of(PlanHistory::path_of(plan_))[18], 1);
  history.record(plan_text(2), "two");
  EXPECT_FALSE(is_beside(plan_, "-wal"));
}

TEST_F(History, WhatCanBeUndoneAndRedoneIsWhatUndoAndRedoDo) {
  PlanHistory history(plan_);
  const auto told = [&](bool undo, bool redo) {
    EXPECT_EQ(history.can_undo(), undo) << "at state " << history.current();
    EXPECT_EQ(history.can_redo(), redo) << "at state " << history.current();
  };
  told(false, false);
  history.record(plan_text(1), "2");
  history.record(plan_text(2), "3");
  told(true, false);
  history.undo();
  told(true, true);
  history.undo();
  told(false, true);
  history.record(plan_text(3), "4");
  told(true, false);
  history.go_to("3");  // the branch leads past it
  told(true, false);
  EXPECT_FALSE(history.redo());
  history.go_to("1");
  told(false, true);
  EXPECT_TRUE(history.redo());
  EXPECT_EQ(history.current(), 4);
  history.begin_branch("bold");
  told(true, false);
}

TEST_F(History, TwentyThousandNamesAreListedAtOnce) {
  PlanHistory history(plan_);
  history.record(plan_text(1), "one");
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(PlanHistory::path_of(plan_).c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database,
                         "WITH RECURSIVE n(i) AS (SELECT 3 UNION ALL SELECT i + 1 FROM n WHERE i < 20000) "
                         "INSERT INTO edits SELECT i, i - 1, 'edit', '', '', 0, 0, 0, '' FROM n; "
                         "INSERT INTO versions SELECT 'b' || id, id FROM edits; "
                         "INSERT INTO versions VALUES ('a7', 7);",
                         nullptr, nullptr, nullptr),
            SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
  const std::clock_t start = std::clock();
  const std::vector<PlanEdit> edits = history.newest(1000000);
  // One search of the names for each state takes over half a minute.
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 3.0);
  ASSERT_EQ(edits.size(), 20000u);
  EXPECT_EQ(edits[0].names, std::vector<std::string>{"b20000"});
  EXPECT_EQ(edits[20000 - 7].names, (std::vector<std::string>{"a7", "b7"}));
  EXPECT_EQ(history.newest(3)[2].names, std::vector<std::string>{"b19998"});
}

/// Whether something holds for a user who may write nothing here; throws nothing.
bool holds_for_a_reader(const fs::path& folder, const std::function<bool()>& claim) {
  constexpr uid_t nobody = 65534;
  fs::permissions(folder, fs::perms(0555));
  const pid_t child = ::fork();
  if (child == 0) {
    if (::geteuid() == 0 && ::setuid(nobody) != 0) std::_Exit(2);
    try {
      std::_Exit(claim() ? 0 : 1);
    } catch (const std::exception& error) {
      std::fputs(error.what(), stderr);
      std::_Exit(3);
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  fs::permissions(folder, fs::perms(0755));
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool is_refused(const fs::path& plan, PlanHistory::Access access, const std::string& words) {
  try {
    const PlanHistory history(plan, access);
  } catch (const std::runtime_error& error) {
    return std::string(error.what()).find(words) != std::string::npos;
  }
  return false;
}

TEST_F(History, OfAFolderThatCannotBeWrittenIsRead) {
  using Access = PlanHistory::Access;
  const auto reads = [&] {
    PlanHistory history(plan_, Access::Read);
    return !PlanHistory::can_write(plan_) && history.edit_count() == 2 && history.text() == plan_text(1) &&
           history.newest(1)[0].what == "one";
  };
  const auto refuses_to_write = [&] { return is_refused(plan_, Access::Write, "cannot be written"); };
  EXPECT_TRUE(holds_for_a_reader(folder_.path(),
                                 [&] { return is_refused(plan_, Access::Read, "has no history yet"); }));
  EXPECT_TRUE(holds_for_a_reader(folder_.path(), refuses_to_write));
  { PlanHistory(plan_).record(plan_text(1), "one"); }
  EXPECT_TRUE(holds_for_a_reader(folder_.path(), reads));
  EXPECT_TRUE(holds_for_a_reader(folder_.path(), refuses_to_write));
  give_a_log(plan_);
  EXPECT_TRUE(holds_for_a_reader(folder_.path(), reads)) << "an older one";
  std::ofstream(PlanHistory::path_of(plan_).string() + "-wal") << "states that are not in the file";
  EXPECT_TRUE(holds_for_a_reader(folder_.path(), [&] {
    return is_refused(plan_, Access::Read, "copy the plan and all files whose names begin with");
  }));
}

/// Records edits for ever, and prints each one's number once record() has returned.
[[noreturn]] void edit_until_killed(const fs::path& plan, int from, int told) {
  try {
    PlanHistory history(plan);
    for (int number = from;; ++number) {
      history.record(plan_text(number), "edit");
      if (number % 7 == 0) history.undo(), history.redo();
      if (::write(told, &number, sizeof number) != sizeof number) std::_Exit(3);
    }
  } catch (...) {
    std::_Exit(4);
  }
}

TEST_F(History, AKillAtAnyInstantLosesNoEditThatWasTold) {
  // OCTOTOMY_KILLS=500 is the long run.
  const char* asked = std::getenv("OCTOTOMY_KILLS");
  const int kills = asked != nullptr ? std::atoi(asked) : 25;
  std::mt19937 random(1);
  int next = 1, killed_late = 0;
  unsigned span_us = 60000;  // that kills come in; longer where the first edit takes long
  for (int kill = 0; kill < kills; ++kill) {
    int pipe_ends[2];
    ASSERT_EQ(::pipe(pipe_ends), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) edit_until_killed(plan_, next, pipe_ends[1]);
    ::close(pipe_ends[1]);
    ::usleep(static_cast<useconds_t>(random() % span_us));
    ::kill(child, SIGKILL);
    int status = 0, told = 0, last = next - 1;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the editor ended by itself with " << WEXITSTATUS(status);
    while (::read(pipe_ends[0], &told, sizeof told) == sizeof told) last = told;
    ::close(pipe_ends[0]);
    killed_late += last >= next;
    if (2 * killed_late <= kill) span_us = std::min(span_us + span_us / 4, 1000000u);
    const PlanHistory history(plan_);
    const std::string text = history.text();
    ASSERT_EQ(file(), text) << "after kill " << kill;
    const int found = nlohmann::json::parse(text).at("steps")[0].at("low").get<int>();
    // Edits whose numbers were printed exist; the one that was being made may exist; the last action may have
    // been an undo of it.
    ASSERT_GE(found, last - 0) << "after kill " << kill;
    ASSERT_LE(found, last + 1) << "after kill " << kill;
    next = found + 1;
  }
  EXPECT_GT(killed_late, kills / 4) << "most kills came before the first edit";
}

/// The number of bytes that this process has read from files; none if the system does not count them.
std::optional<std::int64_t> bytes_read() {
  std::ifstream counts("/proc/self/io");
  std::string name;
  std::int64_t count = 0;
  if (counts >> name >> count && name == "rchar:") return count;
  return std::nullopt;
}

/// Makes a history of two edits one of a hundred thousand, those that are added with the first's text.
void add_edits(const fs::path& plan) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(PlanHistory::path_of(plan).c_str(), &database), SQLITE_OK);
  ASSERT_EQ(
      sqlite3_exec(
          database,
          "WITH RECURSIVE n(i) AS (SELECT 3 UNION ALL SELECT i + 1 FROM n WHERE i < 100000) "
          "INSERT INTO edits SELECT i, i - 1, 'edit', '', (SELECT sum FROM edits WHERE id = 1), 0, 0, 0, "
          "(SELECT middle FROM edits WHERE id = 1) FROM n",
          nullptr, nullptr, nullptr),
      SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

TEST_F(History, AHundredThousandEditsOpenWithoutBeingRead) {
  { PlanHistory(plan_).record(plan_text(1), "one"); }
  add_edits(plan_);
  const auto kept = static_cast<std::int64_t>(fs::file_size(PlanHistory::path_of(plan_)));
  const std::optional<std::int64_t> before = bytes_read();
  const PlanHistory history(plan_);
  EXPECT_EQ(history.edit_count(), 100000);
  EXPECT_EQ(history.newest(50).size(), 50u);
  if (!before) GTEST_SKIP() << "this system does not count what is read";
  const std::int64_t read = *bytes_read() - *before;
  EXPECT_GT(read, 0) << "nothing is counted";
  EXPECT_LT(read, kept / 64);
}

TEST_F(History, AHundredThousandStatesBelowTheEndRedoReadsTheWayOnce) {
  { PlanHistory(plan_).record(plan_text(1), "one"); }
  add_edits(plan_);
  const auto kept = static_cast<std::int64_t>(fs::file_size(PlanHistory::path_of(plan_)));
  PlanHistory history(plan_);
  history.go_to("100000");
  history.begin_branch("long");
  history.go_to("2");
  ASSERT_TRUE(history.redo());
  const std::optional<std::int64_t> before = bytes_read();
  for (int number = 4; number < 14; ++number) {
    ASSERT_TRUE(history.redo());
    ASSERT_EQ(history.current(), number);
  }
  if (!before) GTEST_SKIP() << "this system does not count what is read";
  EXPECT_LT(*bytes_read() - *before, kept);
}

}  // namespace
}  // namespace octotomy::planner
