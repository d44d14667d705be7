// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "planner/suite/suites.h"
#include "verify/fault.h"

namespace octotomy::planner::cli {
namespace {

/// A row a fault, a column a size: caught of tried.
std::string table(const std::vector<verify::DetectionPower>& powers) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const verify::DetectionPower& power : powers) {
    const std::string cell = std::to_string(power.voxels) + "\u00b3: " + std::to_string(power.caught) +
                             " of " + std::to_string(power.trials) +
                             (power.doubted > 0 ? " (" + std::to_string(power.doubted) + " WARN)" : "");
    if (rows.empty() || rows.back().first != power.fault)
      rows.emplace_back(power.fault, cell);
    else
      rows.back().second += "   " + cell;
  }
  return lines(rows);
}

SuiteAnswer run_faults(Program& program, const VerifyText& text) {
  verify::FaultOptions options;
  options.progress = {program.stop.get_token(), program.progress("faults")};
  SuiteAnswer answer;
  std::vector<verify::FaultTrial> trials;
  {
    const Stopwatch watch(answer.timings, "faults");
    trials = verify::try_faults(options);
  }
  answer.held = verify::detection_holds(trials);
  Json library = Json::array(), power = Json::array(), tried = Json::array(), missed = Json::array();
  for (const verify::Fault& fault : verify::faults())
    library.push_back(
        {{"fault", fault.name}, {"what", fault.what}, {"must_be_caught", fault.must_be_caught}});
  for (const verify::DetectionPower& row : verify::detection_power(trials))
    power.push_back({{"fault", row.fault},
                     {"voxels", row.voxels},
                     {"trials", row.trials},
                     {"caught", row.caught},
                     {"doubted", row.doubted}});
  for (const verify::FaultTrial& trial : trials) {
    const Json place{{"fault", trial.fault.empty() ? "clean" : trial.fault},
                     {"kernel", trial.kernel},
                     {"subject", trial.subject},
                     {"voxels", trial.voxels},
                     {"verdict", verify::to_string(trial.certificate.verdict)},
                     {"resolved", trial.certificate.resolved()},
                     {"reasons", trial.certificate.reasons}};
    tried.push_back(place);
    if (trial.fault.empty()) {
      // The clean twins are what the kernels really say.
      answer.certificates.push_back(to_json(trial.certificate));
      add(answer.counts, trial.certificate);
    } else if (trial.must_be_caught && trial.voxels >= verify::resolved_size && !trial.caught()) {
      missed.push_back(place);
    }
  }
  std::vector<verify::Alteration> alterations;
  {
    const Stopwatch watch(answer.timings, "alterations");
    verify::AlterationOptions by_chance;
    by_chance.seed = text.seed;
    by_chance.progress = {program.stop.get_token(), program.progress("alterations")};
    alterations = verify::try_alterations(by_chance);
  }
  int over = 0, passed = 0;
  Json altered = Json::array();
  for (const verify::Alteration& one : alterations) {
    over += one.is_over_limit;
    passed += one.is_missed();
    altered.push_back({{"kind", one.kind},
                       {"subject", one.subject},
                       {"altered_mm3", one.altered_mm3},
                       {"over_limit", one.is_over_limit},
                       {"verdict", verify::to_string(one.verdict)}});
  }
  answer.held = answer.held && passed == 0;
  answer.more = {{"alterations", altered},
                 {"alterations_over_limit", over},
                 {"alterations_passed", passed},
                 {"faults", library},
                 {"power", power},
                 {"trials", tried},
                 {"missed", missed},
                 {"held", answer.held}};
  answer.text =
      table(verify::detection_power(trials)) +
      "alterations by chance over the detection limit: " + std::to_string(passed) + " of " +
      std::to_string(over) + " passed\n" +
      (answer.held
           ? "every fault that must be caught is, from 64\u00b3 on, and no clean twin is doubted"
           : "NOT HELD: a fault was missed from 64\u00b3 on, or a clean twin did not pass; see --json") +
      "\n";
  return answer;
}

CLI::Option* add_faults(CLI::App& verb, VerifyText& text) {
  return verb.add_flag("--faults", text.faults,
                       "A suite: seeded faults in either kernel, each of which a certificate must show");
}

}  // namespace

const Suite fault_suite{add_faults, run_faults};

}  // namespace octotomy::planner::cli
