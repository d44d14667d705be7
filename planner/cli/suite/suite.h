// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/cli/verb/plan_in.h"
#include "planner/operation/measure/result_json.h"
#include "planner/result/report/random_suite.h"
#include "planner/result/report/report.h"

namespace CLI {
class Option;
}  // namespace CLI

// `octotomy verify`: a plan's certificates, or one of the suites that test the verifier itself.
namespace octotomy::planner::cli {

/// What the command line says to `verify`. A suite adds the fields of its own options.
struct VerifyText : PlanIn {
  std::vector<std::string> subject;  ///< a plan, or A OP B; no suite was named
  std::optional<double> operand_voxel_mm;
  std::optional<std::filesystem::path> report;  ///< a folder for report.html and result.json
  std::optional<std::filesystem::path> answer;  ///< somebody's, to A OP B
  bool accept_unresolved = false;
  bool faults = false, phantoms = false, self = false, thesis = false;
  int poses = 6;         ///< of --phantoms
  int solids = 400;      ///< of its intervals
  int alterations = 60;  ///< of --faults
  int random_count = 0;
  std::vector<RandomTier> random_tiers;  ///< none: all
  std::uint64_t seed = 1;
  std::filesystem::path failures = "disagreements";
};

/// What a suite found. The answer's JSON has its certificates, the counts and whatever keys `more` holds.
struct SuiteAnswer {
  Timings timings;
  Json certificates = Json::array();
  VerdictCounts counts;
  Json more = Json::object();
  std::vector<std::string> not_covered;    ///< what was asked and has no certificate, a sentence each
  std::optional<verify::Contested> worst;  ///< of the certificates' objects, where they are at hand
  std::string text;                        ///< for people
  bool held = true;                        ///< false: exit status 1, besides a count of FAIL
};

/// One suite: what names it on the command line, and what runs it. It looks at program.stop between cases and
/// throws Stopped, and tells program.progress() of each.
struct Suite {
  /// Adds the suite's flag and options to the verb; the option that names the suite is returned.
  CLI::Option* (*add)(CLI::App& verb, VerifyText& text);
  SuiteAnswer (*run)(Program& program, const VerifyText& text);
};

/// Adds `verify` and its suites to the program.
void add_verify_verbs(Program& program);

}  // namespace octotomy::planner::cli
