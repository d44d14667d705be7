// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/plan/evaluate.h"
#include "planner/plan/plan_results.h"
#include "planner/plan/signature.h"
#include "planner/result/report/scene_pictures.h"
#include "voxel/space/scene.h"

namespace octotomy::planner {

/// Connected parts of an object, largest first.
struct Parts {
  std::string object;
  std::vector<double> volumes_mm3;
};

/// A reader's signature, and the changes since it was made.
struct SignatureCheck {
  Signature signature;
  std::vector<std::string> changed;
};

/// All results of a plan's evaluation.
struct Result {
  Plan plan;
  Evaluation evaluation;
  std::vector<PictureGroup> pictures;
  std::vector<Exported> exported;
  std::vector<Parts> parts;
  nlohmann::ordered_json measurements = nlohmann::ordered_json::array();  ///< measurements_json()
  nlohmann::ordered_json movements = nlohmann::ordered_json::array();     ///< movements_json()
  nlohmann::ordered_json cephalometry;    ///< to_json() of measured(); null without landmarks for any measure
  std::vector<std::uint8_t> cephalogram;  ///< PNG; empty without such landmarks or samples
  std::vector<SignatureCheck> signatures;
  bool as_pdf = false;                   ///< the report is also printed as report.pdf
  bool anonymous = false;                ///< report, tables and JSON do not name the patient:
                                         ///< leave_out_patients()
  std::vector<voxel::Finding> findings;  ///< findings on the plan as a whole, in addition to those on its
                                         ///< parts
};

/// Certificates by verdict.
struct VerdictCounts {
  int pass = 0, warn = 0, fail = 0;
  int not_resolved = 0;         ///< how many of all three are objects that are too small or thin for their
                                ///< voxels
  int pass_not_resolved = 0;    ///< the same for `pass` only: these prove little
  int without_evidence = 0;     ///< how many of `pass` prove nothing (verify::is_evident())
  int without_certificate = 0;  ///< in none of the three: objects that no kernel checks, without masks

  VerdictCounts& operator+=(const VerdictCounts& other);
};
/// Adds a certificate to the counts.
void add(VerdictCounts& counts, const verify::Certificate& certificate);
VerdictCounts verdict_counts(const Evaluation& evaluation);
/// {"PASS": ..., "WARN": ..., "FAIL": ..., "not_resolved": ..., "without_evidence": ...,
/// "without_certificate": ...}: the first three add up to all certificates. Objects without one are among
/// those without evidence.
nlohmann::ordered_json to_json(const VerdictCounts& counts);
/// "6 PASS (1 not resolved), 0 WARN, 0 FAIL", and ", 2 without a certificate" if there are any.
std::string text_of(const VerdictCounts& counts);

/// Counts of the measurements that have a verdict of their own, such as those of printed parts.
struct MeasuredVerdicts {
  int pass = 0, warn = 0, fail = 0;
  std::vector<std::string> failed;  ///< for each FAIL, its step and its finding
};
/// Counts the verdicts in measurements_json(). Measurements without a verdict are not counted.
MeasuredVerdicts measured_verdicts(const nlohmann::ordered_json& measurements);
/// {"PASS": ..., "WARN": ..., "FAIL": ...}
nlohmann::ordered_json to_json(const MeasuredVerdicts& verdicts);
/// The counts of the certificates, and in `measured` those of the measurements. Precondition: the result's
/// measurements were made.
nlohmann::ordered_json counts_json(const Result& result);

/// The connected parts (by faces) of an object in the voxel kernel.
Parts parts_of(const Object& object);

/// Pictures of a plan's final scene in all views and, if something moved, the left and an oblique view of the
/// scene before. Adds the time to "render".
std::vector<PictureGroup> plan_pictures(const Plan& plan, Evaluation& evaluation);

/// The whole result as JSON: scans with their audit, universe, objects, measurements, certificates, exports,
/// findings, timings.
nlohmann::ordered_json result_json(const Result& result);

/// Paths in the result's folder to pass to need_result_folder() before a plan is evaluated.
std::vector<std::filesystem::path> result_names(const Plan& plan);

/// Writes the files of a result into `folder`. Only report.html and report.pdf name the patient, and not if
/// the result is anonymous; result.json and the tables never do, except if an audit quotes the patients of
/// files that do not belong together. The folder must exist and must not be a published result: it is a part
/// of a larger result, such as ResultFolder::path(). Otherwise like write_result(). Throws as the writers do,
/// and Stopped.
nlohmann::ordered_json write_result_files(Result& result, const std::filesystem::path& folder,
                                          const ExportOptions& options = {});

/// Writes a result's folder completely or not at all: its exports, views/*.png, tables/*.csv, report.html,
/// credibility.html and .json, and result.json. Fills `result.exported` and `result.measurements`; returns
/// the contents of result.json. If the same result was written to the folder before, its exports there are
/// kept. Precondition: that of ResultFolder. Throws as ResultFolder and the writers do, and Stopped if a stop
/// is requested while an export is meshed or written.
nlohmann::ordered_json write_result(Result& result, const std::filesystem::path& folder,
                                    const ExportOptions& options = {});

}  // namespace octotomy::planner
