// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "planner/browser/server/document.h"
#include "planner/browser/server/folders.h"
#include "planner/browser/server/message.h"
#include "planner/plan/evaluate.h"

namespace octotomy::planner::serve {

/// The stop token and progress function of a task, and what the window that requested it may do.
struct Watched {
  std::stop_token stop;
  std::function<void(const std::string& doing, double share)> progress;
  Access access = Access::Edit;
};

/// The last evaluation of a plan. It is immutable, so that pictures can be drawn from it while the plan
/// changes.
struct Snapshot {
  std::shared_ptr<const Plan> plan;
  std::shared_ptr<const Evaluation> evaluation;
  std::map<std::string, std::string> errors;  ///< of the steps that could not be evaluated
  std::map<std::string, double> bone_lows;    ///< bone_low() of each scan
  Json measurements = Json::array();          ///< of the plan's steps that measure
};

/// Whether a path is a plan, by its name; any other path counts as a scan.
bool is_plan(const std::filesystem::path& path);

/// The plan that all windows edit, with its objects and its files. All members may be called from any thread.
class Session {
 public:
  explicit Session(std::filesystem::path working_folder);

  Folders folders;
  ObjectCache cache;

  const std::filesystem::path& working_folder() const { return working_folder_; }
  /// Opens a plan, or a scan with a plan of its own (new_plan.h), and closes the open one. `series` as in
  /// voxel::ReadOptions; a plan states its own.
  void open(const std::filesystem::path& path, const Watched& watched, const std::string& series = {});

  /// Closes the document after the current edit has ended, so that its history is complete. Does nothing if
  /// that takes longer than `most`.
  void close_within(std::chrono::milliseconds most);

  /// Calls `work` with exclusive access to the document and returns its result. Throws voxel::Error, Input,
  /// if no document is open.
  template <typename Work>
  auto with_document(const Work& work) const {
    const std::lock_guard lock(mutex_);
    return work(need_document());
  }

  /// Evaluates steps of the plan and those on which they depend; all steps if none are named. Without
  /// `certify`, only in voxels, and unknown names are ignored. The result becomes the snapshot, unless
  /// `certify` is set for named steps, or another plan was opened or certified meanwhile. A step that cannot
  /// be evaluated is left out, with those that depend on it. Throws Stopped, and exceptions of evaluate()
  /// that no step has caused.
  Snapshot evaluate(const std::vector<std::string>& steps, bool certify, const Watched& watched);
  /// Evaluates another plan, which does not become the snapshot; `only_look_up` as in EvaluateOptions.
  Evaluation evaluate(const Plan& plan, const std::vector<std::string>& steps, bool certify,
                      const Watched& watched, bool only_look_up = false);
  Snapshot snapshot() const;

  /// A scan in a universe around itself, for example a donor's, which lies elsewhere than the patient's.
  /// Caches the newest one.
  voxel::GreyOctree alone(const Snapshot& snapshot, const std::string& scan);

  /// An object after a change that is not in the plan, in voxels only: moved, or made by further steps; and
  /// its overlap with other objects, or its difference to one.
  struct Preview {
    std::shared_ptr<const Evaluation> evaluation;
    static constexpr const char* moved = "dragged_piece";
    static constexpr const char* overlap = "dragged_overlap";
    /// Names of three volumes: inside the object only, inside the other object only, and inside both.
    static constexpr const char* only_moved = "dragged_only_moved";
    static constexpr const char* only_other = "dragged_only_other";
    static constexpr const char* common = "dragged_common";

    /// The changed object; null without an evaluation.
    const Object* object() const;
  };
  /// Sets "preview" of a picture's header: the changed object's volume, voxels and findings.
  static void describe(const Preview& preview, Json& header);
  /// `asked` is {"object", "of", "move"}: `of`, or else `object`, moved as by a step "move"; or {"steps"}:
  /// the last of steps that follow the plan's. With "coarse", a universe of many voxels is replaced by a
  /// coarser one. "difference" names an object of the plan; `with` is not read then.
  Preview preview(const Json& asked, const std::vector<std::string>& with, const std::stop_token& stop);

  /// The plan's state for a page; null if none is open.
  Json state() const;
  /// The state of one object for a page.
  Json object_json(const Snapshot& snapshot, const std::string& id) const;

 private:
  Document& need_document() const;
  Json objects_json(const Plan& plan) const;
  /// bone_low() of each scan that was read, computed again where the scan was read anew. Calls wait for each
  /// other; the session's own lock is not held meanwhile.
  std::map<std::string, double> bone_lows_of(const Evaluation& evaluation);
  /// Stores the certificates, sizes and measurements of objects evaluated in both kernels, by the keys of
  /// their steps.
  void keep_certified(const Plan& plan, const Evaluation& evaluation, const Json& measurements);
  /// Replaces measurements by those of the same steps that were evaluated in both kernels.
  void put_certified(const Plan& plan, Json& measurements) const;

  std::filesystem::path working_folder_;
  mutable std::timed_mutex mutex_;  ///< protects the members down to `certified_`
  std::unique_ptr<Document> document_;
  std::uint64_t opened_ = 0;  ///< number of documents opened so far; results of an earlier one are discarded
  Snapshot snapshot_;
  /// The certified results of a step, and the key by which the session recognises that they belong to the
  /// current plan.
  struct Certified {
    std::string key;
    Json said;  ///< of an object "certificate", "necks", "volume", "area"; of another step its measurement
  };
  std::map<std::string, Certified> certified_;

  std::mutex bone_mutex_;
  std::map<std::string, std::pair<std::weak_ptr<const voxel::Scene>, double>> bone_lows_;

  std::mutex alone_mutex_;
  std::optional<std::pair<std::shared_ptr<const voxel::Scene>, voxel::GreyOctree>> alone_;

  std::mutex preview_mutex_;
  /// Previews by the text of their plans, newest last. They are cached because the panes of one window
  /// request the same preview.
  std::deque<std::pair<std::string, Preview>> previews_;
};

}  // namespace octotomy::planner::serve
