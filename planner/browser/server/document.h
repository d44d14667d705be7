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

/// The plan that is open, with its history: every change is on the disk when its function returns. One thread
/// at a time may use it.
class Document {
 public:
  /// Opens a plan's file; `folders` are those that a change may name, and live longer. Throws as read_plan()
  /// and PlanHistory.
  Document(const std::filesystem::path& path, const Folders& folders);

  const std::filesystem::path& path() const { return path_; }
  std::shared_ptr<const Plan> plan() const { return plan_; }
  Json json() const { return Json::parse(plan_->text); }

  /// A text as a plan of this document's folder, which is not recorded. Throws as parse_plan(); voxel::Error,
  /// Input, where a scan or a file that a step reads lies in no open folder.
  Plan parsed(const Json& json) const;
  /// The plan with further steps at its end, which is not recorded.
  Plan with_steps(const Json& steps) const;

  /// Changes the plan as a request "edit" says: "steps" the whole list; "add": {"step", "after"}, "replace":
  /// {"id", "step"} and "remove": an id; "scans", "universe" and "name" as in plans; "landmarks": points by
  /// {"name", "point"}. Throws std::runtime_error where what comes of it is no plan; then nothing is changed.
  void edit(const Json& said);
  /// Names a point [x, y, z], or puts a named one elsewhere.
  void place_landmark(const std::string& name, const Json& point_mm);
  /// Puts a plan in the place of this one, as an edit of that name.
  void record(const Json& json, const std::string& what);
  /// Throws std::runtime_error where the plan's file is no longer this plan: another program wrote it.
  void need_saved() { history_->need_no_other_writer(); }
  /// Throw as parsed() where the state reads what lies in no open folder; then nothing is changed.
  bool undo();
  bool redo();
  void go_to(const std::string& where);
  void begin_branch(const std::string& name);
  void name_version(const std::string& name);
  /// The lines by which two states differ; each by its number.
  Json difference_of(std::int64_t a, std::int64_t b) const;

  /// "branch", "edit", "can_undo", "can_redo", "history", "branches".
  Json history_json() const;

 private:
  /// A text as a plan of this document's folder that reads what it may: the history may come from others,
  /// as the plan may.
  Plan readable(const std::string& text) const;
  void read_again();
  /// Makes another state of the history the current one; stays at the present one where that may not be read.
  template <typename Move>
  void move(const Move& to);

  std::filesystem::path path_;
  const Folders& folders_;
  std::unique_ptr<PlanHistory> history_;
  std::shared_ptr<const Plan> plan_;
};

}  // namespace octotomy::planner::serve
