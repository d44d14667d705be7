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

/// Volumes of the connected parts of an object, largest first.
struct Parts {
  std::string object;
  std::vector<double> volumes_mm3;
};

/// A signature, and the changes since it was made.
struct SignatureCheck {
  Signature signature;
  std::vector<std::string> changed;
};

/// Everything that the evaluation of a plan has produced.
struct Result {
  Plan plan;
  Evaluation evaluation;
  std::vector<PictureGroup> pictures;
  std::vector<Exported> exported;
  std::vector<Parts> parts;
  nlohmann::ordered_json measurements = nlohmann::ordered_json::array();  ///< measurements_json()
  nlohmann::ordered_json movements = nlohmann::ordered_json::array();     ///< movements_json()
  nlohmann::ordered_json cephalometry;    ///< to_json() of measured(); null if the landmarks allow no measure
  std::vector<std::uint8_t> cephalogram;  ///< PNG; empty without such landmarks or without a scan
  std::vector<SignatureCheck> signatures;
  bool as_pdf = false;                   ///< also prints the report as report.pdf
  bool anonymous = false;                ///< report, tables and JSON do not name the patient:
                                         ///< leave_out_patients()
  std::vector<voxel::Finding> findings;  ///< findings on the plan as a whole, besides those on its
                                         ///< parts
};

/// Certificates by verdict.
struct VerdictCounts {
  int pass = 0, warn = 0, fail = 0;
  int not_resolved = 0;         ///< certificates of any verdict whose object is too small or thin for its
                                ///< voxels
  int pass_not_resolved = 0;    ///< those of them that are a PASS, which proves little
  int without_evidence = 0;     ///< certificates with PASS that prove nothing (verify::is_evident())
  int without_certificate = 0;  ///< objects without a certificate, except masks; not counted above

  VerdictCounts& operator+=(const VerdictCounts& other);
};
/// Adds a certificate to the counts.
void add(VerdictCounts& counts, const verify::Certificate& certificate);
VerdictCounts verdict_counts(const Evaluation& evaluation);
/// {"PASS", "WARN", "FAIL", "not_resolved", "without_evidence", "without_certificate"}. The first three add
/// up to the number of certificates. "without_evidence" includes the objects without a certificate.
nlohmann::ordered_json to_json(const VerdictCounts& counts);
/// The counts as text, such as "6 PASS (1 not resolved), 0 WARN, 0 FAIL", with ", 2 without a certificate" if
/// there are such objects.
std::string text_of(const VerdictCounts& counts);

/// Counts of the verdicts of measurements. Only some kinds have a verdict, such as proofs of printed parts.
struct MeasuredVerdicts {
  int pass = 0, warn = 0, fail = 0;
  std::vector<std::string> failed;  ///< step and finding of each FAIL
};
/// Counts the verdicts in the JSON of measurements_json(). Ignores measurements without a verdict.
MeasuredVerdicts measured_verdicts(const nlohmann::ordered_json& measurements);
/// {"PASS", "WARN", "FAIL"}
nlohmann::ordered_json to_json(const MeasuredVerdicts& verdicts);
/// The counts of certificates, and those of measurements as "measured". Precondition: the result's
/// measurements are computed.
nlohmann::ordered_json counts_json(const Result& result);

/// The connected parts of an object's voxels. Voxels are connected if they share a face.
Parts parts_of(const Object& object);

/// Pictures of the plan's final scene in all views. If something has moved, also two views, the left one and
/// an oblique one, of the scene before. Adds the time to the stage "render".
std::vector<PictureGroup> plan_pictures(const Plan& plan, Evaluation& evaluation);

/// The whole result as JSON: scans with their audits, universe, objects, measurements, certificates, exports,
/// findings and times.
nlohmann::ordered_json result_json(const Result& result);

/// Paths that a result of the plan will have in its folder, for need_result_folder().
std::vector<std::filesystem::path> result_names(const Plan& plan);

/// Writes the files of a result into `folder`, as write_result() does, but in place. The folder must exist
/// and must not be a published result; it is usually a part of a larger one, such as ResultFolder::path().
/// Only report.html and report.pdf name the patient, unless the result is anonymous. result.json and the
/// tables do not, except where an audit quotes the patients of files that do not belong together. Throws as
/// the writers do, and Stopped.
nlohmann::ordered_json write_result_files(Result& result, const std::filesystem::path& folder,
                                          const ExportOptions& options = {});

/// Writes the folder of a result, which appears only when it is complete: exports, views/*.png, tables/*.csv,
/// report.html, credibility.html and .json, and result.json. Computes `result.exported` and
/// `result.measurements`, and returns the contents of result.json. Exports of the same result that the folder
/// already has are kept. Precondition: that of ResultFolder. Throws as ResultFolder and the writers do, and
/// Stopped if a stop is requested while an export is made.
nlohmann::ordered_json write_result(Result& result, const std::filesystem::path& folder,
                                    const ExportOptions& options = {});

}  // namespace octotomy::planner
