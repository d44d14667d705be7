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
#include "planner/plan/ahead.h"
#include "planner/plan/object_cache.h"
#include "planner/plan/plan.h"

namespace octotomy::planner {

/// What a plan's steps made, in both kernels.
struct Evaluation {
  std::vector<ScanRecord> scans;
  voxel::Universe universe;
  Objects objects;  ///< in the order of their steps
  Timings timings;
  /// The scans that measurements and files use, read or made; all of them with EvaluateOptions::keep_scans.
  std::map<std::string, std::shared_ptr<const LoadedScan>> loaded;
  /// The work on files that was begun ahead, by their steps.
  std::map<std::string, std::shared_ptr<Ahead>> ahead;

  const Object& object(const std::string& id) const { return objects.at(id); }
};

/// The stop token was set: nothing was decided, nothing is written.
using voxel::Stopped;

struct EvaluateOptions {
  std::stop_token stop;
  /// Called with what is being done and the fraction of the steps done, 0..1.
  std::function<void(const std::string& doing, double fraction)> progress;
  bool certify = true;
  /// Without them the mesh kernel answers only where voxels cannot be had without it (needing_meshes()), and
  /// nothing is certified.
  bool meshes = true;
  /// The steps that are wanted; those that they need are evaluated, and no others. Empty: all.
  std::vector<std::string> wanted = {};
  /// Begins the work on files beside the evaluation; for whoever writes them afterwards.
  bool ahead = false;
  /// Leaves every scan in Evaluation::loaded, so that slices of it can be drawn.
  bool keep_scans = false;
  /// An earlier evaluation whose plan has the same scans and that kept them: they are not read again. May be
  /// null.
  const Evaluation* scans_of = nullptr;
  /// Answers of earlier evaluations, which are not made again, and to which new ones are added; may be null.
  ObjectCache* cache = nullptr;
  /// Adds no objects to the cache, as for a piece that is dragged, of which none comes again.
  bool only_look_up = false;
  /// Reads a scan; whoever has read one already hands it out here. Default: voxel::read_scene().
  std::function<voxel::Scene(const std::filesystem::path&, const voxel::ReadOptions&)> read_scene = nullptr;
};

/// Evaluates every step that makes an object or a scan, objects in the voxel kernel and in the mesh kernel,
/// as its operation says (planner/operation), and certifies their agreement object by object. Neither kernel
/// sees the other's answer before both are there. A moved object keeps its motion symbolic, so that moving it
/// again samples the still object once.
///
/// Throws std::runtime_error with step and reason where a scan cannot be read, is not the one whose SHA-256
/// is given, or an operation refuses; Stopped. An object whose operation the mesh kernel cannot do keeps its
/// voxel answer, has no mesh and a finding; so do the objects that depend on it. Memory: the largest scan,
/// its grey octree, and one mesh and octree an object.
Evaluation evaluate(const Plan& plan, const EvaluateOptions& options = {});

}  // namespace octotomy::planner
