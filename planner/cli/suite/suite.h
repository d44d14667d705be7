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

// The verb `octotomy verify`: certifies a plan or a question, or runs one of the suites that test the
// verifier itself.
namespace octotomy::planner::cli {

/// The command line of `verify`, including the options of all suites.
struct VerifyText : PlanIn {
  std::vector<std::string> subject;  ///< a plan, or A, OP and B; empty if a suite is named
  std::optional<double> operand_voxel_mm;
  std::optional<std::filesystem::path> report;  ///< a folder for report.html and result.json
  std::optional<std::filesystem::path> answer;  ///< for A OP B: the answer of another program, to be compared
  bool accept_unresolved = false;
  bool faults = false, phantoms = false, self = false, thesis = false;
  int poses = 6;         ///< number of poses of --phantoms
  int solids = 400;      ///< for --phantoms: number of solids whose intervals are compared with the truth
  int alterations = 60;  ///< number of alterations of --faults
  int random_count = 0;
  std::vector<RandomTier> random_tiers;  ///< none: all
  std::uint64_t seed = 1;
  std::filesystem::path failures = "disagreements";
};

/// The results of a suite. The JSON output consists of the certificates, their counts and the members of
/// `more`.
struct SuiteAnswer {
  Timings timings;
  Json certificates = Json::array();
  VerdictCounts counts;
  Json more = Json::object();
  std::vector<std::string> not_covered;    ///< why questions have no certificate, one sentence each
  std::optional<verify::Contested> worst;  ///< the object with the worst certificate, for the report
  std::string text;                        ///< text for standard output
  bool held = true;                        ///< false: exit status 1, even if no certificate is a FAIL
};

/// A suite of tests. `run` checks program.stop between cases and throws Stopped, and reports its progress by
/// program.progress().
struct Suite {
  /// Adds the suite's flag and options to the verb; returns the option that selects the suite.
  CLI::Option* (*add)(CLI::App& verb, VerifyText& text);
  SuiteAnswer (*run)(Program& program, const VerifyText& text);
};

/// Adds `verify` and its suites to the program.
void add_verify_verbs(Program& program);

}  // namespace octotomy::planner::cli
