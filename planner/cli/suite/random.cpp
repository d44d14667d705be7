// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "planner/cli/suite/suites.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/random_suite.h"

namespace octotomy::planner::cli {
namespace {

Json to_json(const RandomAnswers& tier) {
  return {{"asked", tier.asked},
          {"verdicts", planner::to_json(tier.verdicts)},
          {"of_substance", tier.of_substance},
          {"no_mesh_answer", tier.no_answer},
          {"refused", tier.refused}};
}

void append(SuiteAnswer& answer, const RandomAnswers& tier) {
  for (const verify::Certificate& certificate : tier.results)
    answer.certificates.push_back(planner::to_json(certificate));
  answer.counts += tier.verdicts;
}

std::string told(const std::string& unit, const RandomAnswers& tier) {
  return std::to_string(tier.asked) + " asked; " + unit + ": " + text_of(tier.verdicts) + "; " +
         std::to_string(tier.no_answer) + " without a mesh";
}

SuiteAnswer run_random(Program& program, const VerifyText& text) {
  RandomSuiteOptions options;
  options.count = text.random_count;
  options.seed = text.seed;
  if (!text.random_tiers.empty()) options.tiers = text.random_tiers;
  options.failures = text.failures;
  options.stop = program.stop.get_token();
  options.progress = program.progress();
  SuiteAnswer answer;
  RandomSuite suite;
  {
    const Stopwatch watch(answer.timings, "random");
    suite = ask_random(options);
  }
  append(answer, suite.exact);
  append(answer, suite.as_given);
  append(answer, suite.bounded);
  answer.held = suite.disagreements.empty() && suite.substance() >= least_substance;
  Json disagreements = Json::array();
  std::vector<std::pair<std::string, std::string>> rows;
  if (suite.exact.asked > 0) rows.emplace_back("exact tier", told("questions", suite.exact));
  if (suite.as_given.asked > 0)
    rows.emplace_back("exact tier, sets as given", told("questions", suite.as_given));
  if (suite.bounded.asked > 0) rows.emplace_back("bounded tier", told("objects", suite.bounded));
  rows.emplace_back("of substance", grouped(100.0 * suite.substance(), 1) +
                                        " % of results (resolved, neither empty nor an operand), " +
                                        grouped(100.0 * least_substance, 0) + " % are needed");
  for (const Disagreement& found : suite.disagreements) {
    disagreements.push_back({{"seed", found.seed},
                             {"tier", found.tier},
                             {"question", found.question},
                             {"reasons", found.reasons},
                             {"plan", found.plan.string()},
                             {"replay", "octotomy verify --random 1 --tier " + found.tier + " --seed " +
                                            std::to_string(found.seed)}});
    rows.emplace_back("disagreement", found.tier + ", seed " + std::to_string(found.seed) + ": " +
                                          found.question + " (" + found.plan.string() + ")");
  }
  answer.more = {{"seed", options.seed},
                 {"exact", to_json(suite.exact)},
                 {"as_given", to_json(suite.as_given)},
                 {"bounded", to_json(suite.bounded)},
                 {"substance", suite.substance()},
                 {"substance_needed", least_substance},
                 {"disagreements", disagreements}};
  answer.worst = std::move(suite.worst);
  if (suite.bounded.no_answer > 0)
    answer.not_covered.push_back(std::to_string(suite.bounded.no_answer) +
                                 " results for which the mesh kernel reports that it has no answer");
  if (suite.bounded.refused > 0)
    answer.not_covered.push_back(std::to_string(suite.bounded.refused) +
                                 " plans that were refused: a window or mask without a voxel");
  answer.text = lines(rows);
  return answer;
}

CLI::Option* add_random(CLI::App& verb, VerifyText& text) {
  CLI::Option* named = verb.add_option("--random", text.random_count,
                                       "A suite: N random questions to both kernels in each tier")
                           ->check(CLI::Range(1, 1000000))
                           ->type_name("N");
  verb.add_option("--seed", text.seed, "Seed of the first random question; question i has this seed plus i")
      ->needs(named)
      ->capture_default_str();
  static const std::map<std::string, RandomTier> tiers = [] {
    std::map<std::string, RandomTier> all;
    for (const RandomTier tier : RandomSuiteOptions().tiers) all.emplace(name_of(tier), tier);
    return all;
  }();
  verb.add_option(
          "--tier", text.random_tiers,
          "Tier of the random questions: exact (sets of voxels in general position), as_given (small sets "
          "whose faces coincide) or bounded (plans on scans); default all three")
      ->needs(named)
      ->transform(CLI::Transformer(tiers))
      ->delimiter(',')
      ->type_name("NAME");
  verb.add_option("--failures", text.failures,
                  "Folder for the plans of random questions on which the kernels disagree")
      ->needs(named)
      ->capture_default_str();
  return named;
}

}  // namespace

const Suite random_suite{add_random, run_random};

}  // namespace octotomy::planner::cli
