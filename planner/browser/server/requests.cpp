// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/requests.h"

#include <algorithm>
#include <chrono>
#include <tuple>

#include "planner/browser/server/cephalometry_request.h"
#include "planner/browser/server/contour_request.h"
#include "planner/browser/server/doubtful_places.h"
#include "planner/browser/server/merge_request.h"
#include "planner/browser/server/new_files.h"
#include "planner/browser/server/new_plan.h"
#include "planner/browser/server/object_requests.h"
#include "planner/browser/server/pane_fields.h"
#include "planner/browser/server/signature_request.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/plan/plan.h"
#include "planner/plan/rebase.h"
#include "planner/procedure/template/chain.h"
#include "planner/procedure/template/planned_values.h"
#include "planner/procedure/template/procedure.h"
#include "voxel/filter/tissue.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/error.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

Json json_of(const std::vector<ProcedureValue>& values) {
  Json json = Json::array();
  for (const ProcedureValue& value : values)
    json.push_back({{"name", value.name},
                    {"unit", unit_of_name(value.name)},
                    {"default", value.preset},
                    {"says", value.says},
                    {"low", value.least},
                    {"high", value.most}});
  return json;
}

Json procedures_json() {
  Json list = Json::array();
  for (const std::string& name : procedures()) {
    const Procedure procedure = read_procedure(name);
    Json json{{"name", name},
              {"says", procedure.says},
              {"landmarks", Json::array()},
              {"scans", Json::array()},
              {"values", json_of(procedure.values)},
              {"options", Json::array()}};
    for (const ProcedureLandmark& landmark : procedure.landmarks)
      json["landmarks"].push_back(
          {{"name", landmark.name}, {"says", landmark.says}, {"scan", landmark.scan}});
    for (const ProcedureScan& scan : procedure.scans)
      json["scans"].push_back({{"name", scan.name}, {"says", scan.says}});
    for (const ProcedureOption& option : procedure.options)
      json["options"].push_back(
          {{"name", option.name}, {"says", option.says}, {"values", json_of(option.values)}});
    list.push_back(std::move(json));
  }
  return list;
}

Json hello(Session& session, const Json&, const Watched& watched) {
  Json tissues = Json::array(), folders = Json::array();
  for (const voxel::Tissue& tissue : voxel::tissues())
    tissues.push_back({{"name", std::string(tissue.name)},
                       {"low", tissue.low ? Json(*tissue.low) : Json(nullptr)},
                       {"high", tissue.high ? Json(*tissue.high) : Json(nullptr)},
                       {"source", std::string(tissue.source)}});
  const bool may_edit = watched.access == Access::Edit;
  if (may_edit)
    for (const fs::path& folder : session.folders.opened()) folders.push_back(folder.string());
  return {{"version", OCTOTOMY_VERSION},
          {"may_edit", may_edit},
          {"units", {{"length", "mm"}, {"angle", "deg"}, {"frame", "LPS"}}},
          {"plan_state", session.state()},
          {"schema", plan_schema()},
          {"procedures", procedures_json()},
          {"tissues", tissues},
          {"folders", folders},
          {"most_upload_bytes", most_upload_bytes}};
}

Json open(Session& session, const Json& said, const Watched& watched) {
  if (said.contains("phantom")) {
    const voxel::Progress progress{watched.stop, [&](double share) {
                                     if (watched.progress) watched.progress("making the head phantom", share);
                                   }};
    const fs::path place = session.folders.need_within(session.working_folder() / "head_phantom.nrrd");
    session.open(phantom_at(place, progress), watched);
  } else {
    session.open(session.folders.need_within(said.at("path").get<std::string>()), watched,
                 said.value("series", ""));
  }
  return nullptr;
}

/// Lists the DICOM series of a folder, so that a person can choose one. Empty if the path is not a folder of
/// DICOM files; opening the path then states why it cannot be read.
Json series(Session& session, const Json& said, const Watched&) {
  const fs::path path = session.folders.need_within(said.at("path").get<std::string>());
  Json list = Json::array();
  if (!fs::is_directory(path)) return {{"series", list}};
  try {
    for (const voxel::SeriesEntry& entry : voxel::list_series(path))
      list.push_back(
          {{"choice", entry.choice},
           {"name", entry.description},
           {"stack", entry.stack},
           {"number", entry.number},
           {"modality", entry.modality},
           {"slices", entry.slices},
           {"size", {entry.size_px.x, entry.size_px.y}},
           {"spacing_mm",
            {entry.spacing_mm.x, entry.spacing_mm.y, entry.slice_mm ? Json(*entry.slice_mm) : Json(nullptr)}},
           {"study_date", entry.study_date}});
  } catch (const voxel::Error& error) {
    if (error.code() != voxel::ErrorCode::Input) throw;
  }
  return {{"series", list}};
}

/// Whether a file beside scans is none itself: a plan's history, or another JSON file.
bool is_beside(const std::string& name) {
  return name.find(".plan.json.") != std::string::npos || name.ends_with(".json");
}

Json list(Session& session, const Json& said, const Watched&) {
  constexpr std::size_t most_entries = 5000;
  const fs::path folder =
      session.folders.need_within(said.value("folder", session.working_folder().string()));
  Json entries = Json::array();
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entries.size() == most_entries) break;
    const std::string name = entry.path().filename();
    if (name.starts_with(".")) continue;
    std::error_code failed;
    const bool is_folder = entry.is_directory(failed);
    entries.push_back({{"name", name},
                       {"kind", is_folder                      ? "folder"
                                : name.ends_with(".plan.json") ? "plan"
                                : is_beside(name)              ? "other"
                                                               : "file"},
                       {"size", is_folder ? 0 : entry.file_size(failed)}});
  }
  std::sort(entries.begin(), entries.end(), [](const Json& a, const Json& b) {
    return std::pair(a["kind"] != "folder", a["name"]) < std::pair(b["kind"] != "folder", b["name"]);
  });
  return {{"folder", folder.string()}, {"entries", entries}};
}

/// Lists the plans in the opened folders, the most recently changed one first.
Json recent(Session& session, const Json&, const Watched&) {
  constexpr std::size_t most_plans = 8;
  struct Found {
    fs::file_time_type changed;
    fs::path path;
  };
  std::vector<Found> found;
  for (const fs::path& folder : session.folders.opened()) {
    std::error_code failed;
    for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
         entry.increment(failed)) {
      const std::string name = entry->path().filename();
      std::error_code unread;
      const fs::file_time_type changed = entry->last_write_time(unread);
      if (!unread && name.ends_with(".plan.json") && !name.starts_with(".") && entry->is_regular_file(unread))
        found.push_back({changed, entry->path()});
    }
  }
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return std::tie(b.changed, a.path) < std::tie(a.changed, b.path);
  });
  if (found.size() > most_plans) found.resize(most_plans);
  Json plans = Json::array();
  for (const Found& plan : found) {
    const auto since = std::chrono::file_clock::to_sys(plan.changed).time_since_epoch();
    plans.push_back(
        {{"path", plan.path.string()},
         {"name", plain_stem(plan.path)},
         {"changed_at_ms", std::chrono::duration_cast<std::chrono::milliseconds>(since).count()}});
  }
  return {{"plans", plans}};
}

/// The handler of a request that changes the document by `work`.
template <typename Change>
auto change(const Change& work) {
  return [work](Session& session, const Json& said, const Watched&) -> Json {
    session.with_document([&](Document& document) { work(document, said); });
    return nullptr;
  };
}

Json save(Session& session, const Json& said, const Watched&) {
  const bool is_own = !said.contains("path") || said["path"].is_null();
  const auto plan = session.with_document([&](Document& document) {
    if (is_own) document.need_saved();
    return document.plan();
  });
  if (is_own) return {{"path", plan->file.string()}};
  const fs::path to = session.folders.need_within(said["path"].get<std::string>());
  if (to.extension() != ".json")
    throw voxel::Error(voxel::ErrorCode::Input, to.string() + ": a plan's name ends in .plan.json");
  if (fs::exists(to))
    throw voxel::Error(voxel::ErrorCode::Input, to.string() + ": exists already; choose another name");
  need_folder_of(to);
  voxel::write_whole(to, rebased(*plan, to.parent_path()).text);
  return {{"path", to.string()}};
}

Json evaluate(Session& session, const Json& said, const Watched& watched) {
  const bool certify = said.value("certify", false);
  if (certify && watched.access == Access::View)
    throw voxel::Error(voxel::ErrorCode::Input, "this window only shows the plan: it cannot certify");
  const Snapshot made = session.evaluate(said.value("objects", std::vector<std::string>{}), certify, watched);
  const Json state = session.state();
  return {
      {"objects", state.at("objects")}, {"measurements", made.measurements}, {"scans", state.at("scans")}};
}

/// Whether a step defines names or directions for later steps. A plan has at most one such step of each kind,
/// before the steps that use it.
bool is_of_names(const Json& step) {
  return step["do"] == "landmarks" || step["do"] == "head_position";
}

/// Joins the steps of a plan with those of a procedure, in which the scan "ct" is renamed to `scan`. A
/// procedure's step replaces the plan's step of the same id. A step that defines names replaces the plan's
/// step of the same kind, but keeps its landmarks of other names.
Json joined(const Json& steps, const Json& of_procedure, const std::string& scan) {
  Json names = Json::array(), kept = Json::array(), others = Json::array();
  for (Json step : of_procedure) {
    if (step.value("scan", "") == "ct") step["scan"] = scan;
    (is_of_names(step) ? names : others).push_back(std::move(step));
  }
  for (const Json& step : steps) {
    const auto same_kind = std::find_if(names.begin(), names.end(), [&](const Json& name) {
      return is_of_names(step) && name["do"] == step["do"];
    });
    if (same_kind != names.end()) {
      for (const Json& point : step.value("points", Json::array())) {
        Json& points = (*same_kind)["points"];
        if (std::none_of(points.begin(), points.end(),
                         [&](const Json& known) { return known["name"] == point["name"]; }))
          points.push_back(point);
      }
    } else if (std::none_of(others.begin(), others.end(),
                            [&](const Json& other) { return other["id"] == step["id"]; })) {
      kept.push_back(step);
    }
  }
  for (const Json* part : {&kept, &others})
    for (const Json& step : *part) names.push_back(step);
  return names;
}

ProcedureInput input_of(const Json& said, const Json& plan, const Procedure& procedure) {
  ProcedureInput input;
  input.scan = plan.at("scans").front();
  for (const ProcedureScan& scan : procedure.scans)
    if (plan["scans"].contains(scan.name)) input.further_scans[scan.name] = plan["scans"][scan.name];
  for (const auto& [name, point] : said.at("landmarks").items())
    if (const auto p_mm = point_of(said.at("landmarks"), name.c_str()))
      input.landmarks.push_back({name, *p_mm});
  const Json values = said.value("values", Json::object());
  for (const auto& [name, value] : values.items()) input.values[name] = value.get<double>();
  return input;
}

/// The plan without all steps of the procedure, whether it was planned alone or after another procedure.
Json without_steps_of(const Procedure& procedure, const Json& plan) {
  Json kept = plan;
  kept["steps"] = Json::array();
  for (const Json& step : plan.at("steps"))
    if (!is_chained_step_of(procedure, step["id"])) kept["steps"].push_back(step);
  return kept;
}

/// Whether a plan's step has other views or landmarks than the procedure's step of the same id. Steps of
/// zygoma_right and zygoma_left have the same ids and differ only in these.
bool names_others(const Procedure& procedure, const Json& own, const Json& planned,
                  const std::string& key = {}) {
  if (own.is_string() && planned.is_string())
    return own != planned &&
           (key == "view" || std::any_of(procedure.landmarks.begin(), procedure.landmarks.end(),
                                         [&](const ProcedureLandmark& mark) { return own == mark.name; }));
  if (own.is_array() && planned.is_array())
    return std::any_of(own.begin(), own.end(), [&, i = std::size_t{0}](const Json& part) mutable {
      const std::size_t at = i++;
      return at < planned.size() && names_others(procedure, part, planned[at], key);
    });
  if (!own.is_object() || !planned.is_object()) return false;
  return std::any_of(planned.items().begin(), planned.items().end(), [&](const auto& entry) {
    return own.contains(entry.key()) &&
           names_others(procedure, own.at(entry.key()), entry.value(), entry.key());
  });
}

/// Whether a plan has all steps of a procedure under the ids in the procedure's file, that is, not after
/// another procedure.
bool has_own_steps(const Procedure& procedure, const Json& plan) {
  const Json& steps = plan.at("steps");
  return std::all_of(procedure.steps.begin(), procedure.steps.end(), [&](const Json& own) {
    return std::any_of(steps.begin(), steps.end(), [&](const Json& step) {
      return step["id"] == own["id"] && !names_others(procedure, own, step);
    });
  });
}

/// The object on which the procedure acts: the result of an earlier procedure of the plan. None if there is
/// no earlier one, or if the plan has the procedure's steps under the ids of its file. These steps are then
/// replaced.
std::optional<std::string> acted_on(const Procedure& procedure, const Json& whole, const Plan& before) {
  return has_own_steps(procedure, whole) ? std::nullopt : outcome_of(before);
}

/// Whether a plan's step is one of an option, by id and operation. `chained`: the procedure was planned after
/// another one, so its ids in the plan begin with the procedure's name. Otherwise they are those of the file.
bool is_step_of(const Procedure& procedure, const ProcedureOption& option, bool chained, const Json& step) {
  const auto id = step.at("id").get<std::string>();
  const std::optional<std::string> name = chained ? name_before_chaining(procedure, id) : id;
  return std::any_of(option.steps.begin(), option.steps.end(), [&](const Json& own) {
    return name && own.at("id") == *name && own.at("do") == step.at("do");
  });
}

/// Whether a plan has more than half of an option's steps. Not all are required, because the user may have
/// deleted some. One is not enough, because another step may have the same id by chance.
bool has_option(const Procedure& procedure, const ProcedureOption& option, bool chained, const Json& plan) {
  const Json& steps = plan.at("steps");
  const auto present = std::count_if(steps.begin(), steps.end(), [&](const Json& step) {
    return is_step_of(procedure, option, chained, step);
  });
  return 2 * static_cast<std::size_t>(present) > option.steps.size();
}

/// The plan without the steps of options that are not chosen, for a procedure that is not chained.
Json without_other_options(const Procedure& procedure, const std::vector<std::string>& chosen,
                           const Json& plan) {
  Json kept = plan;
  for (const ProcedureOption& option : procedure.options) {
    if (std::find(chosen.begin(), chosen.end(), option.name) != chosen.end() ||
        !has_option(procedure, option, false, kept))
      continue;
    Json others = Json::array();
    for (const Json& step : kept["steps"])
      if (!is_step_of(procedure, option, false, step)) others.push_back(step);
    kept["steps"] = std::move(others);
  }
  return kept;
}

Procedure known_procedure(const Json& said) {
  // Only listed names are read. Otherwise a request could read any file by its path.
  const auto name = said.at("name").get<std::string>();
  const std::vector<std::string> known = procedures();
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw std::runtime_error("there is no procedure '" + name + "'" + suggestion(name, known));
  return read_procedure(name);
}

/// The steps of a procedure in the plan, under the ids of the procedure's file; all other steps too, unless
/// `chained`, which is as in is_step_of().
Json steps_named_as_in_file(const Procedure& procedure, bool chained, const Json& plan) {
  Json steps = Json::array();
  for (Json step : plan.at("steps")) {
    if (chained) {
      const auto name = name_before_chaining(procedure, step.at("id"));
      if (!name) continue;
      step["id"] = *name;
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

/// The lower bound of the plan's window of bone, as the procedure's value for it. In a scan of another
/// scanner or unit, the procedure's default could be another tissue. Null if the procedure or the plan has no
/// such window, without an upper bound.
Json chosen_bone(const Procedure& procedure, const Json& plan) {
  const auto bone = std::find_if(procedure.steps.begin(), procedure.steps.end(),
                                 [&](const Json& step) { return step.at("id") == procedure.acts_on; });
  if (bone == procedure.steps.end() || !bone->contains("low") || !bone->at("low").is_string()) return nullptr;
  const auto name = bone->at("low").get<std::string>().substr(1);  // "=bone_low"
  for (const Json& step : plan.at("steps"))
    if (step.at("do") == "window" && step.value("scan", "") == plan.at("scans").begin().key() &&
        step.contains("low") && !step.contains("high"))
      return {{name, {{"value", step["low"]}, {"is_agreed", true}}}};
  return nullptr;
}

/// Returns the contents of the procedure's form: the object on which the procedure would act, and the options
/// and values of its steps in the plan.
Json acts_on(Session& session, const Json& said, const Watched& watched) {
  const Procedure procedure = known_procedure(said);
  const auto [whole, folder] = session.with_document([](Document& document) {
    return std::pair{Json(document.json()), document.path().parent_path()};
  });
  const Plan before = parse_plan(without_steps_of(procedure, whole).dump(), folder);
  const std::optional<std::string> outcome = acted_on(procedure, whole, before);
  std::vector<std::string> with;
  for (const ProcedureOption& option : procedure.options)
    if (has_option(procedure, option, outcome.has_value(), whole)) with.push_back(option.name);
  const auto coordinates = [&] {
    const std::vector<brep::Landmark> landmarks = carried_landmarks(
        before, outcome ? session.evaluate(before, {*outcome}, false, watched) : Evaluation());
    return coordinates_of(landmarks, before.lps_from_head.value_or(glm::dmat3(1.0)));
  };
  const Json steps = steps_named_as_in_file(procedure, outcome.has_value(), whole);
  Json values = outcome ? Json() : chosen_bone(procedure, whole);
  if (values.is_null()) values = Json::object();
  for (const auto& [name, value] : planned_values(with_options(procedure, with), steps, coordinates))
    values[name] = {{"value", value.value}, {"is_agreed", value.is_agreed}};
  return {{"outcome", outcome ? Json(*outcome) : Json(nullptr)},
          {"is_planned", outcome ? !steps.empty() : has_own_steps(procedure, whole)},
          {"with", with},
          {"values", values}};
}

/// Adds the steps of a procedure to the plan. They replace its earlier steps, follow another procedure's
/// result, or come first.
Json procedure(Session& session, const Json& said, const Watched& watched) {
  const Procedure known = known_procedure(said);
  const auto options = said.value("with", std::vector<std::string>{});
  const Procedure procedure = with_options(known, options);
  const auto [text, whole, folder] = session.with_document([](Document& document) {
    return std::tuple{document.plan()->text, Json(document.json()), document.path().parent_path()};
  });
  ProcedureInput input = input_of(said, whole, procedure);
  input.folder = folder;
  const Plan before = parse_plan(without_steps_of(procedure, whole).dump(), folder);
  const std::optional<std::string> outcome = acted_on(known, whole, before);
  Json made;
  std::vector<std::string> added, carried;
  if (outcome) {
    input.further_scans.clear();  // the plan has them
    // chained() refuses a value that only the window uses. The page sends every value, so values that equal
    // their default are left out.
    for (const ProcedureValue& value : procedure.values)
      if (const auto sent = input.values.find(value.name);
          sent != input.values.end() && sent->second == value.preset)
        input.values.erase(sent);
    Chained chain = chained(before, session.evaluate(before, {*outcome}, false, watched), procedure, input);
    made = std::move(chain.plan);
    added = std::move(chain.made);
    carried = std::move(chain.carried);
  } else {
    input.voxel_mm = before.voxel_mm.value_or(1.0);
    const Json alone = plan_of(procedure, input);
    made = without_other_options(known, options, whole);
    made["steps"] = joined(made["steps"], alone.at("steps"), whole["scans"].begin().key());
    for (const Json& step : alone.at("steps")) added.push_back(step.at("id"));
  }
  Json ids = Json::array();
  session.with_document([&, &text = text](Document& document) {
    if (document.plan()->text != text)
      throw voxel::Error(voxel::ErrorCode::Input, "the plan was changed meanwhile: plan the procedure again");
    document.record(made, procedure.name);
    for (const Step& step : document.plan()->steps)
      if (std::find(added.begin(), added.end(), step.id) != added.end() &&
          step.action.operation().makes == Makes::Object)
        ids.push_back(step.id);
  });
  return {{"made", ids}, {"carried", carried}};
}

Json diff(Session& session, const Json& said, const Watched&) {
  const auto edit_of = [&](const char* key) { return said.at(key).get<std::int64_t>(); };
  return session.with_document(
      [&](const Document& document) -> Json { return document.difference_of(edit_of("a"), edit_of("b")); });
}

}  // namespace

const std::vector<RequestKind>& request_kinds() {
  static const std::vector<RequestKind> all{
      {"hello", Lane::Session, false, hello, false, true},
      {"open", Lane::Long, true, open},
      {"list", Lane::Session, false, list},
      {"series", Lane::Long, false, series},
      {"recent", Lane::Session, false, recent},
      {"save", Lane::Session, false, save},
      {"edit", Lane::Session, true,
       change([](Document& document, const Json& said) { document.edit(said); })},
      {"undo", Lane::Session, true, change([](Document& document, const Json&) { document.undo(); })},
      {"redo", Lane::Session, true, change([](Document& document, const Json&) { document.redo(); })},
      {"go_to", Lane::Session, true, change([](Document& document, const Json& said) {
         const Json& where = said.at("where");
         document.go_to(where.is_string() ? where.get<std::string>() : where.dump());
       })},
      {"branch", Lane::Session, true,
       change([](Document& document, const Json& said) { document.begin_branch(said.at("name")); })},
      {"name_version", Lane::Session, true,
       change([](Document& document, const Json& said) { document.name_version(said.at("name")); })},
      {"diff", Lane::Session, false, diff, false, true},
      {"procedure", Lane::Session, true, procedure},
      {"acts_on", Lane::Session, false, acts_on},
      {"landmark", Lane::Session, true, place_landmark},
      {"find_landmarks", Lane::Long, false, find_landmarks},
      {"command", Lane::Session, false, command_of_step},
      {"evaluate", Lane::Evaluate, false, evaluate, true, true},
      {"overlap", Lane::Overlap, false, overlap},
      {"part", Lane::Long, false, part},
      {"try", Lane::Long, false, try_steps},
      {"trace", Lane::Long, false, trace_contours},
      {"measure", Lane::Long, false, measure},
      {"movement", Lane::Long, false, movement, false, true},
      {"mesh_audit", Lane::Long, false, mesh_audit},
      {"certify", Lane::Long, false, certify, true},
      {"export", Lane::Long, false, export_file},
      {"report", Lane::Long, false, report},
      {"outcome", Lane::Long, false, outcome},
      {"cephalometry", Lane::Long, false, cephalometry, false, true},
      {"doubtful_places", Lane::Long, false, doubtful_places},
      {"try_merge", Lane::Session, false, try_merge},
      {"merge", Lane::Session, true, merge_plan},
      {"signatures", Lane::Long, false, signatures},
      {"sign", Lane::Long, true, sign_plan},
  };
  return all;
}

const RequestKind& find_request_kind(const std::string& name) {
  std::vector<std::string> names;
  for (const RequestKind& request_kind : request_kinds()) {
    if (request_kind.name == name) return request_kind;
    names.push_back(request_kind.name);
  }
  // The search for the nearest word takes longer the longer the typed word is.
  constexpr std::size_t longest_typed = 60;
  throw voxel::Error(
      voxel::ErrorCode::Input,
      "there is no request '" + name + "'" + (name.size() <= longest_typed ? suggestion(name, names) : ""));
}

}  // namespace octotomy::planner::serve
