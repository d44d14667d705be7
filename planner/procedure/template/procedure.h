// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "brep/align/register_landmarks.h"

namespace octotomy::planner {

/// A number that a user can enter for a procedure.
struct ProcedureValue {
  std::string name;  ///< ends in its unit: "forward_mm"
  std::string says;
  double preset = 0.0;
  double least = 0.0, most = 0.0;
};
struct ProcedureLandmark {
  std::string name;
  std::string says;  ///< its definition
  std::string scan;  ///< the further scan on which it is placed; empty: the patient's scan
};
/// A scan that a procedure needs besides the patient's, such as that of a donor bone.
struct ProcedureScan {
  std::string name;
  std::string says;
};

/// Optional values and steps of a procedure, such as guides for its cuts.
struct ProcedureOption {
  std::string name;
  std::string says;
  std::vector<ProcedureValue> values;
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
};

/// An operation that landmarks and entered values define. Its steps contain formulas.
struct Procedure {
  std::string name;
  std::string says;
  std::vector<ProcedureLandmark> landmarks;
  std::vector<ProcedureScan> scans;  ///< in addition to the patient's, which is "ct"
  std::vector<ProcedureValue> values;
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  /// Id of the step that is the patient's bone. After an earlier procedure, that procedure's outcome takes
  /// its place.
  std::string acts_on = {};
  /// Id of the step with the result, on which a further procedure acts.
  std::string outcome = {};
  std::vector<ProcedureOption> options = {};
};

/// Largest number of values of a procedure, and of each of its options.
inline constexpr std::size_t most_values = 12;

/// Values of formulas are rounded to 1 / roundings_per_unit, which for lengths is a tenth of a micrometre, so
/// that plans are easy to read.
inline constexpr double roundings_per_unit = 1e4;

/// Parses a procedure's JSON. Throws std::runtime_error with the place in the text.
Procedure parse_procedure(const std::string& json);
/// Reads a procedure: that of the program with this name, or that of a file that ends in .json. Throws
/// std::runtime_error, with the most similar name, if there is none.
Procedure read_procedure(const std::string& name_or_path);
/// Names of the program's procedures.
std::vector<std::string> procedures();

/// The procedure with the values and steps of these options, in the order of its file. Throws
/// std::runtime_error, with the most similar name, for an unknown option.
Procedure with_options(const Procedure& procedure, const std::vector<std::string>& names);
/// The procedure with the values and steps of all its options.
Procedure with_all_options(const Procedure& procedure);

/// Compares the scans that are given besides the patient's with those that the procedure uses. Throws
/// std::runtime_error if a given scan is not used, or if a used scan is neither given nor in `known`, with
/// the scan's definition.
void need_scans(const Procedure& procedure, const std::map<std::string, nlohmann::ordered_json>& given,
                const nlohmann::ordered_json& known);

struct ProcedureInput {
  nlohmann::ordered_json scan;                                  ///< as a plan's entry: {"path": ...}
  std::map<std::string, nlohmann::ordered_json> further_scans;  ///< by the procedure's names
  std::vector<brep::Landmark> landmarks;
  std::map<std::string, double> values;  ///< values that differ from the preset
  double voxel_mm = 1.0;
  std::filesystem::path folder;  ///< folder of the plan
};

/// A plan of the procedure for one head, as JSON. If the landmarks include both porions and an orbitale, they
/// define the head's orientation: the Frankfort plane is horizontal, and nasion and basion, if present, lie
/// in the mid-plane. Throws std::runtime_error if a landmark or scan is missing, with its definition, if a
/// value is unknown or out of range, or if a formula or the plan is refused, for example because left and
/// right landmarks are exchanged.
nlohmann::ordered_json plan_of(const Procedure& procedure, const ProcedureInput& input);

/// The coordinates of landmarks as formulas name them, such as "ans.x", along the head's directions.
/// `landmarks` are in LPS.
std::map<std::string, double> coordinates_of(const std::vector<brep::Landmark>& landmarks,
                                             const glm::dmat3& lps_from_head);

/// The steps of the procedure with formulas evaluated, without landmarks and orientation. `landmarks` are in
/// LPS, `lps_from_head` is the head's orientation. Throws as plan_of() does for landmarks, values and
/// formulas.
nlohmann::ordered_json steps_of(const Procedure& procedure, const std::vector<brep::Landmark>& landmarks,
                                const std::map<std::string, double>& values, const glm::dmat3& lps_from_head);

}  // namespace octotomy::planner
