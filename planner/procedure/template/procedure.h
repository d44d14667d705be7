// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "brep/align/register_landmarks.h"

namespace octotomy::planner {

/// A number that the user enters for a procedure.
struct ProcedureValue {
  std::string name;  ///< ends in its unit: "forward_mm"
  std::string says;
  double preset = 0.0;
  double least = 0.0, most = 0.0;
};
struct ProcedureLandmark {
  std::string name;
  std::string says;  ///< its definition
  std::string scan;  ///< the additional scan on which it is placed; empty: the patient's scan
};
/// A scan in addition to the patient's, such as that of a donor bone.
struct ProcedureScan {
  std::string name;
  std::string says;
};

/// Further values and steps of a procedure, which the user may choose, such as guides for its cuts.
struct ProcedureOption {
  std::string name;
  std::string says;
  std::vector<ProcedureValue> values;
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
};

/// An operation defined by landmarks and entered values; its steps contain formulas.
struct Procedure {
  std::string name;
  std::string says;
  std::vector<ProcedureLandmark> landmarks;
  std::vector<ProcedureScan> scans;  ///< in addition to the patient's, which is "ct"
  std::vector<ProcedureValue> values;
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  /// The step that is the patient's bone. In a plan with an earlier procedure, its outcome takes this place.
  std::string acts_on = {};
  /// The step with the result, on which a further procedure acts.
  std::string outcome = {};
  std::vector<ProcedureOption> options = {};
};

/// The largest number of values of a procedure, and of each of its options.
inline constexpr std::size_t most_values = 12;

/// Results of formulas are rounded to 1 / roundings_per_unit, a tenth of a micrometre for lengths, so that a
/// plan is easy to read.
inline constexpr double roundings_per_unit = 1e4;

/// Reads a procedure's JSON. Throws std::runtime_error with the position in it.
Procedure parse_procedure(const std::string& json);
/// A procedure of the program by its name, or one in a file that ends in .json. Throws std::runtime_error,
/// with the nearest name, if there is none.
Procedure read_procedure(const std::string& name_or_path);
/// Names of the program's procedures.
std::vector<std::string> procedures();

/// The procedure with the values and steps of some of its options, in the order of its file. Throws
/// std::runtime_error, with the nearest name, for an option that it does not have.
Procedure with_options(const Procedure& procedure, const std::vector<std::string>& names);
/// The procedure with all its options.
Procedure with_all_options(const Procedure& procedure);

/// Checks the scans given in addition to the patient's: the procedure must use each of them, and each scan
/// that it uses must be given or in `known`. Throws std::runtime_error, with the scan's definition.
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

/// The plan of a procedure on one head, as self-contained JSON. If the landmarks include both porions and an
/// orbitale, the Frankfort plane is horizontal; nasion and basion, if present, define the mid-plane. Throws
/// std::runtime_error if a landmark or scan is missing (with its definition), a value is unknown or out of
/// its range, or a formula or the resulting plan is refused, for example because left and right landmarks are
/// exchanged.
nlohmann::ordered_json plan_of(const Procedure& procedure, const ProcedureInput& input);

/// The names by which formulas read landmarks, "ans.x", with coordinates along the head's directions.
/// `landmarks` are in LPS.
std::map<std::string, double> coordinates_of(const std::vector<brep::Landmark>& landmarks,
                                             const glm::dmat3& lps_from_head);

/// The procedure's own steps with evaluated formulas. `landmarks` are in LPS; `lps_from_head` is the head's
/// orientation. Throws as plan_of() for landmarks, values and formulas.
nlohmann::ordered_json steps_of(const Procedure& procedure, const std::vector<brep::Landmark>& landmarks,
                                const std::map<std::string, double>& values, const glm::dmat3& lps_from_head);

}  // namespace octotomy::planner
