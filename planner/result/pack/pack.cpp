// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/pack.h"

#include <algorithm>
#include <set>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/plan/sha256.h"
#include "planner/result/pack/library_versions.h"
#include "planner/result/pack/pack_witness.h"
#include "planner/result/pack/zip_writer.h"
#include "planner/result/report/patient.h"
#include "planner/result/report/report_page.h"
#include "planner/result/report/result_tables.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"
#include "voxel/space/unfinished_folder.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* notice =
    "This archive was written by Octotomy " OCTOTOMY_VERSION
    ", which is free software (AGPL-3.0-or-later). The licence covers the program, not\n"
    "this archive: plan, results and surfaces belong to whoever made the plan.\n\n"
    "The scan itself is not in it. manifest.json states its SHA-256; with the scan, `octotomy verify` "
    "replays the\n"
    "plan. Without it, check_pack.py, which is installed beside the program, computes the numbers again from "
    "the\n"
    "entries below witness/. A planning and research tool, not a medical device.\n";

/// Removes all durations.
void leave_out_times(Json& json) {
  if (json.is_object()) json.erase("timings_ms");
  if (json.is_structured())
    for (Json& member : json) leave_out_times(member);
}

/// Writes report, result.json and tables again without times, which differ from run to run.
void write_without_times(Result& result, Json json, const fs::path& folder) {
  result.evaluation.timings.clear();
  for (std::size_t i = 0; i < result.evaluation.objects.size(); ++i)
    if (auto& certificate = result.evaluation.objects.change(i).certificate) certificate->milliseconds = 0.0;
  leave_out_times(json);
  voxel::write_file(folder / "report.html", report_html(result));
  voxel::write_file(folder / "result.json", json_text(json, 2) + "\n");
  for (const auto& [name, text] : result_tables(json)) voxel::write_file(folder / name, text);
}

/// Adds entries to an archive and lists them in the manifest.
class Listed {
 public:
  explicit Listed(const fs::path& path) : zip_(path) {}

  void add(const std::string& name, std::string_view bytes) {
    zip_.add(name, bytes);
    files_.push_back({{"path", name}, {"bytes", bytes.size()}, {"sha256", sha256_of(bytes)}});
  }
  void close(Json& manifest) {
    manifest["files"] = files_;
    zip_.add("manifest.json", json_text(manifest, 2) + "\n");
    zip_.close();
  }

 private:
  ZipWriter zip_;
  Json files_ = Json::array();
};

void add_folder(Listed& archive, const fs::path& folder, const std::string& prefix) {
  std::set<fs::path> paths;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) paths.insert(entry.path());
  for (const fs::path& path : paths)
    archive.add(prefix + path.lexically_relative(folder).generic_string(), voxel::file_bytes(path));
}

/// The scan of an object that is a window on a scan; null for other objects.
const voxel::Scene* scan_of_window(const Result& result, const Object& object) {
  if (object.kind != "window") return nullptr;
  const auto step = std::ranges::find(result.plan.steps, object.id, &Step::id);
  if (step == result.plan.steps.end()) return nullptr;
  const std::vector<std::string> scans = scans_used(step->action);
  return scans.empty() ? nullptr : &result.evaluation.loaded.at(scans.front())->scene();
}

/// Adds the arrays of each object. Returns a list of the objects with the names of their entries.
Json add_witnesses(Listed& archive, const Result& result, const ExportOptions& options) {
  const Evaluation& evaluation = result.evaluation;
  Json objects = Json::array();
  for (const Object& object : evaluation.objects) {
    if (options.stop.stop_requested()) throw Stopped("stopped before the archive was written");
    Json row{{"id", object.id}};
    const std::string folder = "witness/" + std::to_string(objects.size()) + "/";
    for (const auto& [name, bytes] :
         witness_arrays(object, evaluation.universe, scan_of_window(result, object))) {
      archive.add(folder + name + ".npy", bytes);
      row[name] = folder + name + ".npy";
    }
    if (object.image)
      row["image_of"] = {{"object", object.image->object},
                         {"lps_from_lps", to_json(object.image->image_from_object)}};
    objects.push_back(std::move(row));
  }
  return objects;
}

Json scans_json(const Evaluation& evaluation) {
  Json scans = Json::array();
  for (const ScanRecord& scan : evaluation.scans)
    scans.push_back({{"name", scan.name},
                     {"sha256", scan.sha256},
                     {"dims", {scan.lattice.dims.x, scan.lattice.dims.y, scan.lattice.dims.z}},
                     {"lps_from_voxel", to_json(scan.lattice.lps_from_voxel)}});
  return scans;
}

}  // namespace

Json write_pack(Result& result, const fs::path& path, const PackOptions& options) {
  const voxel::UnfinishedFolder work(path.parent_path().empty() ? "." : path.parent_path(),
                                     ".octotomy-pack-");
  write_without_times(result, write_result_files(result, work.path(), options.files), work.path());
  voxel::StagedOutputs staged;
  Listed archive(staged.beside(path));
  archive.add("plan.plan.json", result.plan.text);
  archive.add("NOTICE.txt", notice);
  add_folder(archive, work.path(), "result/");
  Json manifest{{"octotomy_pack", pack_format}, {"octotomy", OCTOTOMY_VERSION}};
  if (result.anonymous) manifest["identity"] = names_nobody(result) ? "removed" : "unnamed";
  manifest["universe"] = {{"side", result.evaluation.universe.side()},
                          {"lps_from_voxel", to_json(result.evaluation.universe.lps_from_voxel)}};
  manifest["scans"] = scans_json(result.evaluation);
  manifest["objects"] = add_witnesses(archive, result, options.files);
  if (options.objects_of) {
    const voxel::UnfinishedFolder objects(work.path(), ".objects-");
    manifest["dicom"] =
        write_result_objects(result, *options.objects_of, work.path(), objects.path(), options.files);
    add_folder(archive, objects.path(), "dicom/");
  }
  manifest["libraries"] = library_versions();
  archive.close(manifest);
  staged.commit();
  return manifest;
}

}  // namespace octotomy::planner
