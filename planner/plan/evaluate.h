// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/object.h"
#include "planner/operation/table/plan_universe.h"
#include "planner/operation/table/stopwatch.h"
#include "planner/plan/file_preparation.h"
#include "planner/plan/object_cache.h"
#include "planner/plan/plan.h"

namespace octotomy::planner {

/// The results of the steps of a plan, by both kernels.
struct Evaluation {
  std::vector<ScanRecord> scans;
  voxel::Universe universe;
  Objects objects;  ///< in the order of the steps
  Timings timings;
  /// Scans that were read or made and that measurements or files use; all scans with
  /// EvaluateOptions::keep_scans.
  std::map<std::string, std::shared_ptr<const LoadedScan>> loaded;
  /// Files that are being prepared, by the ids of their steps.
  std::map<std::string, std::shared_ptr<FilePreparation>> file_preparations;

  const Object& object(const std::string& id) const { return objects.at(id); }
};

/// Thrown if a stop was requested. There is no result then, and nothing is written.
using voxel::Stopped;

struct EvaluateOptions {
  std::stop_token stop;
  /// Called with the current task and the fraction of the steps that are done, from 0 to 1.
  std::function<void(const std::string& doing, double fraction)> progress;
  bool certify = true;
  /// False: nothing is certified, and the mesh kernel answers only steps whose voxels need it
  /// (needing_meshes()).
  bool meshes = true;
  /// Ids of the steps to evaluate. Steps on which they depend are evaluated too. Empty: all steps.
  std::vector<std::string> wanted = {};
  /// Prepares files in parallel with the evaluation, for callers that write the files afterwards.
  bool prepares_files = false;
  /// Stores all scans in Evaluation::loaded, for example to draw their slices.
  bool keep_scans = false;
  /// An earlier evaluation with keep_scans of a plan with the same scans, which are then not read again. May
  /// be null.
  const Evaluation* scans_of = nullptr;
  /// Answers of earlier evaluations. An answer that it contains is not computed again; new answers are added.
  /// May be null.
  ObjectCache* cache = nullptr;
  /// Adds no objects to the cache. For a piece that is being dragged, because its positions do not recur.
  bool only_look_up = false;
  /// Reads a scan, or returns one that was read before. Null: voxel::read_scene().
  std::function<voxel::Scene(const std::filesystem::path&, const voxel::ReadOptions&)> read_scene = nullptr;
};

/// Evaluates the steps that make objects or scans. Each kernel makes an object as its operation states
/// (planner/operation), without access to the other kernel's answer, and the agreement of both answers is
/// certified. A moved object stores its motion, so that after several motions the original object is sampled
/// only once. If an object reaches out of the universe, the universe grows by whole voxels, to at most four
/// times its side (room.h); it does not grow if `only_look_up` is true and `meshes` is false.
///
/// If the mesh kernel has no answer, the object has its voxels, no mesh and a finding; so have objects that
/// are made from it. Throws std::runtime_error with step and reason if a scan cannot be read or has another
/// SHA-256 than the plan states, or if an operation refuses; Stopped. Memory: the largest scan, its grey
/// octree, and a mesh and an octree for each object.
Evaluation evaluate(const Plan& plan, const EvaluateOptions& options = {});

}  // namespace octotomy::planner
