// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "planner/cli/suite/suites.h"
#include "verify/suite/alteration.h"
#include "verify/suite/fault.h"
#include "voxel/filter/histogram.h"
#include "voxel/filter/otsu.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::planner::cli {
namespace {

/// A table of the faults that were detected, as "detected/tried": a row for each fault, a column for each
/// size.
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

/// The scans of --scan NAME=PATH, each with its window of bone: from 300 HU or, in other units, the brightest
/// of three classes.
std::vector<verify::ScanToAlter> scans_to_alter(Program& program, const VerifyText& text) {
  constexpr double bone_hu = 300.0;
  std::vector<verify::ScanToAlter> scans;
  for (const std::string& named : text.scans) {
    const std::size_t at = named.find('=');
    if (at == std::string::npos || at == 0)
      throw CLI::ValidationError("--scan", "NAME=PATH is expected, not '" + named + "'");
    const std::filesystem::path path = named.substr(at + 1);
    if (!std::filesystem::exists(path))
      throw CLI::ValidationError("--scan", "no such file: " + path.string());
    voxel::Scene scene = voxel::read_scene(path, {});
    program.note_scan(path, scene);
    const double low = scene.meaning == voxel::Meaning::Hounsfield
                           ? bone_hu
                           : std::ceil(voxel::otsu_thresholds(voxel::histogram(scene), 3).back());
    scans.push_back({named.substr(0, at), std::make_shared<const voxel::Scene>(std::move(scene)), low});
  }
  return scans;
}

/// A table of the alterations: for each kind, those above the detection limit and those that a certificate
/// passed.
std::string table(const std::vector<verify::Alteration>& alterations) {
  std::map<std::string, std::array<int, 3>> kinds;
  for (const verify::Alteration& one : alterations) {
    std::array<int, 3>& counts = kinds[one.kind];
    ++counts[0];
    counts[1] += one.is_over_limit;
    counts[2] += one.is_missed();
  }
  std::vector<std::pair<std::string, std::string>> rows;
  for (const auto& [kind, counts] : kinds)
    rows.emplace_back(
        kind, std::to_string(counts[0]) + (kind == verify::unaltered
                                               ? ""
                                               : ", over the limit " + std::to_string(counts[1]) +
                                                     ", of these passed " + std::to_string(counts[2])));
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
      // A trial without a fault has the certificate of the kernels' unaltered answers.
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
    by_chance.count = text.alterations;
    by_chance.scans = scans_to_alter(program, text);
    by_chance.progress = {program.stop.get_token(), program.progress("alterations")};
    alterations = verify::try_alterations(by_chance);
  }
  int over = 0, passed = 0, twins = 0, doubted = 0;
  Json altered = Json::array();
  for (const verify::Alteration& one : alterations) {
    over += one.is_over_limit;
    passed += one.is_missed();
    twins += one.kind == verify::unaltered;
    doubted += one.kind == verify::unaltered && one.verdict != verify::Verdict::Pass;
    altered.push_back({{"kind", one.kind},
                       {"subject", one.subject},
                       {"altered_mm3", one.altered_mm3},
                       {"over_limit", one.is_over_limit},
                       {"verdict", verify::to_string(one.verdict)},
                       {"unaltered_verdict", verify::to_string(one.clean_verdict)}});
  }
  answer.held = answer.held && passed == 0;
  answer.more = {{"alterations", altered},
                 {"alterations_over_limit", over},
                 {"alterations_passed", passed},
                 {"alterations_passed_share", over > 0 ? Json(1.0 * passed / over) : Json(nullptr)},
                 {"unaltered", twins},
                 {"unaltered_doubted", doubted},
                 {"faults", library},
                 {"power", power},
                 {"trials", tried},
                 {"missed", missed},
                 {"held", answer.held}};
  answer.text =
      table(verify::detection_power(trials)) + table(alterations) +
      "unaltered answers: " + std::to_string(doubted) + " of " + std::to_string(twins) +
      " doubted\nrandom alterations above the detection limit: " + std::to_string(passed) + " of " +
      std::to_string(over) + " passed\n" +
      (answer.held
           ? "from 64\u00b3 on, every fault that must be detected is detected, and every clean twin passes"
           : "NOT HELD: a fault was missed from 64\u00b3 on, or a clean twin did not pass; see --json") +
      "\n";
  return answer;
}

CLI::Option* add_faults(CLI::App& verb, VerifyText& text) {
  CLI::Option* flag = verb.add_flag(
      "--faults", text.faults,
      "A suite: seeded faults in either kernel, each of which a certificate must detect. With --scan "
      "NAME=PATH, once or several times, answers to objects of these scans are altered");
  verb.add_option("--alterations", text.alterations,
                  "For --faults: number of errors of random kind, place and size; default 60")
      ->check(CLI::Range(1, 1000000))
      ->needs(flag);
  return flag;
}

}  // namespace

const Suite fault_suite{add_faults, run_faults};

}  // namespace octotomy::planner::cli
