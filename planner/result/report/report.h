// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/plan/answers.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/signature.h"
#include "planner/result/report/scene_pictures.h"
#include "voxel/space/scene.h"

namespace octotomy::planner {

/// Connected parts of an object, largest first.
struct Parts {
  std::string object;
  std::vector<double> volumes_mm3;
};

/// A reader's signature, and what has changed since.
struct SignatureCheck {
  Signature signature;
  std::vector<std::string> changed;
};

/// Everything a plan's evaluation leaves behind.
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
  bool as_pdf = false;                   ///< the report is printed as report.pdf, too
  bool anonymous = false;                ///< report, tables and JSON name no patient: leave_out_patients()
  std::vector<voxel::Finding> findings;  ///< on the plan as a whole, beside those of its parts
};

/// Certificates by verdict.
struct VerdictCounts {
  int pass = 0, warn = 0, fail = 0;
  int not_resolved = 0;         ///< of all three, the objects that are too small or thin for their voxels
  int pass_not_resolved = 0;    ///< of `pass` alone: these prove little
  int without_evidence = 0;     ///< of `pass` alone: these prove nothing (verify::is_evident())
  int without_certificate = 0;  ///< of none of the three: objects that no kernel checks; masks do not count

  VerdictCounts& operator+=(const VerdictCounts& other);
};
/// Counts one more.
void add(VerdictCounts& counts, const verify::Certificate& certificate);
VerdictCounts verdict_counts(const Evaluation& evaluation);
/// {"PASS": ..., "WARN": ..., "FAIL": ..., "not_resolved": ..., "without_evidence": ...,
/// "without_certificate": ...}: the first three add up to all certificates. Objects without one are among
/// those without evidence.
nlohmann::ordered_json to_json(const VerdictCounts& counts);
/// "6 PASS (1 not resolved), 0 WARN, 0 FAIL", and ", 2 without a certificate" where there are such.
std::string text_of(const VerdictCounts& counts);

/// The connected parts (by faces) of an object in the voxel kernel.
Parts parts_of(const Object& object);

/// Pictures of a plan's end: all views of the final scene and, where something moved, the left and an
/// oblique view of it before. Time is added to "render".
std::vector<PictureGroup> plan_pictures(const Plan& plan, Evaluation& evaluation);

/// The whole result as JSON: scans with their audit, universe, objects, measurements, certificates, exports,
/// findings, timings.
nlohmann::ordered_json result_json(const Result& result);

/// Paths in the result's folder that need_result_folder() is asked about before a plan is evaluated.
std::vector<std::filesystem::path> result_names(const Plan& plan);

/// Writes what a result's folder holds into `folder`. Only report.html and report.pdf name the patient, and
/// neither does where the result is anonymous; result.json and the tables never do, except where an audit
/// quotes the patients of files that do not belong together. The folder is there and is nobody's result yet:
/// a part of a larger result, as ResultFolder::path(). Otherwise as write_result(). Throws as the writers do,
/// and Stopped.
nlohmann::ordered_json write_result_files(Result& result, const std::filesystem::path& folder,
                                          const ExportOptions& options = {});

/// Writes a result's folder whole or not at all: its exports, views/*.png, tables/*.csv, report.html,
/// credibility.html and .json, and result.json.
/// Fills `result.exported` and `result.measurements`; returns what result.json holds. A result that was
/// written to the folder before keeps the exports that lie there.
/// Precondition: as of ResultFolder. Throws as ResultFolder and the writers do, and Stopped if the stop token
/// is set while an export is filled or written.
nlohmann::ordered_json write_result(Result& result, const std::filesystem::path& folder,
                                    const ExportOptions& options = {});

}  // namespace octotomy::planner
