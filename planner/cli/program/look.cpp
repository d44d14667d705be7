// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <memory>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/numbers.h"
#include "planner/cli/verb/plan_in.h"
#include "planner/cli/verb/scan_in.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/first_look.h"
#include "planner/result/report/result_folder.h"

namespace octotomy::planner::cli {
namespace {

struct LookText {
  std::filesystem::path scan;
  std::filesystem::path out;
  LookOptions options;
  ScanIn in;
  bool anonymous = false;
};

int look(Program& program, LookText& text) {
  need_result_folder(text.out, {"report.html", "result.json"});
  text.options.evaluation = {program.stop.get_token(), program.progress(), true};
  text.options.read = read_options(program, text.in);
  std::unique_ptr<voxel::Undo> early;
  text.options.seen = [&](Result first) {
    ResultFolder output(text.out);
    if (output.replaces()) return;
    first.anonymous = text.anonymous;
    write_result_files(first, output.path(), {program.stop.get_token(), {}});
    early = output.publish_early();
    // Printed only on a terminal: scripts expect a single line, on how the verb ended.
    if (early && program.shows_progress())
      warn("audit and pictures: " + (text.out / "report.html").string() + "; certificates follow");
  };
  Result result = first_look(text.scan, text.options);
  for (const voxel::Finding& finding : result.findings) warn_finding(finding.detail);
  for (const ScanRecord& scan : result.evaluation.scans) program.note_scan(scan);
  if (result.evaluation.scans.front().meaning == voxel::Meaning::Hounsfield) {
    if (!text.options.bone_low) program.note_tissues({"bone"});
    if (!text.options.skin_low) program.note_tissues({"skin"});
  }
  result.anonymous = text.anonymous;
  if (program.stop.stop_requested()) throw Stopped("stopped before the result was written");
  const Json json = write_result(result, text.out, {program.stop.get_token(), program.progress()});
  std::vector<std::pair<std::string, std::string>> rows;
  for (const Object& object : result.evaluation.objects)
    rows.emplace_back(object.id,
                      grouped(object.voxel.measures.volume_mm3, 0) + " mm\u00b3 (voxels)" +
                          (object.mesh.within
                               ? ", " + grouped(object.mesh.within->size().volume_mm3, 0) + " mm\u00b3 and " +
                                     grouped(object.mesh.within->size().area_mm2, 0) + " mm\u00b2 (mesh)"
                               : "") +
                          (object.certificate ? ", " + verify::verdict_text(*object.certificate) : ""));
  for (const Parts& parts : result.parts)
    rows.emplace_back(parts.object + " parts", std::to_string(parts.volumes_mm3.size()));
  rows.emplace_back("written", (text.out / "report.html").string());
  program.say(json, lines(rows));
  return verdict_counts(result.evaluation).fail > 0 ? disagreement : done;
}

}  // namespace

void add_look(Program& program) {
  const auto text = std::make_shared<LookText>();
  CLI::App& verb =
      program.verb("look", "A first look at a scan: audit, bone and skin in pictures, certified measures",
                   "octotomy look head.nrrd -o look", [&program, text] { return look(program, *text); });
  verb.add_option("scan", text->scan, "A DICOM folder or file, NIfTI, NRRD, MetaImage, images, or a raw file")
      ->required()
      ->check(scan_path());
  verb.add_option("-o,--out", text->out,
                  "The result's folder: new, empty, or an earlier result; files that you put there stay")
      ->required();
  verb.add_option("--bone", text->options.bone_low, "Lower bound of bone in sample units; default 300 HU")
      ->check(finite())
      ->type_name("LOW");
  verb.add_option("--skin", text->options.skin_low,
                  "Lower bound of everything inside the skin, in sample units; default -300 HU")
      ->check(finite())
      ->type_name("LOW");
  add_anonymous(verb, text->anonymous);
  add_scan_options(verb, text->in);
}

}  // namespace octotomy::planner::cli
