// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/session.h"

#include <algorithm>
#include <set>

#include "planner/browser/server/measurement_message.h"
#include "planner/browser/server/new_plan.h"
#include "planner/browser/server/pane_fields.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/plan_universe.h"
#include "planner/plan/dependence.h"
#include "planner/plan/plan_results.h"
#include "planner/result/report/patient.h"
#include "voxel/filter/tissue.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

/// Largest number of results in the session's cache, and largest size in bytes of their memory. Each limit
/// applies to objects and to scans separately. A certified head takes 400 MB, so at least two are stored,
/// which undo and redo find again.
constexpr std::size_t most_answers = 512;
constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;

bool makes_object(const Step& step) {
  return step.action.operation().makes == Makes::Object;
}

/// The keys of a plan's steps. A stored result belongs to the current plan if its step has the same key.
std::map<std::string, std::string> keys_of(const Plan& plan) {
  return step_keys(plan, plan.voxel_mm ? std::to_string(*plan.voxel_mm) : "", [&](const std::string& scan) {
    return state_of_path(scan_path(plan, plan.scans.at(scan)));
  });
}

Json box_json(const voxel::Box& box) {
  return {planner::to_json(box.low_mm), planner::to_json(box.high_mm)};
}

/// Level and width of a scan's slices, in its samples.
Json tones_of(const ScanRecord& scan) {
  if (scan.meaning == voxel::Meaning::Hounsfield) return {500.0, 2000.0};
  return {0.5 * (scan.range.low + scan.range.high), std::max(1.0, scan.range.high - scan.range.low)};
}

Json scan_json(const ScanRecord& scan) {
  Json json = planner::to_json(scan);
  Json audit = Json::array();
  for (const voxel::Finding& finding : scan.audit) {
    audit.push_back(planner::to_json(std::vector{finding}).front());
    audit.back().update({{"sentence", finding.detail}});
  }
  json.update({{"audit", audit},
               {"bounds_mm", box_json(voxel::bounds(scan.lattice))},
               {"window_suggestion", tones_of(scan)},
               {"patient", patient_json(scan.identity)}});
  return json;
}

Json certificate_json(const verify::Certificate& certificate) {
  Json json = planner::to_json(certificate);
  std::string sentence = verify::verdict_text(certificate);
  if (certificate.verdict == voxel::Verdict::Pass) sentence += ": both kernels agree";
  if (certificate.limit)
    sentence += "; a part of " + three_figures(certificate.limit->volume_mm3) +
                " mm\u00b3 that is lost or added would have been seen";
  for (const std::string& reason : certificate.reasons) sentence += ". " + reason;
  json.update({{"sentence", sentence},
               {"place", certificate.worst ? planner::to_json(certificate.worst->at_mm) : Json(nullptr)}});
  return json;
}

/// The thin necks of an object made by choosing parts: those that stay although only one kernel connects them
/// ("kept"), and those that the certificate leaves undecided. Null if there are none.
Json necks_json(const Object& object) {
  Json necks;
  const auto add = [&](const Json& at_mm, const Json& volume_mm3, bool is_kept) {
    necks.push_back({{"at_mm", at_mm}, {"volume_mm3", volume_mm3}, {"kept", is_kept}});
  };
  if (const auto kept = object.mesh.details.find("kept_bridges"); kept != object.mesh.details.end())
    for (const Json& neck : *kept) add(neck.at("at_mm"), neck.at("volume_mm3"), true);
  if (object.certificate)
    for (const verify::WorstPlace& neck : object.certificate->bridges)
      add(planner::to_json(neck.at_mm), neck.volume_mm3, false);
  return necks;
}

/// An object as a page shows it. Members without a value are not evaluated yet.
struct ObjectState {
  std::string id;
  bool evaluated = false;
  std::optional<std::string> error, definition;
  std::optional<std::vector<std::string>> findings;
  std::optional<Json> bounds_mm, volume, certificate, mirror;
};
constexpr auto members_of(const ObjectState&) {
  using O = ObjectState;
  return std::tuple(member("id", &O::id), member("evaluated", &O::evaluated),
                    member_if_any("error", &O::error), member_if_any("definition", &O::definition),
                    member_if_any("findings", &O::findings), member_if_any("bounds_mm", &O::bounds_mm),
                    member_if_any("volume", &O::volume), member_if_any("certificate", &O::certificate),
                    member_if_any("mirror", &O::mirror));
}

void add(const Object& object, ObjectState& state) {
  state.evaluated = true;
  state.definition = object.definition;
  state.findings = object.findings;
  const auto& extents = object.voxel.measures.extents;
  state.bounds_mm = extents ? box_json(*extents) : Json(nullptr);
  state.volume = {{"value", object.voxel.measures.volume_mm3}, {"unit", "mm3"}};
  if (object.certificate) state.certificate = certificate_json(*object.certificate);
  const Json& details = object.mesh.details;
  if (const auto plane = details.find("plane"); plane != details.end()) {
    Json mirror{{"plane", *plane}};
    for (const char* key : {"rms_mm", "kept_share", "converged"}) {
      const auto value = details.find(key);
      mirror.emplace(key, value == details.end() ? Json(nullptr) : Json(*value));
    }
    state.mirror = std::move(mirror);
  }
}

/// Prefix of ids of temporary measure steps, which compute an object's recommended volume and area.
constexpr const char* size_step_prefix = "size_of_";

/// The results of a plan's measuring steps. For a step that failed, stores the reason in `errors` under the
/// step's id.
Json answered(const Plan& plan, const Evaluation& evaluation, std::map<std::string, std::string>& errors) {
  try {
    return measurements_json(plan, evaluation);
  } catch (const std::exception& error) {
    if (!is_no_answer(error)) throw;
  }
  Json list = Json::array();
  Plan alone = plan;
  for (const Step& step : plan.steps) {
    alone.steps = {step};
    try {
      list.push_back(measurements_json(alone, evaluation).front());
    } catch (const std::exception& error) {
      if (!is_no_answer(error)) throw;
      errors.emplace(step.id, message_of(error));
    }
  }
  return list;
}

/// The results of the measuring steps whose objects are evaluated, as a page shows them, and the reasons why
/// measurements and scans failed. `errors` as in answered().
Json measurements_of(const Plan& plan, const Evaluation& evaluation,
                     std::map<std::string, std::string>& errors) {
  const auto is_there = [&](const std::string& id) {
    return std::any_of(evaluation.objects.begin(), evaluation.objects.end(),
                       [&](const Object& object) { return object.id == id; });
  };
  Plan measuring = plan;
  std::erase_if(measuring.steps, [&](const Step& step) {
    const std::vector<std::string> used = objects_used(step.action);
    return step.action.operation().makes != Makes::Measurement ||
           !std::all_of(used.begin(), used.end(), is_there);
  });
  Json list = Json::array();
  for (const Json& answer : answered(measuring, evaluation, errors)) {
    Json told = measurement_message(answer);
    if (!told.is_null()) list.push_back(std::move(told));
  }
  const auto is_listed = [](const Step& step) {
    const Makes makes = step.action.operation().makes;
    return makes == Makes::Measurement || makes == Makes::Scan;
  };
  for (const Step& step : plan.steps)
    if (const auto failed = errors.find(step.id); failed != errors.end() && is_listed(step))
      list.push_back({{"id", step.id},
                      {"says", "no answer"},
                      {"value", nullptr},
                      {"unit", "mm"},
                      {"half_width", nullptr},
                      {"sentence", failed->second}});
  return list;
}

/// Those of the wanted steps that need no failed step.
std::vector<std::string> steps_without(const Plan& plan, const std::vector<std::string>& wanted,
                                       const std::map<std::string, std::string>& errors) {
  std::vector<std::string> kept;
  for (const std::string& id : wanted) {
    const std::set<std::string> needed = needed_for(plan, {id});
    if (std::none_of(errors.begin(), errors.end(),
                     [&](const auto& failed) { return needed.contains(failed.first); }))
      kept.push_back(id);
  }
  return kept;
}

}  // namespace

bool is_plan(const fs::path& path) {
  return path.extension() == ".json";
}

Session::Session(fs::path working_folder)
    : cache(most_answers, most_bytes), working_folder_(std::move(working_folder)) {
  folders.open(working_folder_);
}

void Session::open(const fs::path& path, const Watched& watched, const std::string& series) {
  const voxel::Progress progress{watched.stop, [&](double share) {
                                   if (watched.progress) watched.progress("read " + path.string(), share);
                                 }};
  if (!is_plan(path)) need_readable_samples(folders, path);
  const fs::path plan = is_plan(path) ? path : plan_of_scan(path, working_folder_, progress, series);
  auto document = std::make_unique<Document>(plan, folders);
  folders.open(plan);
  {
    const std::lock_guard lock(mutex_);
    document_ = std::move(document);
    ++opened_;
    snapshot_ = {};
    certified_.clear();
  }
  // Scans are evaluated before any object, so that the page can show their audits and slices early.
  Plan without_steps = with_document([](const Document& opened) { return *opened.plan(); });
  without_steps.steps.clear();
  Snapshot scans;
  scans.evaluation = std::make_shared<const Evaluation>(evaluate(without_steps, {}, false, watched));
  scans.bone_lows = bone_lows_of(*scans.evaluation);
  const std::lock_guard lock(mutex_);
  if (document_ && !snapshot_.evaluation) {
    scans.plan = document_->plan();
    snapshot_ = std::move(scans);
  }
}

void Session::close_within(std::chrono::milliseconds most) {
  const std::unique_lock lock(mutex_, most);
  if (lock.owns_lock()) document_.reset();
}

Document& Session::need_document() const {
  if (document_ == nullptr)
    throw voxel::Error(voxel::ErrorCode::Input, "no plan is open: open a scan, a plan or the head phantom");
  return *document_;
}

Evaluation Session::evaluate(const Plan& plan, const std::vector<std::string>& steps, bool certify,
                             const Watched& watched, bool only_look_up) {
  EvaluateOptions options;
  options.stop = watched.stop;
  options.progress = watched.progress;
  options.certify = options.meshes = certify;
  options.wanted = steps;
  options.keep_scans = true;
  options.cache = &cache;
  options.only_look_up = only_look_up;
  options.read_scene = [this](const fs::path& path, const voxel::ReadOptions& how) {
    if (!how.raw) need_readable_samples(folders, path);
    return voxel::read_scene(path, how);
  };
  return planner::evaluate(plan, options);
}

Snapshot Session::evaluate(const std::vector<std::string>& steps, bool certify, const Watched& watched) {
  Snapshot made;
  std::uint64_t opened = 0;
  std::vector<std::string> wanted = steps;
  {
    const std::lock_guard lock(mutex_);
    made.plan = need_document().plan();
    opened = opened_;
    // An undo may have removed a requested step in the meantime.
    std::erase_if(wanted, [&](const std::string& id) {
      const auto& all = made.plan->steps;
      return !certify &&
             std::none_of(all.begin(), all.end(), [&](const Step& step) { return step.id == id; });
    });
    // Objects of the current snapshot are evaluated too, so that the new one also contains them.
    if (!steps.empty() && !certify && snapshot_.evaluation)
      for (const Step& step : made.plan->steps)
        if (makes_object(step) && record_of<ObjectState>(object_json(snapshot_, step.id)).evaluated)
          wanted.push_back(step.id);
  }
  if (steps.empty())
    for (const Step& step : made.plan->steps)
      // Certifying also runs measurements and exports.
      if (certify || makes_object(step) || step.action.operation().makes == Makes::Scan)
        wanted.push_back(step.id);
  std::string doing;
  Watched watching = watched;
  watching.progress = [&](const std::string& what, double share) {
    doing = what;
    if (watched.progress) watched.progress(what, share);
  };
  while (true) {
    const std::vector<std::string> left = steps_without(*made.plan, wanted, made.errors);
    try {
      Plan plan = *made.plan;
      if (left.empty()) plan.steps.clear();
      made.evaluation = std::make_shared<const Evaluation>(evaluate(plan, left, certify, watching));
      break;
    } catch (const std::exception& error) {
      if (fault_of(error) == Fault::Cancelled) throw;
      // The text of the progress ends in the id of the step that is evaluated, after its verb.
      const std::string id = doing.substr(doing.find(' ') + 1);
      const auto& all = made.plan->steps;
      const bool is_step =
          std::any_of(all.begin(), all.end(), [&](const Step& step) { return step.id == id; });
      if (!is_step || !made.errors.emplace(id, message_of(error)).second) throw;
    }
  }
  made.measurements = measurements_of(*made.plan, *made.evaluation, made.errors);
  if (certify)
    keep_certified(*made.plan, *made.evaluation, made.measurements);
  else
    put_certified(*made.plan, made.measurements);
  made.bone_lows = bone_lows_of(*made.evaluation);
  const std::lock_guard lock(mutex_);
  // A result of another document is not shown, nor are certificates of an earlier state of the plan.
  const bool is_present = document_ && opened == opened_ && (!certify || document_->plan() == made.plan);
  if (is_present && (!certify || steps.empty())) snapshot_ = made;
  return made;
}

std::map<std::string, double> Session::bone_lows_of(const Evaluation& evaluation) {
  std::map<std::string, double> lows;
  const std::lock_guard lock(bone_mutex_);
  for (const auto& [name, loaded] : evaluation.loaded) {
    if (!loaded) continue;
    auto& [of, low] = bone_lows_[name];
    if (of.lock() != loaded->shared) {
      of = loaded->shared;
      low = planner::serve::bone_low(*loaded->shared);
    }
    lows[name] = low;
  }
  return lows;
}

void Session::put_certified(const Plan& plan, Json& measurements) const {
  const std::lock_guard lock(mutex_);
  if (certified_.empty() || measurements.empty()) return;
  const std::map<std::string, std::string> keys = keys_of(plan);
  for (Json& measurement : measurements) {
    const auto id = measurement.at("id").get<std::string>();
    const auto known = certified_.find(id);
    if (known != certified_.end() && known->second.key == keys.at(id)) measurement = known->second.said;
  }
}

void Session::keep_certified(const Plan& plan, const Evaluation& evaluation, const Json& measurements) {
  Json measures = Json::array();
  for (const Object& object : evaluation.objects)
    if (!object.is_tool && !object.voxel.octree.is_empty())
      measures.push_back({{"id", size_step_prefix + object.id}, {"do", "measure"}, {"object", object.id}});
  Json whole = Json::parse(plan.text);
  for (const Json& step : measures) whole["steps"].push_back(step);
  Plan measuring = parse_plan(whole.dump(), plan.folder);
  std::erase_if(measuring.steps, [](const Step& step) { return !step.id.starts_with(size_step_prefix); });
  const std::map<std::string, std::string> keys = keys_of(plan);
  std::map<std::string, Certified> found;
  for (const Object& object : evaluation.objects) {
    found[object.id] = {keys.at(object.id), Json::object()};
    if (object.certificate) found[object.id].said["certificate"] = certificate_json(*object.certificate);
    if (Json necks = necks_json(object); !necks.is_null()) found[object.id].said["necks"] = std::move(necks);
  }
  for (const Json& measured : measurements_json(measuring, evaluation))
    for (const char* size : {"volume", "area"}) found[measured.at("object")].said[size] = measured.at(size);
  for (const Json& measurement : measurements) {
    const auto id = measurement.at("id").get<std::string>();
    if (!found.contains(id) && keys.contains(id)) found[id] = {keys.at(id), measurement};
  }
  const std::lock_guard lock(mutex_);
  for (auto& [id, said] : found) certified_[id] = std::move(said);
}

Snapshot Session::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

voxel::GreyOctree Session::alone(const Snapshot& snapshot, const std::string& scan) {
  const auto loaded = snapshot.evaluation->loaded.find(scan);
  if (loaded == snapshot.evaluation->loaded.end())
    throw voxel::Error(voxel::ErrorCode::Input, "there is no scan '" + scan + "'");
  const auto& [shared, grey] = *loaded->second;
  const std::lock_guard lock(alone_mutex_);
  if (!alone_ || alone_->first != shared)
    alone_.emplace(shared, voxel::grey_octree_of(universe_of(*shared, snapshot.plan->voxel_mm), *shared,
                                                 grey.background())
                               .with_scan(shared));
  return alone_->second;
}

namespace {

/// The voxel size of previews during a drag, in mm. It is the plan's size (none: derived from the scan) or,
/// in a large universe, the size that leaves 256 voxels along a side, so that each picture is computed in
/// time.
std::optional<double> coarse_voxel_mm(const Snapshot& snapshot, const Plan& plan) {
  constexpr int most_side = 256;
  if (!snapshot.evaluation) return plan.voxel_mm;
  const voxel::Universe& universe = snapshot.evaluation->universe;
  if (universe.side() <= most_side) return plan.voxel_mm;
  return universe.lattice().spacing_mm().x * universe.side() / most_side;
}

}  // namespace

const Object* Session::Preview::object() const {
  if (!evaluation) return nullptr;
  for (const Object& each : evaluation->objects)
    if (each.id == moved) return &each;
  return nullptr;
}

void Session::describe(const Preview& preview, Json& header) {
  const Object* object = preview.object();
  if (object == nullptr) return;
  header["preview"] = {{"mm3", object->voxel.measures.volume_mm3},
                       {"voxels", object->voxel.octree.voxel_count()},
                       {"findings", object->findings}};
}

Session::Preview Session::preview(const Json& asked, const std::vector<std::string>& with,
                                  const std::stop_token& stop) {
  Json steps = asked.value("steps", Json::array());
  std::string moved;
  if (steps.empty()) {
    moved = asked.contains("of") ? asked["of"] : asked.at("object");
    steps.push_back(asked.at("move"));
    steps.back()["do"] = "move";
    steps.back()["object"] = moved;
  }
  steps.back()["id"] = Preview::moved;
  std::vector<std::string> wanted{Preview::moved};
  const auto combine = [&](const char* id, const std::string& expression) {
    steps.push_back({{"id", id}, {"do", "combine"}, {"expression", expression}});
    wanted.emplace_back(id);
  };
  const std::string here = Preview::moved;
  if (const std::string other = asked.value("difference", ""); !other.empty()) {
    combine(Preview::only_moved, here + " - " + other);
    combine(Preview::only_other, other + " - " + here);
    combine(Preview::common, here + " & " + other);
  } else {
    std::string others;
    for (const std::string& name : with)
      if (name != moved) others += (others.empty() ? "" : " | ") + name;
    if (!others.empty()) combine(Preview::overlap, here + " & (" + others + ")");
  }
  const std::lock_guard lock(preview_mutex_);
  Plan plan = with_document([&](const Document& document) { return document.with_steps(steps); });
  if (asked.value("coarse", false)) plan.voxel_mm = coarse_voxel_mm(snapshot(), plan);
  const std::string key = plan.text + (plan.voxel_mm ? exact(*plan.voxel_mm) : "");
  for (const auto& [text, made] : previews_)
    if (text == key) return made;
  Preview made{std::make_shared<const Evaluation>(evaluate(plan, wanted, false, {stop, {}}, true))};
  constexpr std::size_t most_previews = 4;
  previews_.emplace_back(key, made);
  if (previews_.size() > most_previews) previews_.pop_front();
  return made;
}

Json Session::object_json(const Snapshot& snapshot, const std::string& id) const {
  ObjectState state;
  state.id = id;
  if (const auto failed = snapshot.errors.find(id); failed != snapshot.errors.end())
    state.error = failed->second;
  if (snapshot.evaluation)
    for (const Object& object : snapshot.evaluation->objects)
      if (object.id == id) add(object, state);
  return print_record(state);
}

Json Session::objects_json(const Plan& plan) const {
  Json list = Json::array();
  std::map<std::string, std::string> keys;
  if (!certified_.empty()) keys = keys_of(plan);
  std::size_t number = 0;
  for (const Step& step : plan.steps) {
    if (!makes_object(step)) continue;
    const Operation& operation = step.action.operation();
    Json json = object_json(snapshot_, step.id);
    json.update({{"kind", operation.is_tool ? "mask" : operation.name},
                 {"colour", text_of_colour(colour_of(number++))}});
    const auto known = certified_.find(step.id);
    if (known != certified_.end() && known->second.key == keys[step.id]) json.update(known->second.said);
    list.push_back(std::move(json));
  }
  return list;
}

Json Session::state() const {
  const std::lock_guard lock(mutex_);
  if (document_ == nullptr) return nullptr;
  const Plan& plan = *document_->plan();
  Json json{{"path", document_->path().string()}, {"name", plan.name}, {"dirty", false}};
  json.update(document_->history_json());
  Json scans = Json::array(), landmarks = Json::array(), universe;
  if (snapshot_.evaluation) {
    for (const ScanRecord& scan : snapshot_.evaluation->scans) {
      const auto low = snapshot_.bone_lows.find(scan.name);
      scans.push_back(scan_json(scan));
      scans.back().update(
          {{"bone_low", low != snapshot_.bone_lows.end() ? low->second : *voxel::tissue("bone")->low}});
    }
    const voxel::Lattice lattice = snapshot_.evaluation->universe.lattice();
    universe = {{"voxel_mm", lattice.spacing_mm().x},
                {"voxels", lattice.dims.x},
                {"bounds_mm", box_json(voxel::bounds(lattice))}};
  }
  for (const NamedPoint& landmark : plan.landmarks)
    landmarks.push_back({{"name", landmark.name}, {"point", planner::to_json(landmark.p_mm)}});
  json.update({{"plan", Json::parse(plan.text)},
               {"scans", scans},
               {"objects", objects_json(plan)},
               {"landmarks", landmarks},
               {"measurements", snapshot_.measurements},
               {"universe", universe}});
  return json;
}

}  // namespace octotomy::planner::serve
