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

/// The command line of `verify`. A suite adds fields for its own options.
struct VerifyText : PlanIn {
  std::vector<std::string> subject;  ///< a plan, or A OP B; no suite was named
  std::optional<double> operand_voxel_mm;
  std::optional<std::filesystem::path> report;  ///< a folder for report.html and result.json
  std::optional<std::filesystem::path> answer;  ///< another program's answer to A OP B
  bool accept_unresolved = false;
  bool faults = false, phantoms = false, self = false, thesis = false;
  int poses = 6;         ///< number of poses of --phantoms
  int solids = 400;      ///< number of solids for its intervals
  int alterations = 60;  ///< number of alterations of --faults
  int random_count = 0;
  std::vector<RandomTier> random_tiers;  ///< none: all
  std::uint64_t seed = 1;
  std::filesystem::path failures = "disagreements";
};

/// The results of a suite. The JSON has its certificates, the counts and the members of `more`.
struct SuiteAnswer {
  Timings timings;
  Json certificates = Json::array();
  VerdictCounts counts;
  Json more = Json::object();
  std::vector<std::string> not_covered;    ///< requests without a certificate, one sentence each
  std::optional<verify::Contested> worst;  ///< the worst of the certificates' objects, if they are available
  std::string text;                        ///< text for standard output
  bool held = true;                        ///< false: exit status 1, besides a count of FAIL
};

/// A suite: its options on the command line and the function that runs it. It checks program.stop between
/// cases, throws Stopped, and reports each case to program.progress().
struct Suite {
  /// Adds the suite's flag and options to the verb; returns the option that selects the suite.
  CLI::Option* (*add)(CLI::App& verb, VerifyText& text);
  SuiteAnswer (*run)(Program& program, const VerifyText& text);
};

/// Adds `verify` and its suites to the program.
void add_verify_verbs(Program& program);

}  // namespace octotomy::planner::cli
