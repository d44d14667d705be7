// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "planner/table/object.h"
#include "planner/table/stopwatch.h"
#include "verify/expression_on_meshes.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// What an operation works with. Each kernel has a bench of its own that shows only that kernel's answers, so
// that neither can see the other's.
namespace octotomy::planner {

/// A scan while steps need its samples.
struct LoadedScan {
  std::shared_ptr<const voxel::Scene> shared;  ///< witnesses keep it
  voxel::GreyOctree grey;

  const voxel::Scene& scene() const { return *shared; }
};
/// Answers a scan by its name in the document.
using Scans = std::function<const LoadedScan&(const std::string& name)>;

/// The voxel kernel's bench.
struct VoxelBench {
  const voxel::Universe& universe;
  const Objects& objects;
  const Scans& scan;
  Timings& timings;
  voxel::Progress progress;

  /// An earlier object's answer in this kernel.
  const VoxelSide& object(const std::string& name) const { return objects.at(name).voxel; }
  bool is_tool(const std::string& name) const { return objects.at(name).is_tool; }
  const LoadedScan& loaded(const std::string& name) const { return scan(name); }
  /// What the universe's voxels fill.
  voxel::Box box_mm() const;
  /// The expression's voxels of the universe; timed.
  voxel::Octree combined(const voxel::Expression& expression) const;
  /// The part of a symbol within the universe: an object ends there, and stays cut when it moves on.
  voxel::Expression within_universe(const voxel::Expression& symbol) const;
};

/// The mesh kernel's bench.
struct MeshBench {
  glm::dvec3 low_mm, high_mm;  ///< corners of the universe, LPS
  const Objects& objects;
  const Scans& scan;
  verify::MeshExpressions& expressions;
  Timings& timings;
  voxel::Progress progress;
  std::filesystem::path folder = {};  ///< paths of files are relative to it

  /// An earlier object's answer in this kernel. Precondition: it has one.
  const brep::Solid& object(const std::string& name) const { return *objects.at(name).mesh.whole; }
  /// The scan's samples as they are, not resampled to voxels.
  const voxel::Scene& samples(const std::string& name) const { return scan(name).scene(); }
};

/// The bench of a certificate's bound, after both kernels have answered.
struct BoundBench {
  const voxel::Universe& universe;
  const Objects& objects;
  const Scans& scan;
};

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

/// The bench of operations that make numbers or files from objects.
struct AnswerBench {
  const voxel::Universe& universe;
  const Objects& objects;
  const std::vector<ScanRecord>& scans;
  Timings& timings;
  std::stop_token stop = {};
  /// Called with what is being done and a fraction of it, 0..1; may be empty.
  std::function<void(const std::string& doing, double fraction)> report = {};
  std::filesystem::path folder = {};      ///< files are written below it
  std::vector<std::string> origins = {};  ///< where the objects come from, for files' headers
  /// What several operations share, by their own keys.
  std::map<std::string, std::shared_ptr<const void>>& kept;

  voxel::Progress progress(const std::string& doing) const;
};

/// A file that an operation wrote, or the reason why it did not.
struct Exported {  // NOLINT(bugprone-exception-escape)
  std::string id;
  std::string object;
  std::string path;  ///< within the result folder
  bool written = false;
  std::string content;  ///< for people: "12 345 tetrahedra, smallest dihedral 6.1 degrees"
  nlohmann::ordered_json details = nlohmann::ordered_json::object();
  std::vector<std::string> findings;
};

}  // namespace octotomy::planner
