// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "planner/cli/verb/scan_in.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/plan.h"

// What the verbs that replay a plan have in common.
namespace octotomy::planner::cli {

/// A plan as the command line names it, and what it says of the plan's scans.
struct PlanIn {
  std::filesystem::path plan;
  std::vector<std::string> scans;  ///< NAME=PATH each
  ScanIn in;
};
/// Adds --scan; the plan itself is the verb's own to name.
void add_scan_paths(CLI::App& verb, PlanIn& text);
/// Adds --scan and the options that say how the plan's scan is read.
void add_plan_options(CLI::App& verb, PlanIn& text);

/// Reads the plan and puts NAME=PATH in the place of its scans' paths; those are relative to where we are.
/// Throws as read_plan(), and std::runtime_error where --scan names none of the plan's scans.
Plan plan_of(const Program& program, const PlanIn& text);

/// Progress and stop as the program has them, certificates wanted.
EvaluateOptions evaluate_options(Program& program);

/// The plan evaluated; its scans are noted.
Evaluation evaluated(Program& program, const Plan& plan, const EvaluateOptions& options);

/// When a replay's certificates are made.
enum class Certify {
  Now,
  Later,  ///< the result is written without certificates first, and again with them
  Never
};
struct RunText : PlanIn {
  std::filesystem::path out;
  Certify certify = Certify::Now;
  bool as_pdf = false;
  bool anonymous = false;
};
/// Replays a plan into a result's folder and says what came of it; the exit status.
int run(Program& program, const RunText& text);
/// The same of a plan that was read. `beside` is called once when the result is first written: for what is
/// there with it, or not at all.
int run(Program& program, const RunText& text, Plan plan, const std::function<void()>& beside = {});
/// Adds --anonymous to a verb that writes a report.
void add_anonymous(CLI::App& verb, bool& anonymous);
/// Adds --certify to a verb that replays a plan.
void add_certify(CLI::App& verb, Certify& certify);

/// A line an object for people: its verdict with both answers. Findings go to standard error.
std::string verdict_text(const Evaluation& evaluation);
/// The exit status that the verdicts make; says so on standard error where the kernels disagree.
int status_of(const Evaluation& evaluation);

}  // namespace octotomy::planner::cli
