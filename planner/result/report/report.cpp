// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/report.h"

#include <algorithm>
#include <fstream>

#include "convert/deck/deck.h"
#include "planner/operation/anatomy/head_directions.h"
#include "planner/operation/anatomy/movement.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/procedure/cephalometry/cephalogram.h"
#include "planner/procedure/cephalometry/measured.h"
#include "planner/result/report/contact_pictures.h"
#include "planner/result/report/credibility.h"
#include "planner/result/report/patient.h"
#include "planner/result/report/pdf.h"
#include "planner/result/report/report_page.h"
#include "planner/result/report/result_folder.h"
#include "planner/result/report/result_tables.h"
#include "voxel/filter/components.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

constexpr int picture_px = 480, cephalogram_px = 700;

Json certificates_json(const Evaluation& evaluation) {
  Json certificates = Json::array();
  for (const Object& object : evaluation.objects) {
    if (!object.certificate) continue;
    Json json{{"object", object.id}};
    json.update(to_json(*object.certificate));
    json.update({{"findings", object.findings}});
    certificates.push_back(std::move(json));
  }
  return certificates;
}

Json exported_json(const Exported& exported) {
  Json json{{"id", exported.id},
            {"object", exported.object},
            {"path", exported.path},
            {"written", exported.written}};
  json.update(exported.details);
  json.update({{"findings", exported.findings}});
  return json;
}

void write_pictures(const Result& result, const std::filesystem::path& folder) {
  for (const PictureGroup& group : result.pictures)
    for (const ScenePicture& picture : group.pictures) {
      std::string view = picture.view;
      std::replace(view.begin(), view.end(), ',', '_');
      voxel::write_file(folder / (group.name + "_" + view + ".png"),
                        {picture.png.begin(), picture.png.end()});
    }
}

void check_signatures(Result& result) {
  std::map<std::string, std::string> sums;
  for (const ScanRecord& scan : result.evaluation.scans)
    if (scan.made_by.empty()) sums[scan.name] = scan.sha256;
  if (result.plan.text.empty()) return;
  for (const Signature& signature : signatures_of(result.plan.text)) {
    result.signatures.push_back({signature, changed_since(signature, result.plan.text, sums)});
    std::string what;
    for (const std::string& part : result.signatures.back().changed)
      what += (what.empty() ? "" : ", ") + part;
    if (!what.empty())
      result.findings.push_back({"signature", voxel::Verdict::Warn,
                                 what + " changed after " + signature.by + " (" + signature.as +
                                     ") signed at " + signature.at + ": it must be read and signed again"});
  }
}

void add_cephalometry(Result& result) {
  if (result.plan.landmarks.empty()) return;
  const Objects& objects = result.evaluation.objects;
  const Cephalometry definitions = read_cephalometry("lateral");
  const std::vector<MovedLandmark> landmarks = moved_landmarks(objects, result.plan.landmarks);
  const CephalometricResults found = measured(definitions, landmarks, objects.lps_from_head);
  if (found.measured.empty()) return;
  result.cephalometry = to_json(found, {});
  for (const Object& object : objects) {
    if (!object.shown || object.moved) continue;
    const Cephalogram drawn =
        draw_cephalogram(object.shown->grey, definitions, landmarks, objects.lps_from_head, cephalogram_px);
    result.cephalogram = voxel::encode_image("png", drawn.size_px, drawn.rgb);
    return;
  }
}

}  // namespace

VerdictCounts& VerdictCounts::operator+=(const VerdictCounts& other) {
  pass += other.pass;
  warn += other.warn;
  fail += other.fail;
  not_resolved += other.not_resolved;
  pass_not_resolved += other.pass_not_resolved;
  without_evidence += other.without_evidence;
  without_certificate += other.without_certificate;
  return *this;
}

void add(VerdictCounts& counts, const verify::Certificate& certificate) {
  const bool passes = certificate.verdict == verify::Verdict::Pass;
  (passes ? counts.pass : certificate.verdict == verify::Verdict::Warn ? counts.warn : counts.fail)++;
  if (certificate.resolved()) return;
  ++counts.not_resolved;
  if (passes) ++counts.pass_not_resolved;
  if (passes && !verify::is_evident(certificate)) ++counts.without_evidence;
}

VerdictCounts verdict_counts(const Evaluation& evaluation) {
  VerdictCounts counts;
  for (const Object& object : evaluation.objects)
    if (object.certificate)
      add(counts, *object.certificate);
    else if (!object.is_tool)
      ++counts.without_certificate;
  return counts;
}

Json to_json(const VerdictCounts& counts) {
  return {{"PASS", counts.pass},
          {"WARN", counts.warn},
          {"FAIL", counts.fail},
          {"not_resolved", counts.not_resolved},
          {"without_evidence", counts.without_evidence + counts.without_certificate},
          {"without_certificate", counts.without_certificate}};
}

std::string text_of(const VerdictCounts& counts) {
  return std::to_string(counts.pass) + " PASS" +
         (counts.pass_not_resolved > 0 ? " (" + std::to_string(counts.pass_not_resolved) + " not resolved)"
                                       : "") +
         ", " + std::to_string(counts.warn) + " WARN, " + std::to_string(counts.fail) + " FAIL" +
         (counts.without_certificate > 0
              ? ", " + std::to_string(counts.without_certificate) + " without a certificate"
              : "");
}

MeasuredVerdicts measured_verdicts(const Json& measurements) {
  MeasuredVerdicts found;
  for (const Json& measurement : measurements) {
    const auto verdict = measurement.find("verdict");
    if (verdict == measurement.end() || !verdict->is_string()) continue;
    if (*verdict == "PASS") ++found.pass;
    if (*verdict == "WARN") ++found.warn;
    if (*verdict != "FAIL") continue;
    ++found.fail;
    const auto findings = measurement.find("findings");
    std::string line = "'" + measurement.value("id", std::string()) + "'";
    if (findings != measurement.end() && !findings->empty()) {
      // A finding may begin with a verdict. A WARN may stand before the FAIL, which is the one to quote.
      const auto worst = std::find_if(findings->begin(), findings->end(), [](const Json& finding) {
        return finding.get<std::string>().starts_with("FAIL");
      });
      line += ": " + (worst == findings->end() ? findings->front() : *worst).get<std::string>();
    }
    found.failed.push_back(std::move(line));
  }
  return found;
}

Json to_json(const MeasuredVerdicts& verdicts) {
  return {{"PASS", verdicts.pass}, {"WARN", verdicts.warn}, {"FAIL", verdicts.fail}};
}

Json counts_json(const Result& result) {
  Json counts = to_json(verdict_counts(result.evaluation));
  counts["measured"] = to_json(measured_verdicts(result.measurements));
  return counts;
}

Parts parts_of(const Object& object) {
  const double voxel_mm3 = object.voxel.octree.universe().lattice().voxel_mm3();
  Parts parts{object.id, {}};
  for (const std::uint64_t count : voxel::components(object.voxel.octree).voxel_counts)
    parts.volumes_mm3.push_back(static_cast<double>(count) * voxel_mm3);
  return parts;
}

std::vector<PictureGroup> plan_pictures(const Plan& plan, Evaluation& evaluation) {
  const Stopwatch watch(evaluation.timings, "render");
  const FinalScene scene = final_scene(plan, evaluation);
  std::vector<voxel::DrawnObject> framed = scene.before;
  framed.insert(framed.end(), scene.after.begin(), scene.after.end());
  std::vector<PictureGroup> groups;
  if (scene.moves) {
    groups.push_back({"before", "Before", scene.before, {}});
    draw(groups.back(), {"left", "35,15"}, framed, picture_px, evaluation.objects.lps_from_head);
  }
  groups.push_back({"after", scene.moves ? "Views after" : "Views", scene.after, {}});
  draw(groups.back(), all_views(), framed, picture_px, evaluation.objects.lps_from_head);
  return groups;
}

Json result_json(const Result& result) {
  const Evaluation& evaluation = result.evaluation;
  const auto list_of = [](const auto& values, const auto& print) {
    Json list = Json::array();
    for (const auto& value : values) list.push_back(print(value));
    return list;
  };
  const auto as_json = [](const auto& value) { return to_json(value); };
  Json json = answer(evaluation.timings);
  json.update(
      {{"plan", result.plan.text.empty()
                    ? Json{{"name", result.plan.name}, {"steps", result.plan.steps.size()}}
                    : Json::parse(result.plan.text)},
       {"universe",
        {{"side", evaluation.universe.side()},
         {"voxel_mm", to_json(evaluation.universe.lattice().spacing_mm())},
         {"lps_from_voxel", to_json(evaluation.universe.lps_from_voxel)}}},
       {"scans", list_of(evaluation.scans, as_json)},
       {"objects", list_of(evaluation.objects, as_json)},
       {"components", list_of(result.parts,
                              [](const Parts& parts) {
                                return Json{{"object", parts.object},
                                            {"count", parts.volumes_mm3.size()},
                                            {"volumes_mm3", parts.volumes_mm3}};
                              })},
       {"exports", list_of(result.exported, exported_json)},
       {"landmarks", list_of(result.plan.landmarks,
                             [](const NamedPoint& landmark) {
                               return Json{{"name", landmark.name}, {"point_mm", to_json(landmark.p_mm)}};
                             })},
       {"lps_from_head", to_json(evaluation.objects.lps_from_head)},
       {"movements", result.movements},
       {"movement_words", movement_words},
       {"signatures", list_of(result.signatures,
                              [](const SignatureCheck& check) {
                                Json signature = to_json(check.signature);
                                signature.update({{"changed_since", check.changed}});
                                return signature;
                              })},
       {"cephalometry", result.cephalometry},
       {"measurements", result.measurements},
       {"certificates", certificates_json(evaluation)},
       {"counts", counts_json(result)},
       {"findings", to_json(result.findings)}});
  return json;
}

std::vector<std::filesystem::path> result_names(const Plan& plan) {
  std::vector<std::filesystem::path> names{"report.html", "report.pdf", "result.json", "credibility.html",
                                           "credibility.json"};
  for (const Step& step : plan.steps)
    if (const std::filesystem::path path = path_written(step.action); convert::is_deck(path))
      for (std::filesystem::path& file : convert::deck_files(path)) names.push_back(std::move(file));
    else if (!path.empty()) {
      if (step.action.operation().name == std::string("label_map")) names.push_back(label_table_path(path));
      names.push_back(path);
    }
  return names;
}

Json write_result_files(Result& result, const std::filesystem::path& folder, const ExportOptions& options) {
  if (result.anonymous) leave_out_patients(result);
  {
    const Stopwatch watch(result.evaluation.timings, "measure");
    result.measurements = measurements_json(result.plan, result.evaluation);
    result.movements = movements_json(result.evaluation.objects, result.plan.landmarks);
    add_cephalometry(result);
    check_signatures(result);
    add_contact_pictures(result);
  }
  if (result.exported.empty())
    result.exported = write_files(result.plan, result.evaluation, folder, result.evaluation.timings, options);
  {
    const Stopwatch watch(result.evaluation.timings, "write");
    voxel::create_folders_in(folder, "views");
    write_pictures(result, folder / "views");
    if (!result.cephalogram.empty())
      voxel::write_file(folder / "views/cephalogram.png",
                        {result.cephalogram.begin(), result.cephalogram.end()});
    voxel::write_file(folder / "report.html", report_html(result));
    if (result.as_pdf) {
      print_pdf(folder / "report.html", folder / "report.pdf", options.stop);
      if (names_nobody(result))
        std::ofstream(folder / "report.pdf", std::ios::binary | std::ios::app) << anonymous_pdf_mark;
    }
  }
  Json json = result_json(result);
  for (const auto& [name, text] : result_tables(json)) {
    voxel::create_folders_in(folder, std::filesystem::path(name).parent_path());
    voxel::write_file(folder / name, text);
  }
  const Json credibility = credibility_json(json);
  voxel::write_file(folder / "credibility.json", json_text(credibility, 2) + "\n");
  voxel::write_file(folder / "credibility.html", credibility_html(credibility));
  voxel::write_file(folder / "result.json", json_text(json, 2) + "\n");
  return json;
}

Json write_result(Result& result, const std::filesystem::path& folder, const ExportOptions& options) {
  ResultFolder output(folder);
  const bool again = !result.exported.empty();
  Json json = write_result_files(result, output.path(), options);
  if (again) output.copy_rest();
  output.publish();
  return json;
}

}  // namespace octotomy::planner
