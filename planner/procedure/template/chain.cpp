// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/template/chain.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <set>
#include <stdexcept>

#include "planner/operation/table/json.h"
#include "planner/operation/table/operation.h"
#include "planner/plan/dependence.h"

namespace octotomy::planner {
namespace {

constexpr double near_mm = 8.0;

/// The procedures of the program, which are read once.
const std::vector<Procedure>& known_procedures() {
  static const std::vector<Procedure> known = [] {
    std::vector<Procedure> read;
    for (const std::string& name : procedures()) read.push_back(read_procedure(name));
    return read;
  }();
  return known;
}

bool has_all_steps(const Plan& plan, const Procedure& procedure) {
  return std::all_of(procedure.steps.begin(), procedure.steps.end(), [&](const Json& own) {
    return std::any_of(plan.steps.begin(), plan.steps.end(),
                       [&](const Step& step) { return step.id == own.at("id"); });
  });
}

/// Whether a step is the result of a procedure: by its name, or because the procedure's file names it.
bool is_outcome(const Plan& plan, const std::string& id) {
  if (id == "planned" || id == "rebuilt" || id.ends_with("_planned") || id.ends_with("_rebuilt")) return true;
  return std::any_of(known_procedures().begin(), known_procedures().end(), [&](const Procedure& procedure) {
    if (procedure.outcome.empty()) return false;
    return id == procedure.outcome
               ? has_all_steps(plan, procedure)
               : id.ends_with("_" + procedure.outcome) && is_chained_step_of(procedure, id);
  });
}

const Step& step_of(const Plan& plan, const std::string& id) {
  return *std::find_if(plan.steps.begin(), plan.steps.end(), [&](const Step& step) { return step.id == id; });
}

/// Squared distances in mm² from a point to the nearest voxel of a piece (`piece`), and to the nearest other
/// voxel of the objects from which the piece was cut (`other`).
struct Nearest {
  double piece = std::numeric_limits<double>::infinity();
  double other = std::numeric_limits<double>::infinity();
};
Nearest nearest(const glm::dvec3& p_mm, const voxel::Octree& piece,
                const std::vector<const voxel::Octree*>& whole) {
  const voxel::Lattice lattice = piece.universe().lattice();
  const glm::dvec3 p(glm::inverse(lattice.lps_from_voxel) * glm::dvec4(p_mm, 1.0));
  const glm::dvec3 reach = near_mm / lattice.spacing_mm();
  const glm::ivec3 low = glm::max(glm::ivec3(glm::floor(p - reach)), glm::ivec3(0));
  const glm::ivec3 high = glm::min(glm::ivec3(glm::ceil(p + reach)), lattice.dims - 1);
  Nearest found;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const glm::ivec3 at(x, y, z);
        const glm::dvec3 away = lattice.lps_mm(glm::dvec3(at)) - p_mm;
        const double square = glm::dot(away, away);
        if (square > near_mm * near_mm) continue;
        if (piece.contains(at))
          found.piece = std::min(found.piece, square);
        else if (std::any_of(whole.begin(), whole.end(),
                             [&](const auto* each) { return each->contains(at); }))
          found.other = std::min(found.other, square);
      }
  return found;
}

/// The position of a scanned point after the motions that the outcome contains. If the point has moved with a
/// piece, further motions apply only if they move that piece or a part of it. Mirror images move no point.
glm::dvec3 carried_mm(glm::dvec3 p_mm, const Plan& plan, const Evaluation& evaluated,
                      const std::set<std::string>& in_outcome) {
  std::optional<std::string> owner;
  for (const Object& moved : evaluated.objects) {
    if (!moved.moved || moved.is_tool || !in_outcome.contains(moved.id) ||
        glm::determinant(glm::dmat3(moved.moved->motion)) < 0.0)
      continue;
    const Object& still = evaluated.objects.at(moved.moved->object);
    if (owner && !needed_for(plan, {still.id}).contains(*owner)) continue;
    std::vector<const voxel::Octree*> whole;
    for (const std::string& operand : objects_used(step_of(plan, still.id).action))
      if (!evaluated.objects.at(operand).is_tool)
        whole.push_back(&evaluated.objects.at(operand).voxel.octree);
    const Nearest found = nearest(p_mm, still.voxel.octree, whole);
    if (found.piece == std::numeric_limits<double>::infinity() || found.piece > found.other) continue;
    p_mm = glm::dvec3(moved.moved->motion * glm::dvec4(p_mm, 1.0));
    owner = moved.id;
  }
  return p_mm;
}

std::vector<brep::Landmark> carried(const std::vector<NamedPoint>& landmarks, const Plan& plan,
                                    const Evaluation& evaluated) {
  std::set<std::string> in_outcome;
  if (const std::optional<std::string> outcome = outcome_of(plan)) in_outcome = needed_for(plan, {*outcome});
  std::vector<brep::Landmark> now;
  for (const NamedPoint& landmark : landmarks)
    now.push_back({landmark.name, carried_mm(landmark.p_mm, plan, evaluated, in_outcome)});
  return now;
}

/// Adds landmarks to the first step `landmarks` of the plan that states its points. Adds such a step if there
/// is none.
void add_landmarks(const std::vector<brep::Landmark>& landmarks, const Plan& plan, Json& whole) {
  Json added = Json::array();
  for (const brep::Landmark& landmark : landmarks) {
    const auto known = std::find_if(plan.landmarks.begin(), plan.landmarks.end(),
                                    [&](const NamedPoint& each) { return each.name == landmark.name; });
    constexpr double same_mm = 1e-3;
    if (known == plan.landmarks.end())
      added.push_back(
          {{"name", landmark.name}, {"point_mm", {landmark.p_mm.x, landmark.p_mm.y, landmark.p_mm.z}}});
    else if (glm::distance(known->p_mm, landmark.p_mm) > same_mm)
      throw std::runtime_error("the landmark '" + landmark.name + "' lies " +
                               std::to_string(glm::distance(known->p_mm, landmark.p_mm)) +
                               " mm from the plan's landmark of this name: leave this landmark out, or "
                               "change the plan's landmark");
  }
  if (added.empty()) return;
  for (Json& step : whole["steps"])
    if (step["do"] == "landmarks" && step.contains("points")) {
      for (Json& point : added) step["points"].push_back(std::move(point));
      return;
    }
  std::string id = "landmarks";
  while (std::any_of(plan.steps.begin(), plan.steps.end(), [&](const Step& step) { return step.id == id; }))
    id += "_2";
  whole["steps"].insert(whole["steps"].begin(), Json{{"id", id}, {"do", "landmarks"}, {"points", added}});
}

/// Adds the scans that the procedure needs besides the patient's. Refuses a name that the plan already uses.
void add_scans(const Procedure& procedure, const ProcedureInput& input, Json& whole) {
  need_scans(procedure, input.further_scans, whole["scans"]);
  for (const auto& [name, entry] : input.further_scans) {
    if (whole["scans"].contains(name))
      throw std::runtime_error("the plan has a scan '" + name + "' already: leave it out");
    whole["scans"][name] = entry;
  }
}

bool is_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Renames the steps of a procedure, so that their names are unique in a plan.
class Renaming {
 public:
  /// `names` has the new name of each step, `places` the position of each landmark, and `scan` is the plan's
  /// name of the patient's scan, which procedures call "ct".
  Renaming(std::map<std::string, std::string> names, std::map<std::string, glm::dvec3> places,
           std::string scan)
      : names_(std::move(names)), places_(std::move(places)), scan_(std::move(scan)) {}

  Json operator()(const Json& step) const {
    Json made = step;
    made["id"] = names_.at(step.at("id"));
    const Json& fields = fields_of(step.at("do"));
    for (const auto& [key, value] : step.items()) {
      if (key == "id" || key == "do") continue;
      // The field's schema shows whether its words name objects or points.
      const std::string schema = fields.value(key, Json::object()).dump();
      const bool names_objects = schema.find("x-names") != std::string::npos;
      const bool names_points = schema.find("oneOf") != std::string::npos;
      if (key == "expression")
        made[key] = words_renamed(value.get<std::string>());
      else if (key == "scan" && value == "ct")
        made[key] = scan_;
      else if (names_objects || names_points || key == "scan")
        made[key] = renamed(value, names_objects || key == "scan", names_points);
    }
    return made;
  }

 private:
  static const Json& fields_of(const std::string& operation) {
    static const Json all = plan_schema();
    static const Json none = Json::object();
    for (const Json& step : all["properties"]["steps"]["items"]["anyOf"])
      if (step.value("title", "") == operation) return step["properties"];
    return none;
  }

  /// Replaces the names of steps by their new names, and the names of landmarks by positions, because a
  /// landmark may have moved.
  Json renamed(const Json& value, bool names_objects, bool names_points) const {
    if (value.is_string()) {
      const auto& text = value.get_ref<const std::string&>();
      if (const auto name = names_.find(text); names_objects && name != names_.end()) return name->second;
      if (const auto place = places_.find(text); names_points && place != places_.end())
        return {place->second.x, place->second.y, place->second.z};
      return value;
    }
    if (!value.is_structured()) return value;
    Json made = value;
    for (Json& part : made) part = renamed(part, names_objects, names_points);
    return made;
  }

  std::string words_renamed(const std::string& text) const {
    std::string made;
    for (std::size_t i = 0; i < text.size();) {
      std::size_t end = i;
      while (end < text.size() && is_letter(text[end])) ++end;
      if (end == i) {
        made += text[i++];
        continue;
      }
      const std::string word = text.substr(i, end - i);
      const auto name = names_.find(word);
      made += name == names_.end() ? word : name->second;
      i = end;
    }
    return made;
  }

  std::map<std::string, std::string> names_;
  std::map<std::string, glm::dvec3> places_;
  std::string scan_;
};

/// Whether a formula in a step uses a value.
bool uses_value(const Json& value, const std::string& name) {
  if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    if (!text.starts_with('=')) return false;
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1))
      if (!is_letter(text[at - 1]) && (at + name.size() == text.size() || !is_letter(text[at + name.size()])))
        return true;
    return false;
  }
  return value.is_structured() &&
         std::any_of(value.begin(), value.end(), [&](const Json& part) { return uses_value(part, name); });
}

/// Whether a step is the procedure's bone: the step that the procedure's file names or, if it names none, any
/// window of the patient's scan.
bool is_bone(const Procedure& procedure, const Json& step) {
  if (!procedure.acts_on.empty()) return step.value("id", "") == procedure.acts_on;
  return step.value("do", "") == "window" && step.value("scan", "") == "ct";
}

void need_used_values(const Procedure& procedure, const std::map<std::string, double>& values,
                      const std::string& on) {
  for (const auto& [name, unused] : values)
    if (std::none_of(procedure.steps.begin(), procedure.steps.end(),
                     [&, &name = name](const Json& step) {
                       return !is_bone(procedure, step) && uses_value(step, name);
                     }) &&
        std::any_of(procedure.values.begin(), procedure.values.end(),
                    [&, &name = name](const ProcedureValue& value) { return value.name == name; }))
      throw std::runtime_error("value " + name + " changes nothing: the procedure acts on '" + on +
                               "', an object that the plan has already: leave the value out");
}

}  // namespace

std::optional<std::string> outcome_of(const Plan& plan) {
  for (auto step = plan.steps.rbegin(); step != plan.steps.rend(); ++step)
    if (is_outcome(plan, step->id) && step->action.operation().makes == Makes::Object) return step->id;
  return std::nullopt;
}

std::optional<std::string> name_before_chaining(const Procedure& procedure, const std::string& id) {
  const std::string prefix = procedure.name + "_";
  if (!id.starts_with(prefix)) return std::nullopt;
  std::string own = id.substr(prefix.size());
  if (const std::size_t digits = own.find_first_not_of("0123456789");
      digits != 0 && digits != std::string::npos && own[digits] == '_')
    own = own.substr(digits + 1);
  const Procedure whole = with_all_options(procedure);
  const bool is_known = std::any_of(whole.steps.begin(), whole.steps.end(),
                                    [&](const Json& step) { return step.at("id") == own; });
  return is_known ? std::optional(own) : std::nullopt;
}

bool is_chained_step_of(const Procedure& procedure, const std::string& id) {
  return name_before_chaining(procedure, id).has_value();
}

std::vector<brep::Landmark> carried_landmarks(const Plan& plan, const Evaluation& evaluated) {
  return carried(plan.landmarks, plan, evaluated);
}

Chained chained(const Plan& plan, const Evaluation& evaluated, const Procedure& procedure,
                const ProcedureInput& input) {
  const std::optional<std::string> outcome = outcome_of(plan);
  if (!outcome)
    throw std::runtime_error(
        "the plan has no step 'planned' or 'rebuilt' for a further procedure to act on: name its last object "
        "'planned'");
  need_used_values(procedure, input.values, *outcome);
  Chained result;
  result.plan = Json::parse(plan.text);
  add_landmarks(input.landmarks, plan, result.plan);
  add_scans(procedure, input, result.plan);
  const Plan placed = parse_plan(result.plan.dump(), plan.folder);

  const std::vector<brep::Landmark> now = carried(placed.landmarks, plan, evaluated);
  std::map<std::string, glm::dvec3> places;
  for (std::size_t i = 0; i < now.size(); ++i) {
    places[now[i].name] = now[i].p_mm;
    const bool is_asked =
        std::any_of(procedure.landmarks.begin(), procedure.landmarks.end(),
                    [&](const ProcedureLandmark& each) { return each.name == now[i].name; });
    if (is_asked && now[i].p_mm != placed.landmarks[i].p_mm) result.carried.push_back(now[i].name);
  }

  std::set<std::string> taken;
  for (const Step& step : placed.steps) taken.insert(step.id);
  // Whole names are compared, because steps of le_fort_i_two_piece also begin with "le_fort_i_".
  const auto is_free = [&](const std::string& prefix) {
    return std::none_of(procedure.steps.begin(), procedure.steps.end(), [&](const Json& step) {
      return taken.contains(prefix + step.at("id").get<std::string>());
    });
  };
  std::string prefix = procedure.name + "_";
  for (int number = 2; !is_free(prefix); ++number)
    prefix = procedure.name + "_" + std::to_string(number) + "_";

  const glm::dmat3 lps_from_head = placed.lps_from_head.value_or(glm::dmat3(1.0));
  const Json steps = steps_of(procedure, now, input.values, lps_from_head);
  std::map<std::string, std::string> names;
  for (const Json& step : steps) {
    const auto id = step.at("id").get<std::string>();
    names[id] = is_bone(procedure, step) ? *outcome : prefix + id;
  }
  const Renaming renaming(names, places, result.plan["scans"].begin().key());
  for (const Json& step : steps) {
    if (is_bone(procedure, step)) continue;
    result.plan["steps"].push_back(renaming(step));
    result.made.push_back(result.plan["steps"].back().at("id"));
  }
  parse_plan(result.plan.dump(), plan.folder);
  return result;
}

}  // namespace octotomy::planner
