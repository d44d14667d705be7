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

/// Another program has changed a plan's file or its history, which must be opened again.
struct OtherWriter : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One state of a plan's text.
struct PlanEdit {
  std::int64_t id = 0;
  std::optional<std::int64_t> parent;  ///< none: the first
  std::string what;                    ///< description of the edit, to show to users
  std::string made_at;                 ///< UTC, "2026-01-31T12:00:00Z"
  std::vector<std::string> names;      ///< names of versions
};

/// The history of a plan's file, in a database beside it: all recorded states, undo, redo, branches and named
/// versions. Recorded states are never deleted. The plan's file always contains the current state's text, so
/// that other programs can read it.
///
/// A process may be killed at any time: the next one that opens the history finds every edit whose record()
/// returned, and the plan's file is complete, as of that edit. Between edits the history is complete in one
/// file, so that a copy of it has all edits. Several processes may open a history; a process whose state is
/// no longer the current one is refused when it writes, and must open the history again.
///
/// If the plan is a link, the history belongs to the file behind it. The history has the permissions of that
/// file.
///
/// Members throw std::runtime_error with path and reason if the file is not a database, is damaged or of a
/// newer version, or a name is unknown; OtherWriter if another program has written first; voxel::Error,
/// Resource, if the disk is full or fails. Cost: an edit stores its difference and syncs the disk a few
/// times; the cost of opening does not depend on the number of edits.
class PlanHistory {
 public:
  enum class Access { Write, Read };
  /// Opens the history of a plan's file, or begins one with its text as the first edit. If another program
  /// has changed the file since, its text becomes an edit of its own, "changed outside". With Access::Read
  /// nothing is written: a history must exist, and only recorded states can be read.
  explicit PlanHistory(const std::filesystem::path& plan, Access access = Access::Write);
  ~PlanHistory();
  PlanHistory(const PlanHistory&) = delete;
  PlanHistory& operator=(const PlanHistory&) = delete;

  /// The path of a plan's history: beside the plan's file or, for a link, beside the file behind it.
  static std::filesystem::path path_of(const std::filesystem::path& plan);

  /// Whether the permissions of folder and file allow creating or writing the history of a plan's file.
  static bool can_write(const std::filesystem::path& plan);

  /// Records a text as the new current state, after the present one. An unchanged text is not recorded.
  std::int64_t record(const std::string& text, const std::string& what);
  /// Throws if another program has changed the plan's file or its history since.
  void need_no_other_writer();
  /// Makes the state before the current one current; false if the current one is the first.
  bool undo();
  /// Makes the next state on the current branch current; false if there is none.
  bool redo();
  /// Whether undo() and redo() would succeed. Cost of can_redo(): linear in the states up to the branch's end
  /// at the first call, constant afterwards.
  bool can_undo() const;
  bool can_redo() const;
  /// Makes a state current, by its number or the name of a version or branch. Throws if there is none, with
  /// the nearest name.
  void go_to(const std::string& where);
  /// Begins a branch at the current state and switches to it. Throws if the name is taken, begins with a
  /// digit, is longer than 200 bytes or has a control character.
  void begin_branch(const std::string& name);
  /// Names the current state. Throws as begin_branch() does.
  void name_version(const std::string& name);

  std::int64_t current() const;
  std::string branch() const;
  std::string text() const;  ///< text of the current state
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
