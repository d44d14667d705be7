// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/difference.h"

#include <map>

#include "planner/operation/table/field_json.h"
#include "planner/operation/table/json.h"

namespace octotomy::planner {
namespace {

std::string at(const std::string& place, const std::string& key) {
  return place.empty() ? key : place + ", " + key;
}

void compare(const Json& from, const Json& to, const std::string& place, std::vector<FieldChange>& changes) {
  if (from == to) return;
  if (from.is_object() && to.is_object()) {
    for (const auto& [key, value] : from.items())
      compare(value, to.contains(key) ? to[key] : Json(), at(place, key), changes);
    for (const auto& [key, value] : to.items())
      if (!from.contains(key)) compare(Json(), value, at(place, key), changes);
    return;
  }
  const bool records = from.is_array() && to.is_array() && from.size() == to.size() && !from.empty() &&
                       from.front().is_object();
  if (!records) return changes.push_back({place, from, to});
  for (std::size_t i = 0; i < from.size(); ++i)
    compare(from[i], to[i], place + "[" + std::to_string(i) + "]", changes);
}

/// The plan's JSON without its steps.
Json document_of(const Plan& plan) {
  Json document = Json::parse(plan.text);
  document.erase("steps");
  for (auto& [name, scan] : document["scans"].items()) {
    Json said = Json::object();
    for (const auto& [key, value] : scan.items())
      if (!value.is_null()) said[key] = value;
    scan = said;
  }
  return document;
}

Json fields_of(const Step& step) {
  Json fields{{"do", verb(step)}};
  fields.update(print_fields(step.action.operation().fields, const_cast<void*>(step.action.value())));
  return fields;
}

using StepsById = std::map<std::string, const Step*>;

StepsById steps_by_id(const Plan& plan) {
  StepsById steps;
  for (const Step& step : plan.steps) steps.emplace(step.id, &step);
  return steps;
}

/// For each step that the other plan also has, the last such step before it; empty for the first.
std::map<std::string, std::string> steps_before(const Plan& plan, const StepsById& other) {
  std::map<std::string, std::string> before;
  std::string last;
  for (const Step& step : plan.steps) {
    if (!other.contains(step.id)) continue;
    before.emplace(step.id, last);
    last = step.id;
  }
  return before;
}

}  // namespace

PlanDifference difference(const Plan& from, const Plan& to) {
  PlanDifference found;
  compare(document_of(from), document_of(to), "", found.document);
  const StepsById steps_from = steps_by_id(from), steps_to = steps_by_id(to);
  for (const Step& step : from.steps) {
    const auto same = steps_to.find(step.id);
    if (same == steps_to.end()) {
      found.removed.push_back(step.id);
      continue;
    }
    StepChange change{step.id, {}};
    compare(fields_of(step), fields_of(*same->second), "", change.fields);
    if (!change.fields.empty()) found.changed.push_back(std::move(change));
  }
  for (const Step& step : to.steps)
    if (!steps_from.contains(step.id)) found.added.push_back(step.id);
  const auto before_in_from = steps_before(from, steps_to), before_in_to = steps_before(to, steps_from);
  for (const Step& step : to.steps)
    if (const auto before = before_in_from.find(step.id);
        before != before_in_from.end() && before->second != before_in_to.at(step.id))
      found.reordered.push_back(step.id);
  return found;
}

Json to_json(const PlanDifference& difference) {
  const auto fields = [](const std::vector<FieldChange>& changes) {
    Json list = Json::array();
    for (const FieldChange& change : changes)
      list.push_back({{"field", change.field}, {"from", change.from}, {"to", change.to}});
    return list;
  };
  Json changed = Json::array();
  for (const StepChange& change : difference.changed)
    changed.push_back({{"id", change.id}, {"fields", fields(change.fields)}});
  return {{"same", difference.is_empty()},
          {"document", fields(difference.document)},
          {"added", difference.added},
          {"removed", difference.removed},
          {"changed", changed},
          {"reordered", difference.reordered}};
}

std::string text_of(const PlanDifference& difference) {
  std::string text;
  const auto changes = [&](const std::string& of, const std::vector<FieldChange>& fields) {
    for (const FieldChange& change : fields)
      text += "~ " + of + change.field + ": " + change.from.dump() + " -> " + change.to.dump() + "\n";
  };
  changes("", difference.document);
  for (const std::string& id : difference.removed) text += "- step '" + id + "'\n";
  for (const StepChange& change : difference.changed) changes("step '" + change.id + "', ", change.fields);
  for (const std::string& id : difference.added) text += "+ step '" + id + "'\n";
  for (const std::string& id : difference.reordered) text += "~ step '" + id + "' has another place\n";
  return text.empty() ? "the plans are the same\n" : text;
}

}  // namespace octotomy::planner
