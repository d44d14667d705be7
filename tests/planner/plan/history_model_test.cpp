// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The protocol of history.cpp as a model, of which all reachable states are visited: two writers that record and
// undo, a program that writes the plan's file without a lock, and kills between any two steps. A second test runs
// the real history, and another process acts before each of its locks.
#include <algorithm>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <fcntl.h>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <set>
#include <sqlite3.h>
#include <string>
#include <sys/wait.h>
#include <type_traits>
#include <unistd.h>
#include <unordered_set>
#include <utility>
#include <vector>

#include "planner/plan/history.h"
#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// How step 2 of a change chooses the text that it writes.
enum class Settles { CurrentState, OwnState };

// A step of a writer. Locked steps hold the database's lock.
enum WriterStep : std::uint8_t { Closed, Idle, Settling, Reading, Writing, Committing };

struct ModelWriter {
  WriterStep step = Closed;
  std::uint8_t current = 0;  ///< the state that it believes to be current
  std::uint8_t read = 0;     ///< the text of the file as it read it
  std::uint8_t changes = 0;  ///< begun in all
  bool opening = false;      ///< whether it settles because it opens the history
};

constexpr int most_edits = 12;

/// Texts are numbers. ModelState 0 is none; the first state is 1, with text 0.
struct ModelState {
  std::uint8_t edits = 1, current = 1, written = 0, file = 0, texts = 1;
  std::uint8_t parent[most_edits + 1] = {}, text[most_edits + 1] = {};
  ModelWriter writers[2];
  std::uint8_t lock = 2;  ///< the writer that holds it; 2: none
  std::uint8_t saved = 0, reverted = 0, kills = 0;
  std::uint8_t outside = 0;   ///< the newest text of the outside program, 0: none
  bool is_settled = false;    ///< nobody wrote or was killed since file and state were made to agree
  std::uint8_t recorded = 0;  ///< the newest state whose record() returned, 0: none
};

static_assert(std::has_unique_object_representations_v<ModelState>);

std::string key(const ModelState& state) {
  return {reinterpret_cast<const char*>(&state), sizeof state};
}

struct ModelLimits {
  int changes, saves, reverts, kills;
};

bool has_text(const ModelState& state, std::uint8_t text) {
  return std::find(state.text + 1, state.text + 1 + state.edits, text) != state.text + 1 + state.edits;
}

/// What is wrong with a state; empty if nothing is.
std::string fault(const ModelState& state) {
  if (state.outside != 0 && state.file != state.outside && !has_text(state, state.outside))
    return "a text that another program saved is lost";
  const bool is_quiet = std::all_of(state.writers, state.writers + 2,
                                    [](const ModelWriter& writer) { return writer.step <= Idle; });
  if (is_quiet && state.is_settled && state.file != state.text[state.current])
    return "the plan's file is not the current state's";
  if (state.recorded > state.edits) return "a recorded state is lost";
  return {};
}

class ProtocolModel {
 public:
  ProtocolModel(Settles settles, ModelLimits limits) : settles_(settles), limits_(limits) {}

  /// Visits all states; returns the first fault, or none.
  std::string check() {
    visit(ModelState{});
    while (!waiting_.empty()) {
      const ModelState state = waiting_.front();
      waiting_.pop_front();
      if (std::string found = fault(state); !found.empty()) return found;
      for (std::uint8_t who = 0; who < 2; ++who) advance(state, who);
      act_outside(state);
    }
    return {};
  }
  std::size_t states() const { return seen_.size(); }

 private:
  void visit(const ModelState& state) {
    if (seen_.insert(key(state)).second) waiting_.push_back(state);
  }

  static void add_edit(ModelState& state, std::uint8_t text) {
    ++state.edits;
    state.parent[state.edits] = state.current;
    state.text[state.edits] = text;
    state.current = state.edits;
  }

  void advance(const ModelState& before, std::uint8_t who) {
    const ModelWriter& writer = before.writers[who];
    const auto next = [&](const auto& act) {
      ModelState state = before;
      act(state, state.writers[who]);
      visit(state);
    };
    if (writer.step != Closed && before.kills < limits_.kills)
      next([&](ModelState& state, ModelWriter& killed) {
        // The database undoes what was not committed.
        if (killed.step > Idle) state.is_settled = false;
        const std::uint8_t changes = killed.changes;
        killed = ModelWriter{};
        killed.changes = changes;
        if (state.lock == who) state.lock = 2;
        ++state.kills;
      });
    switch (writer.step) {
      case Closed:
        next([](ModelState&, ModelWriter& opened) { opened.step = Settling, opened.opening = true; });
        break;
      case Idle:
        if (before.lock == 2 && writer.changes < limits_.changes && before.edits + 4 < most_edits) {
          next([&](ModelState& state, ModelWriter& changing) { change(state, changing, true); });
          if (before.parent[writer.current] != 0)
            next([&](ModelState& state, ModelWriter& changing) { change(state, changing, false); });
        }
        break;
      case Settling:
        if (before.lock == 2)
          next([&](ModelState& state, ModelWriter& settling) {
            state.lock = who;
            settling.read = state.file;
            settling.step = Reading;
          });
        break;
      case Reading:
        next([&](ModelState& state, ModelWriter& settling) { write(state, settling); });
        break;
      case Writing:
      case Committing:
        next([&](ModelState& state, ModelWriter& settling) { commit(state, settling); });
        break;
    }
  }

  /// WriterStep 1, one transaction: a new text, or the state before.
  static void change(ModelState& state, ModelWriter& writer, bool records) {
    ++writer.changes;
    const bool is_refused = state.current != writer.current ||
                            (state.file != state.written && state.file != state.text[state.current]);
    if (is_refused) {
      writer.step = Closed;  // it must open the history again
      return;
    }
    if (records) {
      add_edit(state, state.texts);
      ++state.texts;
    } else {
      state.current = state.parent[state.current];
    }
    writer.current = state.current;
    writer.step = Settling;
    writer.opening = false;
  }

  /// WriterStep 2: the file. No other program writes between reading and writing it, which are next to each other.
  void write(ModelState& state, ModelWriter& writer) const {
    const std::uint8_t target = target_of(state, writer);
    const bool is_due = !is_outside(state, writer) && writer.read != state.text[target];
    if (is_due) state.file = state.text[target];
    state.is_settled = true;
    writer.step = is_due ? Writing : Committing;
  }

  /// WriterStep 3, the end of the transaction.
  void commit(ModelState& state, ModelWriter& writer) const {
    const bool adds = is_outside(state, writer);
    if (adds) add_edit(state, writer.read);
    state.written = state.text[adds ? state.current : target_of(state, writer)];
    if (writer.opening) writer.current = state.current;
    if (!writer.opening) state.recorded = std::max(state.recorded, writer.current);
    writer.step = Idle;
    state.lock = 2;
  }

  std::uint8_t target_of(const ModelState& state, const ModelWriter& writer) const {
    return settles_ == Settles::CurrentState || writer.opening ? state.current : writer.current;
  }
  bool is_outside(const ModelState& state, const ModelWriter& writer) const {
    if (settles_ == Settles::OwnState && !writer.opening) return false;
    return writer.read != state.written && writer.read != state.text[state.current];
  }

  /// A program that knows nothing of the history saves a new text, or an old one again.
  void act_outside(const ModelState& before) {
    const bool is_reading = std::any_of(before.writers, before.writers + 2,
                                        [](const ModelWriter& writer) { return writer.step == Reading; });
    if (is_reading) return;
    if (before.saved < limits_.saves) {
      ModelState state = before;
      state.file = state.outside = state.texts++;
      ++state.saved;
      state.is_settled = false;
      visit(state);
    }
    if (before.reverted < limits_.reverts && before.file != before.text[1]) {
      ModelState state = before;
      state.file = state.text[1];
      // The program replaces a text that it saved itself, so that text need not survive.
      state.outside = 0;
      ++state.reverted;
      state.is_settled = false;
      visit(state);
    }
  }

  Settles settles_;
  ModelLimits limits_;
  std::unordered_set<std::string> seen_;
  std::deque<ModelState> waiting_;
};

TEST(HistoryModel, NoOrderOfTwoWritersAnOutsideProgramAndKillsLosesAPlan) {
  ProtocolModel model(Settles::CurrentState, {.changes = 2, .saves = 2, .reverts = 1, .kills = 1});
  EXPECT_EQ(model.check(), "");
  EXPECT_GT(model.states(), 1'000'000U);
}

TEST(HistoryModel, FindsAWriterThatWritesItsOwnStateOverANewerOne) {
  ProtocolModel model(Settles::OwnState, {.changes = 1, .saves = 0, .reverts = 0, .kills = 0});
  EXPECT_EQ(model.check(), "the plan's file is not the current state's");
}

TEST(HistoryModel, FindsAWriterThatWritesItsOwnStateOverAnOutsideText) {
  ProtocolModel model(Settles::OwnState, {.changes = 1, .saves = 1, .reverts = 0, .kills = 0});
  EXPECT_EQ(model.check(), "a text that another program saved is lost");
}

/// Calls a function before each lock that this process acquires while it exists, counted from 1.
class BeforeLocks {
 public:
  explicit BeforeLocks(std::function<void(int)> act) {
    action = std::move(act);
    count = 0;
    if (original == nullptr)
      original = reinterpret_cast<int (*)(int, int, ...)>(system()->xGetSystemCall(system(), "fcntl"));
    system()->xSetSystemCall(system(), "fcntl", reinterpret_cast<sqlite3_syscall_ptr>(&hooked));
  }
  ~BeforeLocks() {
    system()->xSetSystemCall(system(), "fcntl", reinterpret_cast<sqlite3_syscall_ptr>(original));
    action = nullptr;
  }
  BeforeLocks(const BeforeLocks&) = delete;
  BeforeLocks& operator=(const BeforeLocks&) = delete;

 private:
  static sqlite3_vfs* system() { return sqlite3_vfs_find(nullptr); }
  static int hooked(int file, int command, ...) {
    va_list more;
    va_start(more, command);
    void* const argument = va_arg(more, void*);
    va_end(more);
    // The first lock of every transaction is a shared one of this byte (SQLite's PENDING_BYTE).
    constexpr off_t pending_byte = 0x40000000;
    const auto* const lock = static_cast<const struct flock*>(argument);
    if (command == F_SETLK && lock->l_type == F_RDLCK && lock->l_start == pending_byte) action(++count);
    return original(file, command, argument);
  }
  static inline std::function<void(int)> action;
  static inline int count = 0;
  static inline int (*original)(int, int, ...) = nullptr;
};

/// A process that waits for a word, acts once and says so. It begins before this process opens a database,
/// because SQLite shares locks between the connections of one process.
class OtherProcess {
 public:
  explicit OtherProcess(const std::function<void()>& act) {
    int to_child[2], to_parent[2];
    if (pipe(to_child) != 0 || pipe(to_parent) != 0) std::abort();
    child_ = fork();
    if (child_ == 0) {
      char word = 0;
      close(to_child[1]);
      if (read(to_child[0], &word, 1) == 1) {
        try {
          act();
        } catch (const std::exception&) {
          word = 'r';  // refused
        }
        if (write(to_parent[1], &word, 1) != 1) _exit(1);
      }
      _exit(0);
    }
    close(to_child[0]);
    close(to_parent[1]);
    to_ = to_child[1], from_ = to_parent[0];
  }
  ~OtherProcess() {
    close(to_);
    close(from_);
    waitpid(child_, nullptr, 0);
  }
  OtherProcess(const OtherProcess&) = delete;
  OtherProcess& operator=(const OtherProcess&) = delete;

  /// Whether it could act; false also at a second call.
  bool act() const {
    char word = 'a';
    return write(to_, &word, 1) == 1 && read(from_, &word, 1) == 1 && word == 'a';
  }

 private:
  pid_t child_ = 0;
  int to_ = 0, from_ = 0;
};

void save(const fs::path& path, const std::string& text) {
  const fs::path beside = path.string() + ".saved";
  std::ofstream(beside) << text;
  fs::rename(beside, path);
}

std::set<std::string> texts_of(const PlanHistory& history) {
  std::set<std::string> texts;
  for (std::int64_t edit = 1; edit <= history.edit_count(); ++edit) texts.insert(history.text_of(edit));
  return texts;
}

/// Records "mine" while another process acts before the lock of this number; false if there are fewer locks.
bool record_while(int lock, const std::function<void(const fs::path&)>& other,
                  const std::string& others_text) {
  const tests::ScratchFolder folder;
  const fs::path plan = folder / "a.plan.json";
  std::ofstream(plan) << "first";
  const OtherProcess process([&] { other(plan); });
  bool has_acted = false, is_recorded = false;
  {
    PlanHistory history(plan);
    const BeforeLocks watch([&](int number) {
      if (number == lock) has_acted = process.act();
    });
    try {
      history.record("mine", "mine");
      is_recorded = true;
    } catch (const OtherWriter&) {
    }
  }
  if (!has_acted) return false;
  PlanHistory again(plan);
  EXPECT_EQ(tests::bytes_of(plan), again.text()) << "before lock " << lock;
  const std::set<std::string> texts = texts_of(again);
  EXPECT_TRUE(texts.contains(others_text)) << "before lock " << lock;
  EXPECT_EQ(texts.contains("mine"), is_recorded) << "before lock " << lock;
  return true;
}

int locks_held(const std::function<void(const fs::path&)>& other) {
  int lock = 1;
  while (record_while(lock, other, "theirs")) ++lock;
  return lock - 1;
}

TEST(HistoryInSteps, AnotherProcessThatRecordsBeforeAnyLockLosesNothing) {
  EXPECT_GE(locks_held([](const fs::path& plan) { PlanHistory(plan).record("theirs", "theirs"); }), 3);
}

TEST(HistoryInSteps, AProgramThatSavesThePlanBeforeAnyLockLosesNothing) {
  EXPECT_GE(locks_held([](const fs::path& plan) { save(plan, "theirs"); }), 3);
}

TEST(HistoryInSteps, TheFileIsTheNewestStateAsSoonAsBothHaveRecorded) {
  for (int lock = 1; lock <= 8; ++lock) {
    const tests::ScratchFolder folder;
    const fs::path plan = folder / "a.plan.json";
    std::ofstream(plan) << "first";
    const OtherProcess process([&] { PlanHistory(plan).record("theirs", "theirs"); });
    PlanHistory history(plan);
    {
      const BeforeLocks watch([&](int number) {
        if (number == lock) process.act();
      });
      try {
        history.record("mine", "mine");
      } catch (const OtherWriter&) {
      }
    }
    const std::string file = tests::bytes_of(plan);
    EXPECT_EQ(file, PlanHistory(plan).text()) << "before lock " << lock;
  }
}

}  // namespace
}  // namespace octotomy::planner
