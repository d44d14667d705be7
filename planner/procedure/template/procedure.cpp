// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/template/procedure.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>

#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/plan/plan.h"
#include "planner/procedure/template/formula.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {

/// Names and texts of the procedure files in this folder. The list is generated when the build is configured.
const std::vector<std::pair<std::string, std::string>>& procedure_files();

namespace {

using Values = std::map<std::string, double>;

double rounded(double value) {
  return std::round(value * roundings_per_unit) / roundings_per_unit + 0.0;
}

/// A JSON value in which formulas are replaced by their values: "=..." by a number, "=?..." by whether the
/// number differs from 0. {"head_mm": [x, y, z]} becomes the point in LPS with these coordinates along the
/// head's directions.
Json answered(const Json& value, const Values& names, const glm::dmat3& lps_from_head) {
  if (value.is_string() && value.get_ref<const std::string&>().starts_with('=')) {
    const std::string_view formula = std::string_view(value.get_ref<const std::string&>()).substr(1);
    if (formula.starts_with('?')) return value_of(formula.substr(1), names) != 0.0;
    return rounded(value_of(formula, names));
  }
  if (!value.is_structured()) return value;
  Json made = value;
  for (Json& part : made) part = answered(part, names, lps_from_head);
  if (!made.is_object() || made.size() != 1 || !made.contains("head_mm")) return made;
  const Json& place = made["head_mm"];
  if (!place.is_array() || place.size() != 3 ||
      !std::all_of(place.begin(), place.end(), [](const Json& each) { return each.is_number(); }))
    throw std::runtime_error("'head_mm' must be three numbers");
  const glm::dvec3 p_mm =
      lps_from_head * glm::dvec3(place[0].get<double>(), place[1].get<double>(), place[2].get<double>());
  return Json{rounded(p_mm.x), rounded(p_mm.y), rounded(p_mm.z)};
}

const brep::Landmark* find(const std::vector<brep::Landmark>& landmarks, const std::string& name) {
  for (const brep::Landmark& landmark : landmarks)
    if (landmark.name == name) return &landmark;
  return nullptr;
}

void need_landmarks(const Procedure& procedure, const std::vector<brep::Landmark>& given) {
  std::set<std::string> names;
  for (const brep::Landmark& landmark : given) names.insert(landmark.name);
  std::string missing;
  for (const ProcedureLandmark& landmark : procedure.landmarks)
    if (!names.contains(landmark.name))
      missing += (missing.empty() ? "" : "; ") + ("'" + landmark.name + "', " + landmark.says);
  if (!missing.empty())
    throw std::runtime_error("procedure " + procedure.name + " lacks landmarks: " + missing + ": place them");
}

Values values_of(const Procedure& procedure, const std::map<std::string, double>& given) {
  Values values;
  std::vector<std::string> known;
  for (const ProcedureValue& value : procedure.values) {
    known.push_back(value.name);
    const auto typed = given.find(value.name);
    const double number = typed == given.end() ? value.preset : typed->second;
    if (!(number >= value.least && number <= value.most))
      throw std::runtime_error("value " + value.name + " must be from " + SortedJson(value.least).dump() +
                               " to " + SortedJson(value.most).dump());
    values[value.name] = number;
  }
  for (const auto& [name, unused] : given)
    if (!values.contains(name))
      throw std::runtime_error("procedure " + procedure.name + " has no value '" + name + "'" +
                               suggestion(name, known));
  return values;
}

/// The first steps of a plan: its landmarks, and the head's orientation.
Json first_steps(const std::vector<brep::Landmark>& landmarks) {
  Json points = Json::array();
  for (const brep::Landmark& landmark : landmarks)
    points.push_back(
        {{"name", landmark.name}, {"point_mm", {landmark.p_mm.x, landmark.p_mm.y, landmark.p_mm.z}}});
  Json steps = Json::array({{{"id", "landmarks"}, {"do", "landmarks"}, {"points", points}}});
  Json frankfort = {"porion_right", "porion_left"}, midline = {"nasion", "basion"};
  for (const char* name : {"orbitale_right", "orbitale_left"})
    if (find(landmarks, name) != nullptr) frankfort.push_back(name);
  const auto all_there = [&](const Json& names) {
    return std::all_of(names.begin(), names.end(),
                       [&](const Json& name) { return find(landmarks, name.get<std::string>()) != nullptr; });
  };
  if (frankfort.size() < 3 || !all_there(frankfort)) return steps;
  Json held{{"id", "held"}, {"do", "head_position"}, {"frankfort", frankfort}};
  if (all_there(midline)) held["midline"] = midline;
  steps.push_back(held);
  return steps;
}

/// Another procedure of the program, of which `borrower` uses landmarks or steps.
Procedure borrowed(const std::string& name, const Procedure& borrower) {
  if (name == borrower.name || name.ends_with(".json"))
    throw std::runtime_error("'of' must name another procedure of the program, not '" + name + "'");
  return read_procedure(name);
}

void add_landmarks_of(const std::string& name, Procedure& procedure) {
  for (const ProcedureLandmark& landmark : borrowed(name, procedure).landmarks)
    if (std::none_of(procedure.landmarks.begin(), procedure.landmarks.end(),
                     [&](const ProcedureLandmark& known) { return known.name == landmark.name; }))
      procedure.landmarks.push_back(landmark);
}

/// Adds steps of another procedure, with their formulas. `entry` is {"of": that procedure, "steps": [ids]}.
void add_steps_of(const Json& entry, const std::string& where, Procedure& procedure) {
  const SortedJson plain = entry;
  check_keys(plain, where, {"of", "steps"});
  const Procedure other = borrowed(word_of(plain["of"], where), procedure);
  for (const SortedJson& id : need(plain, "steps", where)) {
    const std::string wanted = word_of(id, where);
    const auto step = std::find_if(other.steps.begin(), other.steps.end(),
                                   [&](const Json& each) { return each.value("id", "") == wanted; });
    if (step == other.steps.end())
      throw std::runtime_error(where + ": " + other.name + " has no step '" + wanted + "'");
    procedure.steps.push_back(*step);
  }
}

double number_at(const SortedJson& entry, const char* key, const std::string& where) {
  return number_of(need(entry, key, where), where + ", " + key);
}

std::vector<ProcedureValue> values_in(const SortedJson& list, const std::string& where) {
  std::vector<ProcedureValue> values;
  for (const SortedJson& entry : list) {
    const std::string at = where + "[" + std::to_string(values.size()) + "]";
    check_keys(entry, at, {"name", "says", "preset", "least", "most"});
    values.push_back({word_of(need(entry, "name", at), at), word_of(need(entry, "says", at), at),
                      number_at(entry, "preset", at), number_at(entry, "least", at),
                      number_at(entry, "most", at)});
  }
  if (values.size() > most_values)
    throw std::runtime_error(where + ": has more than " + std::to_string(most_values) +
                             " values, too many to enter without mistakes: compute some by formulas");
  return values;
}

void need_steps(const Json& owner, const std::string& where) {
  if (!owner.contains("steps") || !owner["steps"].is_array() || owner["steps"].empty())
    throw std::runtime_error(where + ": must be a list of at least one step");
}

/// Reads the options of a procedure. Refuses names of values and steps that are already used.
void add_options(const Json& list, Procedure& procedure) {
  for (const Json& entry : list) {
    const std::string where = "options[" + std::to_string(procedure.options.size()) + "]";
    const SortedJson plain = entry;
    check_keys(plain, where, {"name", "says", "values", "steps"});
    ProcedureOption option{word_of(need(plain, "name", where), where),
                           word_of(need(plain, "says", where), where),
                           values_in(need(plain, "values", where), where + ", values"), Json::array()};
    need_steps(entry, where + ", steps");
    option.steps = entry["steps"];
    const Procedure before = with_all_options(procedure);
    for (const ProcedureValue& value : option.values)
      for (const ProcedureValue& known : before.values)
        if (known.name == value.name)
          throw std::runtime_error(where + ": value '" + value.name + "' is defined twice: rename one");
    for (const Json& step : option.steps)
      for (const Json& known : before.steps)
        if (known.value("id", "") == step.value("id", ""))
          throw std::runtime_error(where + ": step '" + step.value("id", "") +
                                   "' is defined twice: rename one");
    procedure.options.push_back(std::move(option));
  }
}

}  // namespace

void need_scans(const Procedure& procedure, const std::map<std::string, Json>& given, const Json& known) {
  for (const ProcedureScan& scan : procedure.scans)
    if (!given.contains(scan.name) && !known.contains(scan.name))
      throw std::runtime_error("procedure " + procedure.name + " lacks a scan: '" + scan.name + "', " +
                               scan.says + ": add it by --" + scan.name);
  for (const auto& [name, unused] : given)
    if (std::none_of(procedure.scans.begin(), procedure.scans.end(),
                     [&, &name = name](const ProcedureScan& scan) { return scan.name == name; }))
      throw std::runtime_error("procedure " + procedure.name + " takes no scan '" + name + "': leave it out");
}

Procedure parse_procedure(const std::string& text) {
  const Json root = parse_json<Json>(text);
  const SortedJson plain = root;
  check_keys(plain, "procedure",
             {"procedure", "says", "acts_on", "outcome", "landmarks", "scans", "values", "steps", "options"});
  Procedure procedure;
  procedure.name = word_of(need(plain, "procedure", "procedure"), "procedure");
  procedure.says = word_of(need(plain, "says", "procedure"), "says");
  std::size_t number = 0;
  for (const SortedJson& entry : need(plain, "landmarks", "procedure")) {
    const std::string where = "landmarks[" + std::to_string(number++) + "]";
    if (entry.contains("of")) {
      check_keys(entry, where, {"of"});
      add_landmarks_of(word_of(entry["of"], where), procedure);
      continue;
    }
    check_keys(entry, where, {"name", "says", "scan"});
    procedure.landmarks.push_back({word_of(need(entry, "name", where), where),
                                   word_of(need(entry, "says", where), where),
                                   entry.contains("scan") ? word_of(entry["scan"], where) : ""});
  }
  if (plain.contains("scans"))
    for (const SortedJson& entry : plain.at("scans")) {
      const std::string where = "scans[" + std::to_string(procedure.scans.size()) + "]";
      check_keys(entry, where, {"name", "says"});
      procedure.scans.push_back(
          {word_of(need(entry, "name", where), where), word_of(need(entry, "says", where), where)});
    }
  procedure.values = values_in(need(plain, "values", "procedure"), "values");
  need_steps(root, "steps");
  for (std::size_t i = 0; i < root["steps"].size(); ++i) {
    const Json& step = root["steps"][i];
    if (step.contains("of"))
      add_steps_of(step, "steps[" + std::to_string(i) + "]", procedure);
    else
      procedure.steps.push_back(step);
  }
  if (root.contains("options")) add_options(root["options"], procedure);
  for (const auto& [key, into] :
       {std::pair("acts_on", &procedure.acts_on), std::pair("outcome", &procedure.outcome)}) {
    if (!plain.contains(key)) continue;
    *into = word_of(plain[key], key);
    if (std::none_of(procedure.steps.begin(), procedure.steps.end(),
                     [&, &into = into](const Json& step) { return step.value("id", "") == *into; }))
      throw std::runtime_error(std::string(key) + ": no step is called '" + *into + "'");
  }
  return procedure;
}

Procedure with_options(const Procedure& procedure, const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const ProcedureOption& option : procedure.options) known.push_back(option.name);
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw std::runtime_error("procedure " + procedure.name + " has no option '" + name + "'" +
                               (known.empty() ? ": it has none" : suggestion(name, known)));
  Procedure whole = procedure;
  for (const ProcedureOption& option : procedure.options) {
    if (std::find(names.begin(), names.end(), option.name) == names.end()) continue;
    whole.values.insert(whole.values.end(), option.values.begin(), option.values.end());
    for (const Json& step : option.steps) whole.steps.push_back(step);
  }
  return whole;
}

Procedure with_all_options(const Procedure& procedure) {
  std::vector<std::string> names;
  for (const ProcedureOption& option : procedure.options) names.push_back(option.name);
  return with_options(procedure, names);
}

Procedure read_procedure(const std::string& name_or_path) {
  if (name_or_path.ends_with(".json")) {
    std::ifstream file = voxel::opened(name_or_path);
    if (!file) throw std::runtime_error(name_or_path + ": cannot be read");
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    try {
      return parse_procedure(text);
    } catch (const std::exception& error) {
      rethrow_at(name_or_path + ": ", error);
    }
  }
  for (const auto& [name, text] : procedure_files())
    if (name == name_or_path) return parse_procedure(text);
  throw std::runtime_error("there is no procedure '" + name_or_path + "'" +
                           suggestion(name_or_path, procedures()));
}

std::vector<std::string> procedures() {
  std::vector<std::string> names;
  for (const auto& [name, unused] : procedure_files()) names.push_back(name);
  return names;
}

std::map<std::string, double> coordinates_of(const std::vector<brep::Landmark>& landmarks,
                                             const glm::dmat3& lps_from_head) {
  std::map<std::string, double> coordinates;
  for (const brep::Landmark& landmark : landmarks) {
    const glm::dvec3 p = glm::transpose(lps_from_head) * landmark.p_mm;
    for (int axis = 0; axis < 3; ++axis) coordinates[landmark.name + "." + "xyz"[axis]] = p[axis];
  }
  return coordinates;
}

Json steps_of(const Procedure& procedure, const std::vector<brep::Landmark>& landmarks,
              const std::map<std::string, double>& values, const glm::dmat3& lps_from_head) {
  need_landmarks(procedure, landmarks);
  Values names = values_of(procedure, values);
  names.merge(coordinates_of(landmarks, lps_from_head));
  Json steps = Json::array();
  for (const Json& step : procedure.steps) try {
      steps.push_back(answered(step, names, lps_from_head));
    } catch (const std::exception& error) {
      rethrow_at("procedure " + procedure.name + ", step '" + step.value("id", "") + "': ", error);
    }
  return steps;
}

Json plan_of(const Procedure& procedure, const ProcedureInput& input) {
  need_landmarks(procedure, input.landmarks);
  values_of(procedure, input.values);
  need_scans(procedure, input.further_scans, Json::object());
  Json scans{{"ct", input.scan}};
  for (const ProcedureScan& scan : procedure.scans) scans[scan.name] = input.further_scans.at(scan.name);
  Json plan{{"octotomy_plan", 1},
            {"name", procedure.says.substr(0, procedure.says.find('.'))},
            {"scans", scans},
            {"universe", {{"voxel_mm", input.voxel_mm}}},
            {"steps", first_steps(input.landmarks)}};
  // Parsing the first steps refuses invalid landmarks and computes the head's directions.
  const Plan placed = parse_plan(plan.dump(), input.folder);
  std::vector<brep::Landmark> landmarks;
  for (const NamedPoint& landmark : placed.landmarks) landmarks.push_back({landmark.name, landmark.p_mm});
  const glm::dmat3 lps_from_head = placed.lps_from_head.value_or(glm::dmat3(1.0));
  for (Json& step : steps_of(procedure, landmarks, input.values, lps_from_head))
    plan["steps"].push_back(std::move(step));
  parse_plan(plan.dump(), input.folder);
  return plan;
}

}  // namespace octotomy::planner
