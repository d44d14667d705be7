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

/// Thrown if another program has changed a plan's file or its history. The history must be opened again.
struct OtherWriter : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A state in the history of a plan.
struct PlanEdit {
  std::int64_t id = 0;
  std::optional<std::int64_t> parent;  ///< none: the first
  std::string what;                    ///< description of the edit for users
  std::string made_at;                 ///< UTC, "2026-01-31T12:00:00Z"
  std::vector<std::string> names;      ///< names of versions
};

/// The history of a plan's file, in a database beside it: recorded states, undo, redo, branches and named
/// versions. Recorded states are never deleted. The plan's file always contains the text of the current
/// state, so that other programs can read it.
///
/// A process may be killed at any time. The next process that opens the history finds every edit whose
/// record() has returned, and makes the plan's file agree with it. Between edits the history is one complete
/// file that can be copied. Several processes may open a history. If one has made a change, the others are
/// refused at their next change and must open the history again.
///
/// If the plan's file is a link, the history belongs to the file behind it. The history has the permissions
/// of that file.
///
/// Members throw std::runtime_error with path and reason if the file is no database, is damaged or of a newer
/// version, or if a name is unknown; OtherWriter if another program has made a change; voxel::Error,
/// Resource, if the disk is full or fails. Cost: an edit stores its difference from the previous state and
/// syncs the disk a few times. The cost of opening does not depend on the number of edits.
class PlanHistory {
 public:
  enum class Access { Write, Read };
  /// Opens the history of a plan's file. If there is none, begins one whose first edit is the file's text. If
  /// another program has changed the file, its text becomes the edit "changed outside". With Access::Read
  /// nothing is written: the history must exist, and only recorded states can be read.
  explicit PlanHistory(const std::filesystem::path& plan, Access access = Access::Write);
  ~PlanHistory();
  PlanHistory(const PlanHistory&) = delete;
  PlanHistory& operator=(const PlanHistory&) = delete;

  /// The path of a plan's history: beside the plan's file or, if that is a link, beside the file behind it.
  static std::filesystem::path path_of(const std::filesystem::path& plan);

  /// Whether permissions allow writing the history of a plan's file, or creating it in its folder.
  static bool can_write(const std::filesystem::path& plan);

  /// Records a text as a new state after the current one, and makes it current. Returns the number of the
  /// current state. A text equal to the current one is not recorded.
  std::int64_t record(const std::string& text, const std::string& what);
  /// Throws OtherWriter if another program has changed the plan's file or its history.
  void need_no_other_writer();
  /// Makes the state before the current one current. Returns false if there is none.
  bool undo();
  /// Makes the next state on the current branch current. Returns false if there is none.
  bool redo();
  /// Whether undo() and redo() would return true. Cost of can_redo(): at the first call linear in the states
  /// up to the branch's end, then constant.
  bool can_undo() const;
  bool can_redo() const;
  /// Makes a state current. `where` is its number, or the name of a version or a branch. Throws if there is
  /// none, with the most similar name.
  void go_to(const std::string& where);
  /// Begins a branch at the current state and makes it the current branch. Throws if the name is taken,
  /// begins with a digit, has more than 200 bytes or contains a control character.
  void begin_branch(const std::string& name);
  /// Gives the current state a name. Throws as begin_branch() does.
  void name_version(const std::string& name);

  std::int64_t current() const;
  std::string branch() const;
  std::string text() const;  ///< text of the current state
  std::string text_of(std::int64_t edit) const;
  std::int64_t edit_count() const;
  std::vector<PlanEdit> newest(std::int64_t most) const;  ///< newest first
  /// The branches and the state at the end of each.
  std::vector<std::pair<std::string, std::int64_t>> branches() const;

 private:
  class Database;
  std::unique_ptr<Database> database_;
};

}  // namespace octotomy::planner
