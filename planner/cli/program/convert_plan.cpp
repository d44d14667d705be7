// SPDX-License-Identifier: AGPL-3.0-or-later
// A plan with its pictures as DICOM objects, and documents of an archive as files again.
#include <algorithm>
#include <set>

#include "planner/cli/program/convert_source.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/json_file.h"
#include "planner/result/pack/clinical_document.h"
#include "planner/result/pack/pack_objects.h"
#include "planner/result/report/patient.h"
#include "planner/result/report/result_folder.h"
#include "voxel/archive/read_archived.h"
#include "voxel/archive/write_plan_objects.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/file_text.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t most_plan_bytes = 256 << 20;

Json plan_json(const std::string& text, const std::string& where) {
  Json plan;
  try {
    plan = parse_json<Json>(text);
  } catch (const std::runtime_error& error) {
    refuse(where, error.what());
  }
  if (!plan.is_object() || !plan.contains("octotomy_plan"))
    refuse(where, "is no plan: it lacks \"octotomy_plan\"; only plans (.plan.json) are written as documents");
  return plan;
}

/// The views in a result's folder. Refuses a folder that is not the result of this plan.
std::vector<voxel::PlanPicture> pictures_of(const fs::path& result, const Json& plan) {
  Json made;
  try {
    made = parse_json<Json>(voxel::file_bytes(result / "result.json")).at("plan");
  } catch (const std::exception& error) {
    refuse((result / "result.json").string(), std::string("is no result of octotomy run: ") + error.what());
  }
  if (made.value("steps", Json()) != plan.value("steps", Json()))
    refuse(result.string(),
           "is the result of another plan: its steps differ; replay this one with octotomy run");
  std::vector<voxel::PlanPicture> pictures;
  for (const auto& [name, sum] : result_list(result)) {
    const fs::path file(name);
    if (file.parent_path() != "views" || file.extension() != ".png") continue;
    try {
      pictures.push_back(
          {file.stem().string().substr(0, 64), voxel::png_pixels(voxel::file_bytes(result / file))});
    } catch (const voxel::Error& error) {
      voxel::refuse(result / file, error.what());
    }
  }
  if (pictures.empty())
    refuse(result.string(), "contains no views: give a folder that octotomy run wrote, as --pictures");
  return pictures;
}

void need_result(const fs::path& result) {
  if (!fs::is_regular_file(result / "result.json"))
    refuse(result.string(), "contains no result.json: give a folder that octotomy run wrote, as --pictures");
}

/// Refuses options of convert that do not apply to a plan.
void need_plan_words(const ConvertText& text) {
  if (text.out.has_extension())
    refuse(text.out.string(), "a plan and its pictures are several DICOM objects: give a folder");
  if (text.dicom || !text.as.empty())
    refuse(text.in.string(), "is a plan, which has one form in DICOM: leave --dicom and --as out");
  if (text.other_identity && text.source.empty())
    refuse("", "--other-identity needs --source: add --source, or leave --other-identity out");
  need_folder_of(text.out, OutputKind::Folder);
  if (!text.pictures.empty()) need_result(text.pictures);
  if (fs::file_size(text.in) > most_plan_bytes) refuse(text.in.string(), "is larger than any plan");
}

}  // namespace

int convert_plan(const Program& program, const ConvertText& text) {
  need_plan_words(text);
  Timings timings;
  std::vector<std::string> findings;
  std::string bytes = voxel::file_bytes(text.in);
  Json plan = plan_json(bytes, text.in.string());
  voxel::PlanObjects objects;
  if (!text.pictures.empty()) {
    const Stopwatch watch(timings, "read");
    objects.pictures = pictures_of(text.pictures, plan);
  }
  std::optional<voxel::DicomSource> source;
  {
    const Stopwatch watch(timings, "source");
    source = source_of(program, text, false, {}, findings);
  }
  if (!source) warn("no --source: the plan gets a new study and names no patient");
  if (!text.keeps_identity()) {
    bytes = plan_without_names(bytes, *text.changes);
    text.changes->emplace_back("plan: name and paths of scans removed");
    plan = plan_json(bytes, text.in.string());
    if (!text.source.empty())
      need_unnamed(plan, voxel::dicom_source(text.source, read_options(program, text.scan)),
                   text.in.string());
  }
  const auto name = plan.find("name");
  objects.title = !text.label.empty() ? text.label
                  : name != plan.end() && name->is_string() && !name->get<std::string>().empty()
                      ? name->get<std::string>().substr(0, 64)
                      : "Plan";
  ClinicalDocument document = clinical_document(bytes, objects.title, source);
  objects.document = std::move(document.text);
  objects.identifier = document.identifier;
  std::vector<fs::path> written;
  {
    const Stopwatch watch(timings, "write");
    fs::create_directories(text.out);
    written = voxel::write_plan_objects(objects, text.out, source);
  }
  Json json = answer(timings);
  json["kind"] = "DICOM plan";
  json["path"] = text.out.string();
  json["files"] = Json::array();
  for (const fs::path& file : written) json["files"].push_back(file.string());
  json["label"] = objects.title;
  json["plan_bytes"] = bytes.size();
  json["pictures"] = objects.pictures.size();
  json["source_images"] = source ? Json(source->images.size()) : Json(nullptr);
  tell(text, findings, json);
  program.say(json, lines({{"written", text.out.string()},
                           {"plan", objects.title},
                           {"pictures", std::to_string(objects.pictures.size())}}));
  return done;
}

std::optional<int> unpack_archived(const Program& program, const ConvertText& text) {
  static const std::set<std::string> forms{".json", ".pdf", ".xml", ".stl", ".obj", ".png"};
  const std::string form = voxel::extension_of(text.out);
  if (!forms.contains(form) || text.dicom || !fs::is_regular_file(text.in)) return std::nullopt;
  const std::optional<voxel::ArchivedObject> found = voxel::read_archived(text.in);
  if (!found) return std::nullopt;
  const std::string wanted = found->picture                           ? ".png"
                             : found->media_type == "application/pdf" ? ".pdf"
                             : found->media_type == "model/stl"       ? ".stl"
                             : found->media_type == "model/obj"       ? ".obj"
                                                                      : ".json";
  if (form != wanted && !(wanted == ".json" && form == ".xml"))
    refuse(text.out.string(),
           "does not fit " + text.in.string() + ", " + found->kind + ": name a file that ends in " + wanted);
  if (!text.source.empty() || !text.label.empty() || !text.as.empty() || !text.keeps_identity())
    refuse(text.out.string(),
           "is written exactly as the archive stores it: leave --source, --label, --as and --identity out");
  need_folder_of(text.out);
  Timings timings;
  std::uint64_t size = 0;
  if (found->picture) {
    voxel::write_image(text.out, found->picture->size_px, found->picture->rgb);
    size = fs::file_size(text.out);
  } else {
    std::string bytes = found->document;
    try {
      if (form == ".json") bytes = plan_in_document(bytes);
    } catch (const std::runtime_error& error) {
      refuse(text.in.string(), error.what());
    }
    voxel::write_file(text.out, bytes);
    size = bytes.size();
  }
  Json json = answer(timings);
  json["kind"] = found->kind;
  json["path"] = text.out.string();
  json["bytes"] = size;
  program.say(json, lines({{"written", text.out.string()}, {"from", found->kind}}));
  return done;
}

std::optional<int> info_of_archived(const Program& program, const fs::path& path) {
  Timings timings;
  std::optional<voxel::ArchivedObject> found;
  {
    const Stopwatch watch(timings, "read");
    found = voxel::read_archived(path);
  }
  if (!found) return std::nullopt;
  Json json = answer(timings);
  json["kind"] = "DICOM " + found->kind;
  json["source"] = path.string();
  json["title"] = found->title;
  json["class_uid"] = found->class_uid;
  json["patient"] = {{"name", found->patient_name}, {"number", found->patient_id}};
  json["identity_removed"] = found->is_identity_removed;
  json["study_uid"] = found->study_uid;
  json["series_uid"] = found->series_uid;
  std::vector<std::pair<std::string, std::string>> rows{
      {"DICOM", found->kind},
      {"title", found->title},
      {"patient", found->patient_name + ", " + found->patient_id}};
  if (found->picture) {
    json["size_px"] = {found->picture->size_px.x, found->picture->size_px.y};
    rows.emplace_back("pixels", std::to_string(found->picture->size_px.x) + " x " +
                                    std::to_string(found->picture->size_px.y));
  } else {
    json["media_type"] = found->media_type;
    json["bytes"] = found->document.size();
    rows.emplace_back("document",
                      found->media_type + ", " + std::to_string(found->document.size()) + " bytes");
  }
  if (found->kind == "encapsulated CDA") {
    json["plan"] = nullptr;
    std::string said = "none";
    try {
      const std::string bytes = plan_in_document(found->document);
      const Json plan = plan_json(bytes, path.string());
      const std::size_t steps = plan.contains("steps") ? plan["steps"].size() : 0;
      json["plan"] = {{"name", plan.value("name", "")}, {"steps", steps}, {"bytes", bytes.size()}};
      said =
          plan.value("name", "") + ", " + std::to_string(steps) + " steps, complete according to its SHA-256";
    } catch (const std::exception& error) {
      json["finding"] = error.what();
      said = error.what();
    }
    rows.emplace_back("plan", said);
  }
  program.say(json, lines(rows));
  return done;
}

}  // namespace octotomy::planner::cli
