// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/dependence.h"

#include <stdexcept>

#include "planner/operation/table/field_json.h"
#include "planner/operation/table/json.h"
#include "planner/plan/sha256.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

/// Ids of the steps that make the objects and scans that a step uses.
std::vector<std::string> inputs_of(const Step& step) {
  std::vector<std::string> inputs = objects_used(step.action);
  const std::vector<std::string> scans = scans_used(step.action);
  inputs.insert(inputs.end(), scans.begin(), scans.end());
  return inputs;
}

Json numbers(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

/// Adds the files that fields name, including fields of nested records.
void add_files(const std::vector<Field>& fields, void* owner, std::vector<std::filesystem::path>& files) {
  for (const Field& field : fields) {
    const Slot slot = field.slot(owner);
    if (const auto* path = std::get_if<std::filesystem::path*>(&slot); path != nullptr && !(*path)->empty())
      files.push_back(**path);
    if (const auto* list = std::get_if<std::vector<std::string>*>(&slot); list != nullptr && field.is_input)
      files.insert(files.end(), (*list)->begin(), (*list)->end());
    if (const auto* records = std::get_if<Records>(&slot))
      for (std::size_t i = 0; i < records->count; ++i) add_files(field.fields, records->at(i), files);
  }
}

}  // namespace

std::vector<std::filesystem::path> files_read(const Step& step) {
  std::vector<std::filesystem::path> files;
  if (step.action.operation().makes == Makes::File) return files;
  add_files(step.action.operation().fields, const_cast<void*>(step.action.value()), files);
  return files;
}

std::set<std::string> needed_for(const Plan& plan, const std::vector<std::string>& ids) {
  std::set<std::string> needed(ids.begin(), ids.end()), known;
  for (const Step& step : plan.steps) known.insert(step.id);
  for (const std::string& id : ids)
    if (!known.contains(id)) throw voxel::InvalidInput("the plan has no step called '" + id + "'");
  // A step uses only earlier steps, so one pass backwards finds all dependences.
  for (auto step = plan.steps.rbegin(); step != plan.steps.rend(); ++step)
    if (needed.contains(step->id))
      for (const std::string& input : inputs_of(*step))
        if (!plan.scans.contains(input)) needed.insert(input);
  return needed;
}

std::set<std::string> needing_meshes(const Plan& plan, const std::set<std::string>& steps) {
  std::set<std::string> needing;
  for (auto step = plan.steps.rbegin(); step != plan.steps.rend(); ++step) {
    if (!steps.contains(step->id)) continue;
    const Operation& operation = step->action.operation();
    const bool by_mesh_alone = operation.makes == Makes::Object && !operation.voxel;
    if (by_mesh_alone) needing.insert(step->id);
    if (by_mesh_alone || operation.settle || needing.contains(step->id))
      for (const std::string& input : objects_used(step->action)) needing.insert(input);
  }
  return needing;
}

std::map<std::string, std::string> step_keys(
    const Plan& plan, const std::string& common,
    const std::function<std::string(const std::string& scan)>& scan_key) {
  std::map<std::string, std::string> keys;
  for (const Step& step : plan.steps) {
    const Operation& operation = step.action.operation();
    Json says{{"octotomy", OCTOTOMY_VERSION}, {"common", common}, {"id", step.id}, {"do", operation.name}};
    says["fields"] = print_fields(operation.fields, const_cast<void*>(step.action.value()));
    for (const std::string& input : inputs_of(step)) {
      const auto made = keys.find(input);
      says["inputs"].push_back({input, made != keys.end() ? made->second : scan_key(input)});
    }
    for (const Mark& mark : marks_used(step.action)) says["marks"].push_back(numbers(mark.p_mm));
    if (operation.is_of_head && plan.lps_from_head)
      for (int axis = 0; axis < 3; ++axis) says["head"].push_back(numbers((*plan.lps_from_head)[axis]));
    for (const std::filesystem::path& file : files_read(step)) {
      std::error_code none;
      if (std::filesystem::exists(plan.folder / file, none))
        says["files"].push_back(sha256_of_path(plan.folder / file));
    }
    keys.emplace(step.id, sha256_of(says.dump()));
  }
  return keys;
}

}  // namespace octotomy::planner
