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

/// The results of a plan's steps, in both kernels.
struct Evaluation {
  std::vector<ScanRecord> scans;
  voxel::Universe universe;
  Objects objects;  ///< in the order of their steps
  Timings timings;
  /// The scans, read or made, that measurements and files use; all scans with EvaluateOptions::keep_scans.
  std::map<std::string, std::shared_ptr<const LoadedScan>> loaded;
  /// Files that are being prepared, by their steps.
  std::map<std::string, std::shared_ptr<FilePreparation>> file_preparations;

  const Object& object(const std::string& id) const { return objects.at(id); }
};

/// A stop was requested: there is no result, and nothing is written.
using voxel::Stopped;

struct EvaluateOptions {
  std::stop_token stop;
  /// Called with the current task and the fraction of steps done, 0..1.
  std::function<void(const std::string& doing, double fraction)> progress;
  bool certify = true;
  /// If false, the mesh kernel answers only steps whose voxels need it (needing_meshes()), and nothing is
  /// certified.
  bool meshes = true;
  /// The steps to evaluate, together with those on which they depend. Empty: all.
  std::vector<std::string> wanted = {};
  /// Prepares files in parallel with the evaluation. For callers that write the files afterwards.
  bool prepares_files = false;
  /// Stores every scan in Evaluation::loaded, so that its slices can be drawn.
  bool keep_scans = false;
  /// An earlier evaluation of a plan with the same scans that stored them; they are then not read again. May
  /// be null.
  const Evaluation* scans_of = nullptr;
  /// A cache of answers of earlier evaluations, which are not computed again; new answers are added. May be
  /// null.
  ObjectCache* cache = nullptr;
  /// Adds no objects to the cache. For a piece that is being dragged, whose intermediate positions do not
  /// recur.
  bool only_look_up = false;
  /// Reads a scan, or returns one that was read before. Default: voxel::read_scene().
  std::function<voxel::Scene(const std::filesystem::path&, const voxel::ReadOptions&)> read_scene = nullptr;
};

/// Evaluates every step that makes an object or a scan, objects in the voxel kernel and in the mesh kernel,
/// as its operation says (planner/operation), and certifies their agreement object by object. Neither kernel
/// has access to the other's answer before both are computed. A moved object stores its motion symbolically,
/// so that after further motions the original object is sampled only once. The universe grows by
/// whole voxels, to at most four times its side, until it contains every object (room.h), except with `only_look_up`
/// and without meshes.
///
/// Throws std::runtime_error with step and reason if a scan cannot be read or does not have the stated
/// SHA-256, or if an operation refuses; Stopped. If the mesh kernel cannot do an operation, the object has
/// its voxel answer, no mesh and a finding, and so have the objects that depend on it. Memory: the largest
/// scan, its grey octree, and one mesh and octree per object.
Evaluation evaluate(const Plan& plan, const EvaluateOptions& options = {});

}  // namespace octotomy::planner
