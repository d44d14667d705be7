// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace octotomy::planner {

/// Another program has changed a plan's file or its history: it has to be opened again.
struct OtherWriter : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One state of a plan's text.
struct PlanEdit {
  std::int64_t id = 0;
  std::optional<std::int64_t> parent;  ///< none: the first
  std::string what;                    ///< what was done, for people
  std::string made_at;                 ///< UTC, "2026-01-31T12:00:00Z"
  std::vector<std::string> names;      ///< of versions
};

/// The history of a plan's file, in a database beside it: every state that was recorded, undo, redo, branches
/// and named versions. Nothing that was recorded is ever lost. The plan's file is always the current state's
/// text, so that other programs read it as before.
///
/// A process may be killed at any instant: the next one that opens the history finds every edit whose
/// record() returned, and the plan's file is whole, as of that edit. Between edits the history is whole in
/// its one file, so that a copy of it has all of them. Several processes may hold a history; one whose state
/// is no longer the current one is refused when it writes, and reads again.
///
/// A plan that is a link is the file behind it, and its permissions are its history's too.
///
/// Members throw std::runtime_error with path and reason where the database is none, damaged or of a newer
/// version, or a name is unknown; OtherWriter where another writer came first; voxel::Error, Resource, where
/// the disk gives out. Cost: an edit stores what it changed and a few syncs of the disk; opening does not
/// depend on the number of edits.
class PlanHistory {
 public:
  enum class Access { Write, Read };
  /// Opens the history of a plan's file, or begins one with its text as the first edit. A file that was
  /// changed since by another program becomes an edit of its own, "changed outside". With Access::Read
  /// nothing is written: only what is recorded can be asked, and there must be a history.
  explicit PlanHistory(const std::filesystem::path& plan, Access access = Access::Write);
  ~PlanHistory();
  PlanHistory(const PlanHistory&) = delete;
  PlanHistory& operator=(const PlanHistory&) = delete;

  /// Where the history of a plan's file lies: beside it, or beside the file behind the link that it is.
  static std::filesystem::path path_of(const std::filesystem::path& plan);

  /// Whether the history of a plan's file can be begun or written, by the permissions of folder and file.
  static bool can_write(const std::filesystem::path& plan);

  /// Makes a text the current state, after the present one. The same text is no edit.
  std::int64_t record(const std::string& text, const std::string& what);
  /// Throws where another program has changed the plan's file or its history since.
  void need_no_other_writer();
  /// The state before the current one becomes current; false where that is the first.
  bool undo();
  /// The state on the current branch that undo() left; false where there is none.
  bool redo();
  /// Whether undo() and redo() find a state. Cost of can_redo(): the first time linear in the states up to
  /// the branch's end, later constant.
  bool can_undo() const;
  bool can_redo() const;
  /// A state, by its number, the name of a version or of a branch, becomes current. Throws where there is
  /// none, with the nearest name.
  void go_to(const std::string& where);
  /// Begins a branch at the current state, and is on it from then on. Throws where the name is taken, begins
  /// with a digit, is longer than 200 bytes or has a control character.
  void begin_branch(const std::string& name);
  /// Names the current state. Throws as begin_branch().
  void name_version(const std::string& name);

  std::int64_t current() const;
  std::string branch() const;
  std::string text() const;  ///< of the current state
  std::string text_of(std::int64_t edit) const;
  std::int64_t edit_count() const;
  std::vector<PlanEdit> newest(std::int64_t most) const;  ///< newest first
  /// Branches and the states at their ends.
  std::vector<std::pair<std::string, std::int64_t>> branches() const;

 private:
  class Database;
  std::unique_ptr<Database> database_;
};

}  // namespace octotomy::planner
