// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "planner/cli/verb/scan_in.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/plan.h"

// Options and functions that verbs share if they replay a plan.
namespace octotomy::planner {
struct Result;
}  // namespace octotomy::planner

namespace octotomy::planner::cli {

/// A plan on the command line, and the options for reading its scans.
struct PlanIn {
  std::filesystem::path plan;
  std::vector<std::string> scans;  ///< NAME=PATH each
  ScanIn in;
};
/// Adds --scan; each verb adds its own argument for the plan.
void add_scan_paths(CLI::App& verb, PlanIn& text);
/// Adds --scan and the options for reading a plan's only scan.
void add_plan_options(CLI::App& verb, PlanIn& text);

/// Reads the plan and replaces paths of scans by those of --scan NAME=PATH, which are relative to the working
/// folder. Throws as read_plan() does, and std::runtime_error if the plan has no scan NAME.
Plan plan_of(const Program& program, const PlanIn& text);
/// As above, for a plan that is already read.
Plan plan_of(const Program& program, const PlanIn& text, Plan plan);

/// Options to evaluate a plan with certificates, under the program's stop and with its progress.
EvaluateOptions evaluate_options(Program& program);

/// Evaluates a plan and stores the audits of its scans for say().
Evaluation evaluated(Program& program, const Plan& plan, const EvaluateOptions& options);

/// When the certificates of a result are computed.
enum class Certify {
  Now,
  Later,  ///< the result is written twice: first without certificates, then with them
  Never
};
struct RunText : PlanIn {
  std::filesystem::path out;
  Certify certify = Certify::Now;
  bool as_pdf = false;
  bool anonymous = false;
  std::string identity = "keep";
};
/// Replays a plan into a result's folder and prints a summary. Returns the exit status.
int run(Program& program, const RunText& text);
/// As run() above, for a plan that was already read. `beside` is called once when the result is first
/// written, for files that must appear together with it.
int run(Program& program, const RunText& text, Plan plan, const std::function<void()>& beside = {});
/// Adds --anonymous to a verb that writes a report.
void add_anonymous(CLI::App& verb, bool& anonymous);
/// Adds --identity keep|remove to a verb that writes results.
void add_result_identity(CLI::App& verb, std::string& identity);
/// Adds --identity keep|remove|new to a verb that writes files for others.
void add_identity(CLI::App& verb, std::string& identity, const std::string& does);
/// Adds --certify to a verb that replays a plan.
void add_certify(CLI::App& verb, Certify& certify);

/// Text with a line for each object: its verdict and the answers of both kernels. Prints findings to standard
/// error.
std::string verdict_text(const Evaluation& evaluation);
/// The exit status for the verdicts of a result's certificates and measurements. Prints a line to standard
/// error if one is a FAIL. Precondition: the measurements have been computed, as write_result() does.
int status_of(const Result& result);

}  // namespace octotomy::planner::cli
