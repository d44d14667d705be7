// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>

#include "planner/cli/suite/suite.h"
#include "planner/cli/suite/suites.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/pack/pack.h"
#include "planner/result/pack/pack_check.h"
#include "planner/result/report/patient.h"
#include "planner/result/report/result_folder.h"
#include "planner/result/report/verification.h"
#include "voxel/space/unfinished_folder.h"

namespace octotomy::planner::cli {
namespace {

/// All suites.
const std::vector<Suite>& suites() {
  static const std::vector<Suite> all{fault_suite, phantoms_suite, random_suite, self_suite, thesis_suite};
  return all;
}

SuiteAnswer verify_plan(Program& program, const VerifyText& text) {
  Result result;
  result.plan = plan_of(program, text);
  result.evaluation = evaluated(program, result.plan, evaluate_options(program));
  SuiteAnswer answer;
  answer.timings = result.evaluation.timings;
  answer.certificates = result_json(result)["certificates"];
  answer.counts = verdict_counts(result.evaluation);
  answer.text = verdict_text(result.evaluation);
  need_evidence(answer, text);
  std::string uncertified;
  for (const Object& object : result.evaluation.objects) {
    if (!object.certificate && !object.is_tool)
      uncertified += (uncertified.empty() ? "'" : ", '") + object.id + "'";
    if (object.certificate)
      verify::keep_worse(answer.worst, {*object.certificate, object.voxel.octree, object.mesh.within});
    else
      answer.not_covered.push_back(object.id + ", " + object.definition + ": " +
                                   (object.is_tool
                                        ? "a mask is certified together with the objects that it cuts"
                                    : object.findings.empty() ? "there is no mesh"
                                                              : object.findings.front()));
  }
  if (!uncertified.empty()) warn("no certificate of " + uncertified + ": the findings state why");
  return answer;
}

/// The DICOM series to which the replayed pack's DICOM objects refer. None if the pack has no such objects.
/// Throws std::runtime_error if the scans were not read from a DICOM series.
std::optional<SeriesOfPlan> objects_wanted(const PackContents& packed, const Result& result,
                                           const std::filesystem::path& path) {
  if (!packed.manifest.contains("dicom")) return std::nullopt;
  std::optional<SeriesOfPlan> series = series_of(result);
  if (!series)
    throw std::runtime_error(
        path.string() +
        ": its DICOM objects refer to a DICOM series, and the scans were read from other "
        "files: give the folder of the series, --scan NAME=FOLDER");
  return series;
}

/// Replays a pack's plan, packs the result, and compares every value and every entry with those of the pack.
SuiteAnswer verify_pack(Program& program, const VerifyText& text, const std::filesystem::path& path) {
  const PackContents packed = read_pack(path);
  Result result;
  result.plan = plan_of(program, text, parse_plan(packed.plan, path.parent_path()));
  EvaluateOptions options = evaluate_options(program);
  options.prepares_files = true;
  options.keep_scans = true;
  result.evaluation = evaluated(program, result.plan, options);
  result.pictures = plan_pictures(result.plan, result.evaluation);
  SuiteAnswer answer;
  answer.timings = result.evaluation.timings;
  answer.counts = verdict_counts(result.evaluation);
  const voxel::UnfinishedFolder work(std::filesystem::temp_directory_path(), "octotomy-replay-");
  PackOptions packing{{program.stop.get_token(), program.progress()}, objects_wanted(packed, result, path)};
  const std::string identity = packed.manifest.value("identity", "");
  result.anonymous = !identity.empty();
  if (identity == "removed") leave_out_names(result);
  write_pack(result, work.path() / "replayed.zip", packing);
  const PackContents replayed = read_pack(work.path() / "replayed.zip");
  const PackComparison comparison = compare_packs(packed, replayed);
  answer.certificates = replayed.result["certificates"];
  answer.more["pack"] = to_json(comparison);
  answer.more["pack"]["packed_by"] = packed.manifest["octotomy"];
  // Another version may write equal values as other bytes, so only its values must agree.
  const bool is_of_this_version = packed.manifest["octotomy"] == OCTOTOMY_VERSION;
  answer.held =
      comparison.different_values.empty() && (comparison.different_entries.empty() || !is_of_this_version);
  std::vector<std::pair<std::string, std::string>> rows{
      {"values", grouped(static_cast<double>(comparison.values), 0) + ", of which " +
                     grouped(static_cast<double>(comparison.different_values.size()), 0) + " differ"},
      {"entries", grouped(static_cast<double>(comparison.entries), 0) + ", of which " +
                      grouped(static_cast<double>(comparison.different_entries.size()), 0) + " differ"}};
  constexpr std::size_t most_printed = 10;
  for (std::size_t i = 0; i < std::min(most_printed, comparison.different_values.size()); ++i) {
    const DifferentValue& value = comparison.different_values[i];
    rows.emplace_back("  " + value.where, "packed " + (value.packed.empty() ? "without" : value.packed) +
                                              ", replayed " +
                                              (value.replayed.empty() ? "without" : value.replayed));
  }
  for (std::size_t i = 0; i < std::min(most_printed, comparison.different_entries.size()); ++i)
    rows.emplace_back("  entry", comparison.different_entries[i]);
  answer.text = verdict_text(result.evaluation) + lines(rows);
  if (!answer.held) warn("the replay differs from the packed result");
  return answer;
}

/// Runs the suite whose option is given, or verifies a plan, a pack or questions.
SuiteAnswer chosen(Program& program, VerifyText& text, const std::vector<CLI::Option*>& named) {
  const Suite* suite = nullptr;
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (named[i]->count() == 0) continue;
    if (suite != nullptr || !text.subject.empty())
      throw CLI::ValidationError(named[i]->get_name(), "give only one: a plan, or a single suite");
    suite = &suites()[i];
  }
  if (suite != nullptr) return suite->run(program, text);
  if (text.subject.size() != 1 && text.subject.size() != 3)
    throw CLI::ValidationError("verify", "name one plan, A OP B, or a suite; see octotomy verify --help");
  const bool operands = text.subject.size() == 3;
  for (std::size_t i = 0; i < text.subject.size(); i += 2)
    if (!std::filesystem::exists(text.subject[i]))
      throw CLI::ValidationError("subject", "no such file: " + text.subject[i]);
  if (operands) return verify_operands(program, text);
  if (text.answer) throw CLI::ValidationError("--answer", "applies only to A OP B");
  if (holds_questions(text.subject.front())) return verify_questions(program, text);
  if (text.operand_voxel_mm) throw CLI::ValidationError("--voxel", "applies only to A OP B with a mesh");
  if (std::filesystem::path(text.subject.front()).extension() == ".zip")
    return verify_pack(program, text, text.subject.front());
  text.plan = text.subject.front();
  return verify_plan(program, text);
}

/// The subject of the verification, in the words of the command line.
std::string subject_of(const VerifyText& text, const std::vector<CLI::Option*>& named) {
  std::string subject;
  for (const std::string& word : text.subject) subject += (subject.empty() ? "" : " ") + word;
  for (const CLI::Option* option : named) {
    if (option->count() == 0) continue;
    subject = option->get_name();
    if (text.random_count > 0)
      subject += " " + std::to_string(text.random_count) + " --seed " + std::to_string(text.seed);
  }
  return subject;
}

int verify(Program& program, VerifyText& text, const std::vector<CLI::Option*>& named) {
  if (text.report) need_result_folder(*text.report, {"report.html", "result.json"});
  SuiteAnswer found = chosen(program, text, named);
  Json json = answer(found.timings);
  json["certificates"] = found.certificates;
  json["counts"] = to_json(found.counts);
  json.update(found.more);
  if (text.report) {
    write_verification(
        {subject_of(text, named), found.counts, json, std::move(found.not_covered), std::move(found.worst)},
        *text.report);
    json["report"] = (*text.report / "report.html").string();
    found.text += lines({{"report", (*text.report / "report.html").string()}});
  }
  program.say(json, found.text);
  if (found.counts.fail > 0) warn("the kernels disagree (a FAIL verdict)");
  return found.counts.fail > 0 || !found.held ? disagreement : done;
}

}  // namespace

void add_verify_verbs(Program& program) {
  const auto text = std::make_shared<VerifyText>();
  const auto named = std::make_shared<std::vector<CLI::Option*>>();
  CLI::App& verb = program.verb(
      "verify", "Both kernels on one question: a plan's steps, an operation on two files, or a suite",
      "octotomy verify planner/le_fort_i.plan.json --scan ct=head.nrrd --json",
      [&program, text, named] { return verify(program, *text, *named); });
  verb.add_option(
          "subject", text->subject,
          "A .plan.json; or a .zip of octotomy pack, which is replayed and compared; or A OP B: meshes, "
          "label "
          "maps or octrees of any program, and union, intersection or difference; or a folder or .json file "
          "of such questions with their results")
      ->expected(1, 3)
      ->type_name("PLAN | ZIP | A OP B | FOLDER");
  add_plan_options(verb, *text);
  add_operand_options(verb, *text);
  verb.add_flag("--accept-unresolved", text->accept_unresolved,
                "Exit status 0 even if a PASS has no evidence, because voxels are too coarse for the object");
  verb.add_option("--report", text->report,
                  "A folder for report.html, one page with verdicts, plots and pictures, and result.json")
      ->type_name("FOLDER");
  for (const Suite& suite : suites()) named->push_back(suite.add(verb, *text));
}

}  // namespace octotomy::planner::cli
