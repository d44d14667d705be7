// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/plan_in.h"
#include "planner/cli/verb/verb.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/outcome/outcome.h"

namespace octotomy::planner::cli {
namespace {

struct OutcomeText : PlanIn {
  std::filesystem::path after;
  ScanIn after_in;
  std::string unmoved;
  std::optional<double> low;
};

std::string text_of(const Outcome& outcome) {
  const auto signed_number = [](double value) {
    return (value > 0.005 ? "+" : "") + grouped(std::abs(value) < 0.005 ? 0.0 : value, 2);
  };
  const auto row = [&](double planned, double achieved, double half_width) {
    return signed_number(planned) + " planned, " + signed_number(achieved) + " \u00b1 " +
           grouped(half_width, 2);
  };
  std::string text =
      "both scans aligned by " + outcome.unmoved + ", rms " + grouped(outcome.rms_mm, 2) + " mm\n";
  for (const PieceOutcome& piece : outcome.pieces) {
    text += piece.object + ", rms " + grouped(piece.rms_mm, 2) + " mm\n";
    std::vector<std::pair<std::string, std::string>> rows{
        {"  pitch",
         row(piece.planned_turns.pitch_deg, piece.achieved_turns.pitch_deg, piece.turn_half_width.pitch_deg) +
             "\u00b0"},
        {"  yaw",
         row(piece.planned_turns.yaw_deg, piece.achieved_turns.yaw_deg, piece.turn_half_width.yaw_deg) +
             "\u00b0"},
        {"  roll",
         row(piece.planned_turns.roll_deg, piece.achieved_turns.roll_deg, piece.turn_half_width.roll_deg) +
             "\u00b0"}};
    for (const PointOutcome& point : piece.points)
      rows.emplace_back(
          "  " + (point.name == piece.object ? "centroid" : point.name),
          "forward " + row(point.planned.forward_mm, point.achieved.forward_mm, point.half_width.forward_mm) +
              "; up " + row(point.planned.up_mm, point.achieved.up_mm, point.half_width.up_mm) + "; left " +
              row(point.planned.left_mm, point.achieved.left_mm, point.half_width.left_mm) + " mm; off by " +
              grouped(point.off_mm, 2) + " mm");
    text += lines(rows);
  }
  return text;
}

int judge(Program& program, const OutcomeText& text) {
  const Plan plan = plan_of(program, text);
  EvaluateOptions evaluation = evaluate_options(program);
  evaluation.certify = false;
  const Evaluation before = evaluated(program, plan, evaluation);
  Timings timings = before.timings;
  const voxel::Scene after = read_scan(program, text.after, text.after_in, timings);
  program.note_scan(text.after, after);
  OutcomeOptions options;
  options.unmoved = text.unmoved;
  options.low = text.low;
  options.progress = {program.stop.get_token(), program.progress("fit pieces to the later scan")};
  Outcome outcome;
  {
    const Stopwatch watch(timings, "register");
    outcome = outcome_of(plan, before, after, options);
  }
  for (const std::string& finding : outcome.findings) warn_finding(outcome.unmoved + ": " + finding);
  for (const PieceOutcome& piece : outcome.pieces)
    for (const std::string& finding : piece.findings) warn_finding(piece.object + ": " + finding);
  Json json = answer(timings);
  json.update(to_json(outcome));
  program.say(json, text_of(outcome));
  return done;
}

}  // namespace

void add_outcome(Program& program) {
  const auto text = std::make_shared<OutcomeText>();
  CLI::App& verb = program.verb(
      "outcome", "Compares a scan after the operation with the plan: achieved movements with intervals",
      "octotomy outcome my.plan.json postoperative.nrrd", [&program, text] { return judge(program, *text); });
  verb.add_option("plan", text->plan, "A .plan.json")->required()->check(CLI::ExistingFile);
  verb.add_option("after", text->after, "The scan after the operation, in any position")
      ->required()
      ->check(scan_path());
  add_scan_paths(verb, *text);
  verb.add_option("--unmoved", text->unmoved,
                  "The object that did not move; both scans are aligned by it; default: the largest that "
                  "shares no bone with a piece");
  verb.add_option("--low", text->low,
                  "Lower bound of bone in the later scan, in sample units; default: that of the plan");
  add_scan_options(verb, text->after_in, "scan after the operation");
}

}  // namespace octotomy::planner::cli
