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

// The inputs of an operation's functions. Each kernel has a separate bench, which gives access to that
// kernel's answers only. All benches are in one header, because an operation uses most of them.
namespace octotomy::voxel {
struct DicomSource;
}  // namespace octotomy::voxel

namespace octotomy::planner {

class Action;

/// A scan in memory, for steps that need its samples.
struct LoadedScan {
  std::shared_ptr<const voxel::Scene> shared;  ///< witnesses keep it
  voxel::GreyOctree grey;

  const voxel::Scene& scene() const { return *shared; }
};
/// Returns a scan of the document by its name.
using Scans = std::function<const LoadedScan&(const std::string& name)>;

/// The facts about a scan that a report needs, without the samples.
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
  std::string made_by = {};  ///< the step that made the scan, in words; empty: the scan was read
  nlohmann::ordered_json details = nlohmann::ordered_json::object();  ///< reported by that step
};

/// The inputs of operations that make a scan from another scan.
struct ScanBench {
  /// The samples of an earlier scan, by name.
  std::function<const voxel::Scene&(const std::string& name)> samples;
  Timings& timings;
  voxel::Progress progress;
  std::filesystem::path folder = {};  ///< folder to which paths of files are relative
  /// All scans with their octrees, and the objects before the step. Null if no plan is evaluated: an
  /// operation on objects can only be a step of a plan.
  const Scans* scans = nullptr;
  const Objects* objects = nullptr;
};

/// A scan that an operation made.
struct MadeScan {
  voxel::Scene scene;
  nlohmann::ordered_json details = nlohmann::ordered_json::object();  ///< further results of the operation
  std::optional<voxel::GreyOctree> removed = {};  ///< samples that were removed, so that a later step can
                                                  ///< restore them
  std::vector<std::string> findings = {};
};

/// The inputs of operations that compute values before the kernels run, such as a plane of best fit.
struct SettleBench {
  const Objects& objects;
  const Scans& scan;
  Timings& timings;
  voxel::Progress progress;
  std::filesystem::path folder = {};  ///< folder to which paths of files are relative
  /// Facts about the computed values, for the report.
  nlohmann::ordered_json& details;
  std::vector<std::string>& findings;
  /// The step that made an earlier object, as the user typed it; null if there is none, for example in a verb
  /// on files.
  std::function<const Action*(const std::string& name)> maker_of = {};

  /// The solid of an earlier object. Throws std::runtime_error if the object has none.
  const brep::Solid& object(const std::string& name) const;
};

/// The voxel kernel's bench.
struct VoxelBench {
  const voxel::Universe& universe;
  const Objects& objects;
  const Scans& scan;
  Timings& timings;
  voxel::Progress progress;
  std::filesystem::path folder = {};  ///< folder to which paths of files are relative
  const std::vector<ScanRecord>& scans;

  /// The voxel kernel's answer for an earlier object.
  const VoxelSide& object(const std::string& name) const { return objects.at(name).voxel; }
  bool is_tool(const std::string& name) const { return objects.at(name).is_tool; }
  const LoadedScan& loaded(const std::string& name) const { return scan(name); }
  /// The box around all voxels of the universe, LPS mm.
  voxel::Box box_mm() const;
  /// The voxels of the universe in an expression. Their time is measured.
  voxel::Octree combined(const voxel::Expression& expression) const;
  /// The part of a symbol within the universe. An object ends at the universe's border, and stays cut there
  /// when it moves.
  voxel::Expression within_universe(const voxel::Expression& symbol) const;
};

/// The mesh kernel's bench.
struct MeshBench {
  glm::dvec3 low_mm, high_mm;  ///< corners of the universe, LPS mm
  const Objects& objects;
  const Scans& scan;
  verify::MeshExpressions& expressions;
  Timings& timings;
  voxel::Progress progress;
  std::filesystem::path folder = {};  ///< folder to which paths of files are relative

  /// The mesh kernel's answer for an earlier object. Precondition: there is one.
  const brep::Solid& object(const std::string& name) const { return *objects.at(name).mesh.whole; }
  /// The unchanged samples of a scan, not resampled to voxels.
  const voxel::Scene& samples(const std::string& name) const { return scan(name).scene(); }
};

/// The inputs of a function that sets a certificate's bound, after both kernels have answered.
struct BoundBench {
  const voxel::Universe& universe;
  const Objects& objects;
  const Scans& scan;
  std::filesystem::path folder = {};  ///< folder to which paths of files are relative
};

/// The inputs of operations that compute numbers or write files from objects.
struct AnswerBench {
  const voxel::Universe& universe;
  const Objects& objects;
  const std::vector<ScanRecord>& scans;
  Timings& timings;
  std::stop_token stop = {};
  /// Called with the current task and its completed share, 0 to 1; may be empty.
  std::function<void(const std::string& doing, double fraction)> report = {};
  std::filesystem::path folder = {};      ///< folder below which files are written
  std::vector<std::string> origins = {};  ///< the origin of the objects, for the headers of files
  /// Values that several operations use, by keys that the operations choose.
  std::map<std::string, std::shared_ptr<const void>>& kept;
  Scans scan = {};  ///< the scans that measurements and files need

  /// The unchanged samples of a scan.
  const voxel::Scene& samples(const std::string& name) const { return scan(name).scene(); }

  voxel::Progress progress(const std::string& doing) const;
};

/// The inputs of a verb that answers from files without a plan, and of the same operation as a step, which
/// writes the same kind of file from objects.
struct FileBench {
  Timings& timings;
  std::stop_token stop = {};
  /// Called with the current task and its completed share, 0 to 1; may be empty.
  std::function<void(const std::string& doing, double fraction)> report = {};
  /// Reads a scan with the command line's options. `slices_final` is that of voxel::ReadOptions. The time is
  /// measured.
  std::function<voxel::Scene(const std::filesystem::path& path, const voxel::SlicesFinal& slices_final)>
      scan_reader = {};
  /// The inputs of the step; null for a verb, in which names of objects are paths of files.
  const AnswerBench* step = nullptr;
  /// The DICOM series from which a scan was read; null if the scan is not DICOM.
  std::function<std::shared_ptr<const voxel::DicomSource>(const std::filesystem::path& path,
                                                          const voxel::Scene& scene)>
      dicom_source = {};
  voxel::Scene read_scan(const std::filesystem::path& path,
                         const voxel::SlicesFinal& slices_final = {}) const {
    return scan_reader(path, slices_final);
  }

  voxel::Progress progress(const std::string& doing) const;
};

/// A verb's output: a JSON object, whose members follow the common members of all answers, and a table for
/// people.
struct FileAnswer {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::vector<std::pair<std::string, std::string>> rows = {};
  std::vector<std::string> findings = {};  ///< also printed as warnings
};

/// A file that an operation wrote, or the reason why it wrote none.
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
