// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "planner/browser/server/folders.h"
#include "planner/browser/server/message.h"
#include "planner/plan/history.h"
#include "planner/plan/plan.h"

namespace octotomy::planner::serve {

/// The open plan and its history. A function that changes the plan has written the change to disk when it
/// returns. Only one thread at a time may use it.
class Document {
 public:
  /// Opens a plan's file. All files that the plan names must be in `folders`, which must outlive this object.
  /// Throws as read_plan() and PlanHistory do.
  Document(const std::filesystem::path& path, const Folders& folders);

  const std::filesystem::path& path() const { return path_; }
  std::shared_ptr<const Plan> plan() const { return plan_; }
  Json json() const { return Json::parse(plan_->text); }

  /// A state of the history as a plan. Throws as parsed() does, and std::runtime_error if the history has no
  /// such state.
  Plan plan_at(std::int64_t edit) const;
  /// The plan of another file, for a comparison. Throws as read_plan() does; voxel::Error, Input, if the plan
  /// reads a file in no open folder.
  Plan other(const std::filesystem::path& path) const;
  /// Parses JSON as a plan in this document's folder, without recording it. Throws as parse_plan() does;
  /// voxel::Error, Input, if a scan or a file of a step is in no open folder.
  Plan parsed(const Json& json) const;
  /// The present plan with `steps` at its end. Records nothing.
  Plan with_steps(const Json& steps) const;

  /// Changes the plan by a request "edit". "steps" replaces the whole list; "add": {"step", "after"} and
  /// "replace": {"id", "step"} change one step; "remove" is the id of a step; "scans", "universe" and "name"
  /// are as in plans; "landmarks" are points {"name", "point"}. Throws std::runtime_error and changes nothing
  /// if the result is not a valid plan.
  void edit(const Json& said);
  /// Adds a landmark at [x, y, z] in mm, or moves the landmark of this name.
  void place_landmark(const std::string& name, const Json& point_mm);
  /// Replaces the plan and records this as an edit; `what` describes it in the history.
  void record(const Json& json, const std::string& what);
  /// Throws std::runtime_error if another program has changed the plan's file.
  void need_saved() { history_->need_no_other_writer(); }
  /// Each makes another state of the history current. Throw as parsed() does, and change nothing, if that
  /// state reads files in no open folder.
  bool undo();
  bool redo();
  void go_to(const std::string& where);
  void begin_branch(const std::string& name);
  void name_version(const std::string& name);
  /// The differences between the states of two edits: to_json() of the PlanDifference, and in "rows" its text
  /// line by line.
  Json difference_of(std::int64_t a, std::int64_t b) const;

  /// {"branch", "edit", "can_undo", "can_redo", "history", "branches"}, with the newest edits only.
  Json history_json() const;

 private:
  /// Parses a text as a plan in this document's folder and checks that all its files may be read. Needed for
  /// states of the history too, because others may have written it.
  Plan readable(const std::string& text) const;
  void read_again();
  /// Makes another state of the history current. Restores the present state if the other one reads forbidden
  /// files.
  template <typename Move>
  void move(const Move& to);

  std::filesystem::path path_;
  const Folders& folders_;
  std::unique_ptr<PlanHistory> history_;
  std::shared_ptr<const Plan> plan_;
};

}  // namespace octotomy::planner::serve
