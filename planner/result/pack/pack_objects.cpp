// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/pack_objects.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <set>
#include <stdexcept>

#include "brep/io/write_mesh.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/same_patient.h"
#include "planner/result/pack/clinical_document.h"
#include "voxel/archive/source_identity.h"
#include "voxel/archive/write_dicom_document.h"
#include "voxel/archive/write_plan_objects.h"
#include "voxel/archive/write_rtstruct.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t most_label_letters = 64;

/// Adds all keys and texts of a JSON value to `words`, in lower case, each on its own line.
void add_words(const Json& value, std::string& words) {
  const auto add = [&](const std::string& text) {
    for (const char c : text) words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    words += '\n';
  };
  if (value.is_string()) add(value.get<std::string>());
  if (value.is_object())
    for (const auto& [key, inside] : value.items()) {
      if (key != "octotomy_plan") add(key);  // which every plan has
      add_words(inside, words);
    }
  if (value.is_array())
    for (const Json& inside : value) add_words(inside, words);
}

/// Writes the DICOM objects of a result and collects their description.
class ObjectsWriter {
 public:
  ObjectsWriter(const Result& result, fs::path folder, const ExportOptions& options)
      : result_(result), folder_(std::move(folder)), options_(options) {}

  Json write(const SeriesOfPlan& of, const fs::path& results) {
    const auto choice = result_.anonymous ? voxel::IdentityChoice::Remove : voxel::IdentityChoice::Keep;
    if (result_.anonymous)
      need_unnamed(parse_json<Json>(result_.plan.text), of.series, result_.plan.file.string());
    const voxel::DecidedIdentity decided = voxel::decide_identity(of.series, choice);
    source_ = decided.source;
    write_voxels();
    write_models();
    write_plan(results);
    return {{"scan", of.scan},
            {"identity", {{"choice", voxel::word_of(choice)}, {"changes", decided.changes}}},
            {"objects", std::move(rows_)},
            {"findings", std::move(findings_)}};
  }

 private:
  void add(const std::string& path, const std::string& kind, Json more = Json::object()) {
    rows_.push_back({{"path", path}, {"kind", kind}});
    rows_.back().update(more);
    if (options_.stop.stop_requested()) throw Stopped("stopped before the DICOM objects were written");
  }

  void write_voxels() {
    std::vector<voxel::DicomSegment> segments;
    Json names = Json::array();
    for (const Object& object : result_.evaluation.objects) {
      if (object.is_tool || object.voxel.octree.is_empty()) continue;
      segments.push_back({object.id.substr(0, most_label_letters), object.voxel.octree});
      names.push_back(object.id);
    }
    if (segments.empty()) return;
    voxel::DicomSegOptions segmentation;
    segmentation.label = "Objects";
    segmentation.series_description = "Octotomy, objects";
    segmentation.source = source_;
    segmentation.progress.stop = options_.stop;
    voxel::write_dicom_seg(segments, folder_ / "segmentation.dcm", segmentation);
    add("segmentation.dcm", "segmentation", {{"of", names}});
    write_contours(segments);
    add("structures.dcm", "structures", {{"of", names}});
  }

  void write_contours(const std::vector<voxel::DicomSegment>& segments) {
    voxel::RtstructOptions structures;
    structures.label = "Objects";
    structures.series_description = "Octotomy, contours";
    structures.source = source_;
    structures.progress.stop = options_.stop;
    const auto draw = [&] {
      for (const voxel::ContouredObject& each :
           voxel::write_rtstruct(segments, folder_ / "structures.dcm", structures))
        if (each.planes_left_out > 0)
          findings_.push_back("structures.dcm: " + std::to_string(each.planes_left_out) +
                              " planes of voxels of '" + each.name +
                              "' have no contours, because no image lies there");
    };
    try {
      draw();
    } catch (const std::invalid_argument&) {
      draw_on_voxels(structures, draw, "the images are not parallel to the planes of the voxels");
    } catch (const voxel::Error& error) {
      if (error.code() != voxel::ErrorCode::Geometry) throw;
      draw_on_voxels(structures, draw, error.what());
    }
  }

  template <class Draw>
  void draw_on_voxels(voxel::RtstructOptions& structures, const Draw& draw, const std::string& why) {
    structures.planes = voxel::ContourPlanes::Voxels;
    draw();
    findings_.push_back("structures.dcm: its contours lie on the planes of the voxels, not of the images: " +
                        why);
  }

  void write_models() {
    std::set<std::string> exported;
    for (const Exported& each : result_.exported)
      if (each.written) exported.insert(each.object);
    int written = 0;
    for (const Object& object : result_.evaluation.objects) {
      if (!exported.contains(object.id) || !object.mesh.within ||
          object.mesh.within->triangles().faces.empty())
        continue;
      const fs::path stl = folder_ / "model.stl";
      brep::write_mesh(object.mesh.within->triangles(), stl);
      voxel::DicomDocumentOptions model;
      model.label = object.id.substr(0, most_label_letters);
      model.series_description = "Octotomy, surface";
      model.source = source_;
      char name[32];
      std::snprintf(name, sizeof name, "model_%03d.dcm", ++written);
      voxel::write_dicom_document(voxel::file_bytes(stl), voxel::DocumentFormat::Stl, folder_ / name, model);
      fs::remove(stl);
      add(name, "model", {{"of", object.id}});
    }
  }

  void write_plan(const fs::path& results) {
    voxel::PlanObjects plan;
    plan.title = result_.plan.name.empty() ? "Plan" : result_.plan.name.substr(0, most_label_letters);
    ClinicalDocument document = clinical_document(result_.plan.text, plan.title, source_);
    plan.document = std::move(document.text);
    plan.identifier = std::move(document.identifier);
    std::set<fs::path> views;
    if (fs::is_directory(results / "views"))
      for (const fs::directory_entry& entry : fs::directory_iterator(results / "views"))
        if (entry.path().extension() == ".png") views.insert(entry.path());
    for (const fs::path& view : views)
      plan.pictures.push_back(
          {view.stem().string().substr(0, most_label_letters), voxel::png_pixels(voxel::file_bytes(view))});
    voxel::write_plan_objects(plan, folder_, source_);
    add("plan.dcm", "plan");
    int written = 0;
    for (const fs::path& view : views) {
      char name[32];
      std::snprintf(name, sizeof name, "picture_%03d.dcm", ++written);
      add(name, "picture", {{"of", "views/" + view.filename().string()}});
    }
  }

  const Result& result_;
  fs::path folder_;
  const ExportOptions& options_;
  std::optional<voxel::DicomSource> source_;
  Json rows_ = Json::array();
  std::vector<std::string> findings_;
};

}  // namespace

std::optional<SeriesOfPlan> series_of(const Result& result) {
  for (const ScanRecord& scan : result.evaluation.scans) {
    const auto of_plan = result.plan.scans.find(scan.name);
    if (!scan.made_by.empty() || scan.meaning == voxel::Meaning::Label || !is_of_series(scan.audit) ||
        of_plan == result.plan.scans.end())
      continue;
    return SeriesOfPlan{scan.name,
                        voxel::dicom_source(scan_path(result.plan, of_plan->second), of_plan->second.read)};
  }
  return std::nullopt;
}

Json write_result_objects(const Result& result, const SeriesOfPlan& of, const fs::path& results,
                          const fs::path& folder, const ExportOptions& options) {
  return ObjectsWriter(result, folder, options).write(of, results);
}

void need_unnamed(const Json& plan, const voxel::DicomSource& source, const std::string& where) {
  std::string words;
  add_words(plan, words);
  constexpr std::size_t least_letters = 3;
  for (const voxel::DicomTag tag : {0x00100010, 0x00100020, 0x00100030, 0x00080050, 0x00080090, 0x00200010}) {
    const auto found = source.attributes.find(tag);
    if (found == source.attributes.end()) continue;
    std::string word;
    for (const char c : found->second.value + "^") {
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80) {
        word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        continue;
      }
      if (word.size() >= least_letters && words.find(word) != std::string::npos)
        throw std::runtime_error(
            (where.empty() ? "the plan" : where) + ": a text of the plan contains '" + word +
            "', which the source states about the patient or the study: rename it in the "
            "plan, because --identity cannot change a step");
      word.clear();
    }
  }
}

}  // namespace octotomy::planner
