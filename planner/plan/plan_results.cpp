// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/plan_results.h"

#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/plan/sha256.h"
#include "planner/plan/step_errors.h"
#include "planner/plan/trial.h"

namespace octotomy::planner {
namespace {

using Kept = std::map<std::string, std::shared_ptr<const void>>;

/// Lines on the origin of a file, for its header.
std::vector<std::string> origins_of(const Plan& plan, const Evaluation& evaluation) {
  std::vector<std::string> lines{std::string("octotomy ") + OCTOTOMY_VERSION,
                                 "plan: " + plan.name + ", SHA-256 " + sha256_of(plan.text)};
  for (const ScanRecord& scan : evaluation.scans)
    lines.push_back("scan " + scan.name + ": " +
                    (scan.made_by.empty() ? "SHA-256 " + scan.sha256 : scan.made_by));
  return lines;
}

Scans scans_of(const Evaluation& evaluation) {
  return [&evaluation](const std::string& name) -> const LoadedScan& { return *evaluation.loaded.at(name); };
}

}  // namespace

Json measurements_json(const Plan& plan, const Evaluation& evaluation) {
  Json all = Json::array();
  Timings timings;
  Kept kept;
  const AnswerBench bench{.universe = evaluation.universe,
                          .objects = evaluation.objects,
                          .scans = evaluation.scans,
                          .timings = timings,
                          .kept = kept,
                          .scan = scans_of(evaluation)};
  for (const Step& step : plan.steps) {
    if (step.action.operation().makes != Makes::Measurement) continue;
    Json json{{"id", step.id}};
    name_step_in_errors(step.id, [&] {
      json.update(step.action.operation().measure(step.action.value(), bench));
      if (const auto* trials = step.action.get_if<Trials>())
        json.update(trials_json(plan, evaluation, *trials));
    });
    all.push_back(std::move(json));
  }
  return all;
}

Exported write_file(const Plan& plan, const Evaluation& evaluation, const Step& step,
                    const std::filesystem::path& folder, Timings& timings, Kept& kept,
                    const ExportOptions& options) {
  const AnswerBench bench{.universe = evaluation.universe,
                          .objects = evaluation.objects,
                          .scans = evaluation.scans,
                          .timings = timings,
                          .stop = options.stop,
                          .report = options.progress,
                          .folder = folder,
                          .origins = origins_of(plan, evaluation),
                          .kept = kept,
                          .scan = scans_of(evaluation)};
  Exported exported;
  exported.id = step.id;
  name_step_in_errors(step.id, [&] { step.action.operation().write(step.action.value(), bench, exported); });
  if (exported.written) exported.details["bytes"] = std::filesystem::file_size(folder / exported.path);
  return exported;
}

std::vector<Exported> write_files(const Plan& plan, const Evaluation& evaluation,
                                  const std::filesystem::path& folder, Timings& timings,
                                  const ExportOptions& options) {
  std::vector<Exported> files;
  Kept kept;
  for (const Step& step : plan.steps)
    if (step.action.operation().makes == Makes::File) {
      try {
        if (const auto begun = evaluation.file_preparations.find(step.id);
            begun != evaluation.file_preparations.end())
          begun->second->finish(kept, timings, options.stop, options.progress);
        files.push_back(write_file(plan, evaluation, step, folder, timings, kept, options));
      } catch (const std::exception& error) {
        if (!options.keeps_going || !is_no_answer(error)) throw;
        Exported& lost = files.emplace_back();
        lost.id = step.id;
        for (const std::string& object : objects_used(step.action)) lost.object = object;
        lost.path = path_written(step.action).string();
        lost.findings.push_back(message_of(error));
      }
    }
  return files;
}

}  // namespace octotomy::planner
