// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/measure.h"
#include "brep/mesh.h"
#include "planner/plan.h"
#include "planner/stopwatch.h"
#include "verify/certificate.h"
#include "voxel/grey_octree.h"
#include "voxel/measure.h"
#include "voxel/octree.h"
#include "voxel/read_scene.h"
#include "voxel/scene.h"

namespace octotomy::planner {

/// A scan without its samples: what a report says of it.
struct ScanRecord {
  std::string name;
  std::filesystem::path path;
  std::string sha256;
  voxel::Lattice lattice;
  voxel::Meaning meaning = voxel::Meaning::Raw;
  std::string modality;
  std::string unit;
  voxel::Range range;
  std::vector<voxel::Finding> audit;
};

/// A wall of an object that a mask cut, and the motion of all the steps that moved it since, LPS to LPS.
struct Cut {
  std::string mask;
  std::shared_ptr<const brep::Mesh> wall;
  glm::dmat4 moved_from_still{1.0};
};

/// What a window, mask, combine or move step made, in both kernels.
struct Object {
  explicit Object(voxel::Octree voxels) : octree(std::move(voxels)) {}

  std::string id;
  std::string kind;        ///< the step's `do`
  std::string definition;  ///< for people: "skull & cut"
  voxel::Octree octree;
  voxel::Measures voxel_measures;
  /// The mesh kernel's answer within the universe; null where it has none, and `findings` says why.
  std::shared_ptr<const brep::Mesh> mesh;
  std::optional<brep::Measures> mesh_measures;
  std::optional<verify::Certificate> certificate;  ///< none for masks, and where there is no mesh
  std::vector<std::string> findings;
  /// Where all of its surface that is not a cut is one window's lower bound on a scan, as it lies or moved:
  /// the samples to interpolate that surface from, and the motion, LPS to LPS, of all the steps that moved
  /// it.
  std::optional<voxel::GreyOctree> grey;
  double threshold = 0.0;
  std::string scan;  ///< that grey is of
  glm::dmat4 moved_from_still{1.0};
  /// Of a move step's result.
  struct Moved {
    std::string object;  ///< that was moved
    glm::dmat4 motion{1.0};
  };
  std::optional<Moved> moved;
  std::vector<Cut> cuts;  ///< the masks that it was made with, where they have a mesh
};

/// What a measure step asks for: indices into Evaluation::objects, or points.
struct Measured {
  std::string id;
  std::size_t object = 0;  ///< without meaning where there are points
  std::optional<std::size_t> to;
  std::vector<glm::dvec3> points_mm;

  /// Neither a gap nor points.
  bool is_size() const { return !to && points_mm.empty(); }
};

struct Evaluation {
  std::vector<ScanRecord> scans;
  voxel::Universe universe;
  std::vector<Object> objects;     ///< in the order of their steps
  std::vector<Measured> measured;  ///< in the order of their steps
  Timings timings;

  const Object& object(const std::string& id) const;
};

/// The stop token was set: nothing was decided, nothing is written.
using voxel::Stopped;

struct EvaluateOptions {
  std::stop_token stop;  ///< looked at between steps
  /// Called with what is being done and the fraction of the steps done, 0..1.
  std::function<void(const std::string& doing, double fraction)> progress;
  bool certify = true;
};

/// The universe a plan is evaluated in: around the scan's bounds, voxels of the asked edge; by default the
/// scan's smallest spacing, or what makes the bounds 512 voxels a side where that is larger. A voxel's centre
/// lies on the scan's first sample, so that samples as far apart as voxels are taken over as they are.
voxel::Universe universe_of(const voxel::Lattice& scan, std::optional<double> voxel_mm);

/// Evaluates every step of the plan but its exports, in the voxel kernel (windows on grey octrees, Boolean
/// expressions and moves on octrees) and in the mesh kernel (isosurfaces of the scan's own samples, prisms
/// of the masks, corefinement), and certifies their agreement object by object. Neither kernel sees the
/// other's answer before both are there. A moved object keeps its motion symbolic, so that moving it again
/// samples the still object once.
///
/// Throws std::runtime_error naming step and reason where a scan cannot be read, is not the one whose SHA-256
/// is given, or a window or mask holds no voxel; Stopped. Where the mesh kernel cannot do an operation, the
/// object keeps its voxel answer, has no mesh and a finding; so has what depends on it.
/// Memory: the largest scan, its grey octree, and one mesh and octree an object.
Evaluation evaluate(const Plan& plan, const EvaluateOptions& options = {});

}  // namespace octotomy::planner
