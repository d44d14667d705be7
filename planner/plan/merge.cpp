// SPDX-License-Identifier: AGPL-3.0-or-later
// A three-way merge by names, not by lines: 1 merge values outside the steps; 2 merge steps by their ids,
// field by field; 3 use the order of the plan that changed it; 4 insert steps that the other plan adds after
// the step that they follow there.
#include "planner/plan/merge.h"

#include <iterator>
#include <list>
#include <map>
#include <set>
#include <stdexcept>

#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"

namespace octotomy::planner {
namespace {

using Ids = std::vector<std::string>;

/// The value of a key; null if the object does not have it.
Json value_at(const Json& object, const std::string& key) {
  return object.is_object() && object.contains(key) ? object[key] : Json();
}

class Merge {
 public:
  std::vector<MergeConflict> conflicts;

  /// Merges a value of the base that `a` and `b` may have changed. Null if the merged plan does not have it.
  /// In a conflict, adds it to `conflicts`.
  Json value(const Json& base, const Json& a, const Json& b, const std::string& step,
             const std::string& field) {
    if (a == b || b == base) return a;
    if (a == base) return b;
    if (!a.is_object() || !b.is_object() || !(base.is_object() || base.is_null())) {
      conflicts.push_back({step, field, base, a, b});
      return base;
    }
    Json merged = Json::object();
    const auto take = [&](const std::string& key) {
      if (merged.contains(key)) return;
      Json one = value(value_at(base, key), value_at(a, key), value_at(b, key), step,
                       field.empty() ? key : field + ", " + key);
      // A null that both plans state stays, such as that of "sha256". Other nulls are removed keys.
      if (!one.is_null() || (a.contains(key) && b.contains(key))) merged[key] = std::move(one);
    };
    for (const auto& [key, unused] : a.items()) take(key);
    for (const auto& [key, unused] : b.items()) take(key);
    return merged;
  }
};

std::map<std::string, Json> by_id(const Json& plan) {
  std::map<std::string, Json> steps;
  for (const Json& step : plan["steps"]) steps.emplace(step["id"].get<std::string>(), step);
  return steps;
}

Ids ids_of(const Json& plan) {
  Ids ids;
  for (const Json& step : plan["steps"]) ids.push_back(step["id"].get<std::string>());
  return ids;
}

Ids those_in(const Ids& ids, const Ids& others, const Ids& more) {
  const std::set<std::string> in_others(others.begin(), others.end()), in_more(more.begin(), more.end());
  Ids kept;
  for (const std::string& id : ids)
    if (in_others.contains(id) && in_more.contains(id)) kept.push_back(id);
  return kept;
}

/// Adds to `order` the ids of `from` that it lacks, each behind the id before it in `from`.
void add_missing(const Ids& from, Ids& order) {
  std::list<std::string> all(order.begin(), order.end());
  std::map<std::string, std::list<std::string>::iterator> place_of;
  for (auto place = all.begin(); place != all.end(); ++place) place_of.emplace(*place, place);
  auto behind = all.begin();
  for (const std::string& id : from) {
    const auto [known, is_new] = place_of.try_emplace(id);
    if (is_new) known->second = all.insert(behind, id);
    behind = std::next(known->second);
  }
  order.assign(all.begin(), all.end());
}

Ids merged_order(const Ids& base, const Ids& a, const Ids& b, Merge& merge) {
  const Ids in_base = those_in(base, a, b), in_a = those_in(a, base, b), in_b = those_in(b, base, a);
  const bool b_decides = in_a == in_base;
  if (!b_decides && in_b != in_base && in_a != in_b)
    merge.conflicts.push_back({"", "order of steps", in_base, in_a, in_b});
  Ids order = b_decides ? b : a;
  add_missing(b_decides ? a : b, order);
  return order;
}

}  // namespace

std::string MergeConflict::text() const {
  const auto said = [](const Json& value) { return value.is_null() ? std::string("nothing") : value.dump(); };
  const std::string where = (step.empty() ? "" : "step '" + step + "'" + (field.empty() ? "" : ", ")) + field;
  if (a.is_null() || b.is_null())
    return where + ": removed in " + (a.is_null() ? "A" : "B") + ", changed in " + (a.is_null() ? "B" : "A");
  return where + ": " + said(base) + " became " + said(a) + " in A and " + said(b) + " in B";
}

Merged merge(const Plan& base_plan, const Plan& a_plan, const Plan& b_plan) {
  const Json base = Json::parse(base_plan.text), a = Json::parse(a_plan.text), b = Json::parse(b_plan.text);
  Merge merge;
  const auto beside_steps = [](Json plan) {
    plan.erase("steps");
    return plan;
  };
  Json merged = merge.value(beside_steps(base), beside_steps(a), beside_steps(b), "", "");
  const auto base_steps = by_id(base), a_steps = by_id(a), b_steps = by_id(b);
  const auto step_in = [](const std::map<std::string, Json>& steps, const std::string& id) {
    const auto found = steps.find(id);
    return found == steps.end() ? Json() : found->second;
  };
  merged["steps"] = Json::array();
  for (const std::string& id : merged_order(ids_of(base), ids_of(a), ids_of(b), merge)) {
    Json step = merge.value(step_in(base_steps, id), step_in(a_steps, id), step_in(b_steps, id), id, "");
    if (!step.is_null()) merged["steps"].push_back(std::move(step));
  }
  if (!merge.conflicts.empty()) return {"", merge.conflicts};
  const std::string text = merged.dump(2) + "\n";
  try {
    parse_plan(text, a_plan.folder);
  } catch (const std::exception& error) {
    rethrow_at("the merged plan is invalid: ", error);
  }
  return {text, {}};
}

}  // namespace octotomy::planner
