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

/// The surroundings of a task: a stop token, a function that receives its progress, and the access of the
/// window that sent it.
struct Watched {
  std::stop_token stop;
  std::function<void(const std::string& doing, double share)> progress;
  Access access = Access::Edit;
};

/// An evaluation of the open plan. It never changes, so that pictures can be drawn from it while the plan is
/// edited.
struct Snapshot {
  std::shared_ptr<const Plan> plan;
  std::shared_ptr<const Evaluation> evaluation;
  std::map<std::string, std::string> errors;  ///< why steps could not be evaluated, by id
  std::map<std::string, double> bone_lows;    ///< bone_low() of each scan
  Json measurements = Json::array();          ///< results of the plan's measuring steps
};

/// Whether a path names a plan by its extension. Any other path counts as a scan.
bool is_plan(const std::filesystem::path& path);

/// The plan that all windows show, with its objects and files. All members may be called from any thread.
class Session {
 public:
  explicit Session(std::filesystem::path working_folder);

  Folders folders;
  ObjectCache cache;

  const std::filesystem::path& working_folder() const { return working_folder_; }
  /// Opens a plan, or makes and opens an initial plan of a scan (new_plan.h), and closes the plan that was
  /// open. `series` chooses the scan's series as in voxel::ReadOptions; a plan states its own.
  void open(const std::filesystem::path& path, const Watched& watched, const std::string& series = {});

  /// Closes the document once no edit is running, so that its history is complete on disk. Does nothing if an
  /// edit runs longer than `most`.
  void close_within(std::chrono::milliseconds most);

  /// Calls `work` with exclusive access to the document and returns its result. Throws voxel::Error, Input,
  /// if no document is open.
  template <typename Work>
  auto with_document(const Work& work) const {
    const std::lock_guard lock(mutex_);
    return work(need_document());
  }

  /// Evaluates steps of the plan and the steps on which they depend; all steps if `steps` is empty. Without
  /// `certify`, only in the voxel kernel, and unknown ids are ignored. A step that fails is left out, and so
  /// are the steps that need it. The result becomes the snapshot, except if `certify` is set and `steps` is
  /// not empty, if another plan was opened meanwhile, or if `certify` is set and the plan was changed
  /// meanwhile. Throws Stopped, and exceptions of evaluate() that no step has caused.
  Snapshot evaluate(const std::vector<std::string>& steps, bool certify, const Watched& watched);
  /// Evaluates another plan. The result does not become the snapshot. `only_look_up` as in EvaluateOptions.
  Evaluation evaluate(const Plan& plan, const std::vector<std::string>& steps, bool certify,
                      const Watched& watched, bool only_look_up = false);
  Snapshot snapshot() const;

  /// The octree of a scan in a universe around the scan itself, for a scan that lies in its own frame, such
  /// as a donor's. Caches the newest one.
  voxel::GreyOctree alone(const Snapshot& snapshot, const std::string& scan);

  /// An object that is not in the plan, by the voxel kernel: an object of the plan after a motion, or the
  /// result of further steps. Also its overlap with other objects, or its difference to one.
  struct Preview {
    std::shared_ptr<const Evaluation> evaluation;
    static constexpr const char* moved = "dragged_piece";
    static constexpr const char* overlap = "dragged_overlap";
    /// Names of three volumes: inside the object only, inside the other object only, and inside both.
    static constexpr const char* only_moved = "dragged_only_moved";
    static constexpr const char* only_other = "dragged_only_other";
    static constexpr const char* common = "dragged_common";

    /// The previewed object; null if nothing was evaluated.
    const Object* object() const;
  };
  /// Sets "preview" in a picture's header: volume, number of voxels and findings of the previewed object.
  static void describe(const Preview& preview, Json& header);
  /// Evaluates a preview. `asked` is {"object", "of", "move"}: the object "of", or else "object", after a
  /// motion as in a step "move"; or {"steps"}: the last of these steps, which follow those of the plan.
  /// "coarse" allows a coarser universe if the plan's has many voxels. "difference" names an object of the
  /// plan with which the previewed object is compared. Without it, `with` are the objects whose overlap is
  /// computed.
  Preview preview(const Json& asked, const std::vector<std::string>& with, const std::stop_token& stop);

  /// The state of the plan as a page shows it; null if no plan is open.
  Json state() const;
  /// The state of one object as a page shows it.
  Json object_json(const Snapshot& snapshot, const std::string& id) const;

 private:
  Document& need_document() const;
  Json objects_json(const Plan& plan) const;
  /// bone_low() of each loaded scan, computed once per loaded scene. Concurrent calls wait for each other,
  /// without holding `mutex_`.
  std::map<std::string, double> bone_lows_of(const Evaluation& evaluation);
  /// Stores certificates, sizes and measurements of steps that were evaluated in both kernels, with the keys
  /// of the steps.
  void keep_certified(const Plan& plan, const Evaluation& evaluation, const Json& measurements);
  /// Replaces measurements by stored ones of the same steps that were computed in both kernels.
  void put_certified(const Plan& plan, Json& measurements) const;

  std::filesystem::path working_folder_;
  mutable std::timed_mutex mutex_;  ///< protects the members from here to `certified_`
  std::unique_ptr<Document> document_;
  std::uint64_t opened_ = 0;  ///< documents opened so far; results for earlier ones are discarded
  Snapshot snapshot_;
  /// Certified results of a step. They belong to the current plan if its step has the same key.
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
  /// Previews by the text of the evaluated plan, newest last. Cached because all panes of a window request
  /// the same preview.
  std::deque<std::pair<std::string, Preview>> previews_;
};

}  // namespace octotomy::planner::serve
