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

/// The open plan with its history. Every change is on disk when its function returns. Only one thread at a
/// time may use it.
class Document {
 public:
  /// Opens a plan's file. Changes may name files only in `folders`, which must outlive this object. Throws as
  /// read_plan() and PlanHistory do.
  Document(const std::filesystem::path& path, const Folders& folders);

  const std::filesystem::path& path() const { return path_; }
  std::shared_ptr<const Plan> plan() const { return plan_; }
  Json json() const { return Json::parse(plan_->text); }

  /// A state of the history as a plan. Throws as parsed() does, and std::runtime_error if there is none.
  Plan plan_at(std::int64_t edit) const;
  /// The plan of another file, for a comparison. Throws as read_plan() does; voxel::Error, Input, if it reads files in no open
  /// folder.
  Plan other(const std::filesystem::path& path) const;
  /// Parses JSON as a plan of this document's folder without recording it. Throws as parse_plan() does;
  /// voxel::Error, Input, if a scan or a file that a step reads is in no open folder.
  Plan parsed(const Json& json) const;
  /// The plan with further steps at its end, without recording it.
  Plan with_steps(const Json& steps) const;

  /// Changes the plan by a request "edit": "steps" replaces the whole list; "add": {"step", "after"},
  /// "replace": {"id", "step"} and "remove": an id; "scans", "universe" and "name" as in plans; "landmarks":
  /// points by {"name", "point"}. Throws std::runtime_error if the result is not a valid plan; then nothing
  /// is changed.
  void edit(const Json& said);
  /// Adds a landmark at [x, y, z], or moves the existing one of this name.
  void place_landmark(const std::string& name, const Json& point_mm);
  /// Replaces the plan by another one; the edit's description is `what`.
  void record(const Json& json, const std::string& what);
  /// Throws std::runtime_error if another program has changed the plan's file.
  void need_saved() { history_->need_no_other_writer(); }
  /// Throw as parsed() does if the other state reads files in no open folder; then nothing is changed.
  bool undo();
  bool redo();
  void go_to(const std::string& where);
  void begin_branch(const std::string& name);
  void name_version(const std::string& name);
  /// What differs between two states, given by number: as to_json() of a PlanDifference, and "rows": its text
  /// line by line.
  Json difference_of(std::int64_t a, std::int64_t b) const;

  /// "branch", "edit", "can_undo", "can_redo", "history", "branches".
  Json history_json() const;

 private:
  /// Parses a text as a plan of this document's folder and checks the files that it reads, because the
  /// history, like the plan, may come from others.
  Plan readable(const std::string& text) const;
  void read_again();
  /// Makes another state of the history current; keeps the present one if the other reads forbidden files.
  template <typename Move>
  void move(const Move& to);

  std::filesystem::path path_;
  const Folders& folders_;
  std::unique_ptr<PlanHistory> history_;
  std::shared_ptr<const Plan> plan_;
};

}  // namespace octotomy::planner::serve
