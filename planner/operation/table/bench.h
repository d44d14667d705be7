// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "planner/operation/table/object.h"
#include "planner/operation/table/stopwatch.h"
#include "verify/question/expression_on_meshes.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// The inputs of an operation's functions. Each kernel has its own bench, which gives access to that kernel's
// answers only. All are in one header, because an operation uses most of them.
namespace octotomy::voxel {
struct DicomSource;
}  // namespace octotomy::voxel

namespace octotomy::planner {

class Action;

/// A scan while steps need its samples.
struct LoadedScan {
  std::shared_ptr<const voxel::Scene> shared;  ///< witnesses keep it
  voxel::GreyOctree grey;

  const voxel::Scene& scene() const { return *shared; }
};
/// Returns a scan by its name in the document.
using Scans = std::function<const LoadedScan&(const std::string& name)>;

/// The facts of a scan that a report needs, without its samples.
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
  std::vector<voxel::Hole> holes;
  voxel::Identity identity = {};
  std::string made_by = {};  ///< the step that made it, in words; empty: it was read
  nlohmann::ordered_json details = nlohmann::ordered_json::object();  ///< reported by that step
};

/// The bench of operations that make a scan of another one.
struct ScanBench {
  /// The samples of an earlier scan.
  std::function<const voxel::Scene&(const std::string& name)> samples;
  Timings& timings;
  voxel::Progress progress;
  std::filesystem::path folder = {};  ///< paths of files are relative to it
  /// The scans with their octrees, and the objects before the step. Null where no plan is evaluated: an
  /// operation that takes objects is a step of plans only.
  const Scans* scans = nullptr;
  const Objects* objects = nullptr;
};

/// A scan that an operation made.
struct MadeScan {
  voxel::Scene scene;
  nlohmann::ordered_json details = nlohmann::ordered_json::object();  ///< further results of the operation
  std::optional<voxel::GreyOctree> removed = {};  ///< samples taken out, so that they can be put back
  std::vector<std::string> findings = {};
};

/// The bench of operations that compute values of their own before the kernels run, such as a plane of best
/// fit.
struct SettleBench {
  const Objects& objects;
  const Scans& scan;
  Timings& timings;
  voxel::Progress progress;
  std::filesystem::path folder = {};  ///< paths of files are relative to it
  /// Reported facts about the computed values.
  nlohmann::ordered_json& details;
  std::vector<std::string>& findings;
  /// The step that made an earlier object, as typed; null where there is none, as in a verb on files.
  std::function<const Action*(const std::string& name)> maker_of = {};

  /// An earlier object's solid. Throws std::runtime_error if the object has none.
  const brep::Solid& object(const std::string& name) const;
};

/// The voxel kernel's bench.
struct VoxelBench {
  const voxel::Universe& universe;
  const Objects& objects;
  const Scans& scan;
  Timings& timings;
  voxel::Progress progress;
  std::filesystem::path folder = {};  ///< paths of files are relative to it
  const std::vector<ScanRecord>& scans;

  /// An earlier object's answer in this kernel.
  const VoxelSide& object(const std::string& name) const { return objects.at(name).voxel; }
  bool is_tool(const std::string& name) const { return objects.at(name).is_tool; }
  const LoadedScan& loaded(const std::string& name) const { return scan(name); }
  /// The box of all the universe's voxels.
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
  std::filesystem::path folder = {};  ///< paths of files are relative to it
};

/// The bench of operations that make numbers or files from objects.
struct AnswerBench {
  const voxel::Universe& universe;
  const Objects& objects;
  const std::vector<ScanRecord>& scans;
  Timings& timings;
  std::stop_token stop = {};
  /// Called with the current task and its fraction done, 0..1; may be empty.
  std::function<void(const std::string& doing, double fraction)> report = {};
  std::filesystem::path folder = {};      ///< files are written below it
  std::vector<std::string> origins = {};  ///< where the objects come from, for files' headers
  /// Values that several operations share, by keys that the operations choose.
  std::map<std::string, std::shared_ptr<const void>>& kept;
  Scans scan = {};  ///< those that measurements and files use

  /// The scan's samples as they are.
  const voxel::Scene& samples(const std::string& name) const { return scan(name).scene(); }

  voxel::Progress progress(const std::string& doing) const;
};

/// The bench of a verb that answers from files by itself, and of the step of the same operation, which writes the
/// same kind of file from objects.
struct FileBench {
  Timings& timings;
  std::stop_token stop = {};
  /// Called with the current task and its fraction done, 0..1; may be empty.
  std::function<void(const std::string& doing, double fraction)> report = {};
  /// Reads a scan according to the command line's options, with `slices_final` as in voxel::ReadOptions;
  /// timed.
  std::function<voxel::Scene(const std::filesystem::path& path, const voxel::SlicesFinal& slices_final)>
      scan_reader = {};
  /// The bench of the step; null for a verb, whose names of objects are paths of files.
  const AnswerBench* step = nullptr;
  /// The DICOM series that a scan was read from; null if it is of another kind.
  std::function<std::shared_ptr<const voxel::DicomSource>(const std::filesystem::path& path,
                                                          const voxel::Scene& scene)>
      dicom_source = {};
  voxel::Scene read_scan(const std::filesystem::path& path,
                         const voxel::SlicesFinal& slices_final = {}) const {
    return scan_reader(path, slices_final);
  }

  voxel::Progress progress(const std::string& doing) const;
};

/// A verb's output: a JSON object, placed after the members common to all answers, and a table for people.
struct FileAnswer {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::vector<std::pair<std::string, std::string>> rows = {};
  std::vector<std::string> findings = {};  ///< also printed as warnings
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
