// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/document.h"

#include <algorithm>
#include <sstream>

#include "planner/operation/table/control_character.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/operation.h"
#include "planner/plan/dependence.h"
#include "planner/plan/difference.h"

namespace octotomy::planner::serve {
namespace {

/// Largest number of edits in the list of a page.
constexpr std::int64_t most_listed = 200;

Json::iterator find_step(Json& steps, const std::string& id) {
  const auto found =
      std::find_if(steps.begin(), steps.end(), [&](const Json& step) { return step.value("id", "") == id; });
  if (found != steps.end()) return found;
  std::vector<std::string> ids;
  for (const Json& step : steps) ids.push_back(step.value("id", ""));
  throw std::runtime_error("the plan has no step '" + id + "'" + suggestion(id, ids));
}

/// The points of the plan's first landmarks step that states its points. Adds such a step if there is none.
Json& points_in(Json& steps) {
  auto found = std::find_if(steps.begin(), steps.end(), [](const Json& step) {
    return step.value("do", "") == "landmarks" && step.contains("points");
  });
  if (found == steps.end())
    found = steps.insert(steps.begin(),
                         Json{{"id", "landmarks"}, {"do", "landmarks"}, {"points", Json::array()}});
  return (*found)["points"];
}

void set_landmarks(Json& steps, const Json& landmarks) {
  Json& points = points_in(steps);
  points = Json::array();
  for (const Json& landmark : landmarks)
    points.push_back({{"name", landmark.at("name")}, {"point_mm", landmark.at("point")}});
}

void change_steps(Json& steps, const Json& said) {
  if (said.contains("add")) {
    const Json& add = said["add"];
    auto place = steps.end();
    if (add.contains("after") && add["after"].is_string()) place = find_step(steps, add["after"]) + 1;
    steps.insert(place, add.at("step"));
  }
  if (said.contains("replace")) *find_step(steps, said["replace"].at("id")) = said["replace"].at("step");
  if (said.contains("remove")) steps.erase(find_step(steps, said["remove"].get<std::string>()));
  if (said.contains("landmarks")) set_landmarks(steps, said["landmarks"]);
}

void need_files_of_record(const Json& record, const std::vector<Field>& fields,
                          const std::filesystem::path& folder, const Folders& folders) {
  for (const Field& field : fields) {
    const auto given = record.find(field.name);
    if (given == record.end()) continue;
    const auto each = [&](const auto& work) {
      work(*given);
      if (given->is_structured())
        for (const Json& part : *given) work(part);
    };
    if (field.is_input)
      each([&](const Json& file) {
        if (file.is_string()) folders.need_readable(folder / file.get<std::string>());
      });
    if (!field.fields.empty())
      each([&](const Json& part) {
        if (part.is_object()) need_files_of_record(part, field.fields, folder, folders);
      });
  }
}

/// Refuses a plan's text if its steps name files that the page may not read. Must run before the text is
/// parsed: steps such as landmarks, transforms, saws and masks read their files then, and an error could
/// already quote a forbidden file.
void need_files_within(const Json& plan, const std::filesystem::path& folder, const Folders& folders) {
  const auto steps = plan.find("steps");
  if (steps == plan.end() || !steps->is_array()) return;
  for (const Json& step : *steps) {
    if (!step.is_object()) continue;
    const Json word = step.value("do", Json());
    if (!word.is_string()) continue;
    for (const Operation& operation : operations())
      if (operation.name == word) need_files_of_record(step, operation.fields, folder, folders);
  }
}

/// Refuses a plan with scans or files that the page may not read. That a plan names a path is no permission
/// to read it.
void need_readable_files(const Plan& plan, const Folders& folders) {
  for (const auto& [name, scan] : plan.scans) folders.need_readable(scan_path(plan, scan));
  for (const Step& step : plan.steps)
    for (const std::filesystem::path& file : files_read(step)) folders.need_readable(plan.folder / file);
}

/// Refuses new names of landmarks that are too long or contain control characters. Names that the plan
/// already has are accepted.
void need_short_names(const std::vector<NamedPoint>& landmarks, const std::vector<NamedPoint>& known) {
  constexpr std::size_t longest_name = 200;  // in bytes, as for the name of a branch
  for (const NamedPoint& landmark : landmarks) {
    const std::string& name = landmark.name;
    if (std::any_of(known.begin(), known.end(), [&](const NamedPoint& old) { return old.name == name; }))
      continue;
    if (name.size() > longest_name)
      throw std::runtime_error("a landmark's name has " + std::to_string(longest_name) +
                               " bytes at most, not " + std::to_string(name.size()));
    if (has_control(name))
      throw std::runtime_error("the landmark '" + name + "' needs a name without control characters");
  }
}

}  // namespace

Document::Document(const std::filesystem::path& path, const Folders& folders)
    : path_(path), folders_(folders) {
  // Refuses an invalid plan, or a plan that reads forbidden files, before its history is written.
  other(path_);
  history_ = std::make_unique<PlanHistory>(path_);
  read_again();
}

Plan Document::other(const std::filesystem::path& path) const {
  // Must precede read_plan(), which reads files that steps name.
  need_files_within(Json(read_json(path)), path.parent_path(), folders_);
  Plan plan = read_plan(path);
  need_readable_files(plan, folders_);
  return plan;
}

Plan Document::plan_at(std::int64_t edit) const {
  return readable(history_->text_of(edit));
}

void Document::read_again() {
  Plan plan = readable(history_->text());
  plan.file = path_;
  plan_ = std::make_shared<const Plan>(std::move(plan));
}

Plan Document::readable(const std::string& text) const {
  // A text that is not JSON needs no check of its files: parse_plan() refuses it before it reads any.
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_object()) need_files_within(json, path_.parent_path(), folders_);
  Plan plan = parse_plan(text, path_.parent_path());
  need_readable_files(plan, folders_);
  return plan;
}

Plan Document::parsed(const Json& json) const {
  return readable(json_text(json, 2) + "\n");
}

Plan Document::with_steps(const Json& steps) const {
  Json whole = json();
  for (const Json& step : steps) whole["steps"].push_back(step);
  return parsed(whole);
}

void Document::edit(const Json& said) {
  Json changed = json();
  for (const char* key : {"steps", "scans", "universe", "name"})
    if (said.contains(key)) changed[key] = said[key];
  change_steps(changed["steps"], said);
  record(changed, said.value("what", "edited"));
}

void Document::place_landmark(const std::string& name, const Json& point_mm) {
  Json changed = json();
  Json& points = points_in(changed["steps"]);
  const auto known = std::find_if(points.begin(), points.end(),
                                  [&](const Json& point) { return point.value("name", "") == name; });
  if (known != points.end())
    (*known)["point_mm"] = point_mm;
  else
    points.push_back({{"name", name}, {"point_mm", point_mm}});
  record(changed, "landmark " + name);
}

void Document::record(const Json& json, const std::string& what) {
  const Plan plan = parsed(json);
  need_short_names(plan.landmarks, plan_->landmarks);
  if (plan.name != plan_->name) need_no_control(plan.name, "the plan's name");
  for (const auto& [name, scan] : plan.scans)
    if (!plan_->scans.contains(name)) need_no_control(name, "a scan's name");
  need_no_control(what, "the description of the edit");
  history_->record(json_text(json, 2) + "\n", what);
  read_again();
}

template <typename Move>
void Document::move(const Move& to) {
  const std::int64_t edit = history_->current();
  const std::string branch = history_->branch();
  to();
  try {
    read_again();
  } catch (...) {
    if (history_->branch() != branch) history_->go_to(branch);
    history_->go_to(std::to_string(edit));
    throw;
  }
}

bool Document::undo() {
  bool done = false;
  move([&] { done = history_->undo(); });
  return done;
}

bool Document::redo() {
  bool done = false;
  move([&] { done = history_->redo(); });
  return done;
}

void Document::go_to(const std::string& where) {
  move([&] { history_->go_to(where); });
}

void Document::begin_branch(const std::string& name) {
  history_->begin_branch(name);
}

void Document::name_version(const std::string& name) {
  history_->name_version(name);
}

Json Document::difference_of(std::int64_t a, std::int64_t b) const {
  const PlanDifference found = difference(plan_at(a), plan_at(b));
  Json json = planner::to_json(found);
  json["rows"] = Json::array();
  std::istringstream text(text_of(found));
  for (std::string line; std::getline(text, line);) json["rows"].push_back(line);
  return json;
}

Json Document::history_json() const {
  Json json{{"branch", history_->branch()}, {"edit", history_->current()}};
  Json list = Json::array();
  std::vector<PlanEdit> edits = history_->newest(most_listed);
  std::reverse(edits.begin(), edits.end());
  for (const PlanEdit& edit : edits)
    list.push_back({{"id", edit.id},
                    {"parent", edit.parent ? Json(*edit.parent) : Json(nullptr)},
                    {"what", edit.what},
                    {"made_at", edit.made_at},
                    {"names", edit.names}});
  Json branches = Json::array();
  for (const auto& [name, end] : history_->branches()) branches.push_back({name, end});
  json["can_undo"] = history_->can_undo();
  json["can_redo"] = history_->can_redo();
  json["history"] = list;
  json["branches"] = branches;
  return json;
}

}  // namespace octotomy::planner::serve
