// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/object_requests.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "brep/io/read_mesh.h"
#include "planner/browser/server/measurement_message.h"
#include "planner/browser/server/new_files.h"
#include "planner/browser/server/pane_fields.h"
#include "planner/operation/anatomy/movement.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/plan/dependence.h"
#include "planner/plan/plan_results.h"
#include "planner/result/outcome/outcome.h"
#include "planner/result/report/report.h"
#include "voxel/filter/components.h"
#include "voxel/measure/measure.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

constexpr const char* asked_step = "asked_of_the_page";

/// A landmark snaps to bone if bone is at most this far from the clicked point.
constexpr double snap_mm = 8.0;

[[noreturn]] void refuse(const std::string& why) {
  throw voxel::Error(voxel::ErrorCode::Input, why);
}

/// Evaluates a measuring step as if it stood at the end of the plan, and returns its result. A step without
/// "do" is a measure step.
Json measured(Session& session, Json step, const std::vector<std::string>& needed, bool certify,
              const Watched& watched) {
  step["id"] = asked_step;
  if (!step.contains("do")) step["do"] = "measure";
  const Plan plan = session.with_document(
      [&](const Document& document) { return document.with_steps(Json::array({step})); });
  std::vector<std::string> wanted = needed;
  Plan alone = plan;
  // If no objects are needed, evaluates only the step itself.
  if (wanted.empty())
    alone.steps = {plan.steps.back()};
  else
    std::erase_if(alone.steps, [&](const Step& each) {
      return each.action.operation().makes == Makes::Measurement && each.id != asked_step;
    });
  if (wanted.empty()) wanted = {asked_step};
  const Evaluation evaluation = session.evaluate(alone, wanted, certify, watched);
  alone.steps = {plan.steps.back()};
  return measurements_json(alone, evaluation).front();
}

std::vector<std::string> names_of(const Json& value) {
  if (value.is_string()) return {value.get<std::string>()};
  return value.get<std::vector<std::string>>();
}

/// Points in which names of landmarks are replaced by the landmarks' positions.
Json points_mm(const Json& points, const Plan& plan) {
  Json typed = Json::array();
  for (const Json& point : points) {
    const auto known =
        std::find_if(plan.landmarks.begin(), plan.landmarks.end(),
                     [&](const NamedPoint& landmark) { return point.is_string() && landmark.name == point; });
    if (point.is_string() && known == plan.landmarks.end())
      refuse("there is no landmark '" + point.get<std::string>() + "'");
    typed.push_back(point.is_string() ? planner::to_json(known->p_mm) : point);
  }
  return typed;
}

/// The centre of the voxel face nearest to a point, on the surface of the object `only`, or of every object
/// that is no tool if `only` is empty. None if there is no face within snap_mm.
std::optional<glm::dvec3> snapped(const Evaluation& evaluation, const glm::dvec3& p_mm,
                                  const std::string& only) {
  const voxel::Lattice lattice = evaluation.universe.lattice();
  const double voxel_mm = lattice.spacing_mm().x;
  const glm::ivec3 middle(glm::round(lattice.voxel(p_mm)));
  const int reach = static_cast<int>(std::ceil(snap_mm / voxel_mm));
  std::optional<glm::dvec3> best;
  double best_mm = snap_mm;
  for (const Object& object : evaluation.objects) {
    if (object.is_tool || (!only.empty() && object.id != only)) continue;
    const voxel::Octree& octree = object.voxel.octree;
    const auto is_in = [&](const glm::ivec3& at) {
      return glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) &&
             glm::all(glm::lessThan(at, lattice.dims)) && octree.contains(at);
    };
    for (int z = -reach; z <= reach; ++z)
      for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
          const glm::ivec3 at = middle + glm::ivec3(x, y, z);
          const glm::dvec3 centre = lattice.lps_mm(at);
          if (glm::distance(centre, p_mm) >= best_mm || !is_in(at)) continue;
          for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) {
              glm::ivec3 next = at;
              next[axis] += side;
              if (is_in(next)) continue;
              glm::dvec3 face = at;
              face[axis] += 0.5 * side;
              const glm::dvec3 on_face = lattice.lps_mm(face);
              if (glm::distance(on_face, p_mm) >= best_mm) continue;
              best_mm = glm::distance(on_face, p_mm);
              best = on_face;
            }
        }
  }
  return best;
}

}  // namespace

fs::path files_folder(const Session& session) {
  const fs::path plan = session.with_document([](const Document& document) { return document.path(); });
  return plan.parent_path() / (plain_stem(plan) + " files");
}

Json measure(Session& session, const Json& said, const Watched& watched) {
  const std::string kind = said.at("kind");
  if (kind == "volume" || kind == "area") {
    const std::string object = said.at("object");
    const Json json = measured(session, {{"object", object}}, {object}, true, watched);
    const Json& number = json.at(kind);
    return number_message(number.at("value"), number.at("unit"), number.at("half_width"),
                          (kind == "volume" ? "Volume of " : "Surface area of ") + object);
  }
  const Json& points = said.at("points");
  if (kind == "surface_distance") {
    const std::string object = said.at("object");
    const Json typed =
        session.with_document([&](const Document& document) { return points_mm(points, *document.plan()); });
    return measurement_message(
        measured(session, {{"object", object}, {"along", typed}}, {object}, true, watched));
  }
  if (kind != "distance" && kind != "angle")
    refuse("kind: must be distance, angle, surface_distance, volume or area");
  // A landmark that is attached to an object moves with it, so the object must be evaluated.
  std::vector<std::string> needed;
  for (const Json& point : points) {
    if (!point.is_string()) continue;
    const std::string name = point;
    if (const auto at = name.find('@'); at != std::string::npos) needed.push_back(name.substr(at + 1));
  }
  return measurement_message(measured(session, {{"points_mm", points}}, needed, false, watched));
}

Json certify(Session& session, const Json& said, const Watched& watched) {
  const std::string id = said.at("object");
  const Snapshot made = session.evaluate({id}, true, watched);
  if (const auto failed = made.errors.find(id); failed != made.errors.end()) refuse(failed->second);
  const Json json = session.object_json(made, id);
  if (!json.contains("certificate"))
    return {{"verdict", nullptr},
            {"sentence",
             json.value("findings", Json::array()).empty()
                 ? "There is no certificate: '" + id + "' is a tool, which only helps to make other objects."
                 : json["findings"].front().get<std::string>()},
            {"place", nullptr},
            {"detection_limit", nullptr},
            {"rows", Json::array()}};
  const Json& certificate = json["certificate"];
  return {{"verdict", certificate.at("verdict")},  {"sentence", certificate.at("sentence")},
          {"place", certificate.at("place")},      {"detection_limit", certificate.at("detection_limit")},
          {"rows", certificate.at("comparisons")}, {"certificate", certificate}};
}

Json overlap(Session& session, const Json& said, const Watched& watched) {
  const Session::Preview preview = session.preview(said, names_of(said.at("with")), watched.stop);
  for (const Object& object : preview.evaluation->objects)
    if (object.id == Session::Preview::overlap) return {{"mm3", object.voxel.measures.volume_mm3}};
  refuse("with: name at least one other object");
}

namespace {

/// The part of an object at a point: a voxel of the part, and the part's octree. The part is that of the
/// object's voxel nearest to the point. The returned voxel lies below the part's surface if such a voxel is
/// near. None if no voxel of the object is near the point.
std::optional<std::pair<glm::ivec3, voxel::Octree>> part_near(const voxel::Octree& whole,
                                                              const glm::dvec3& p_mm) {
  constexpr int reach = 2;
  static const std::array<glm::ivec3, 6> faces{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  const glm::dvec3 p = whole.universe().lattice().voxel(p_mm);
  const int side = whole.universe().side();
  const auto holds = [&](const voxel::Octree& part, const glm::ivec3& at) {
    return glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) &&
           glm::all(glm::lessThan(at, glm::ivec3(side))) && part.contains(at);
  };
  const auto nearest = [&](const voxel::Octree& part, bool is_deep) {
    std::optional<glm::ivec3> found;
    double least = std::numeric_limits<double>::infinity();
    for (int z = -reach; z <= reach; ++z)
      for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
          const glm::ivec3 at = glm::ivec3(glm::round(p)) + glm::ivec3(x, y, z);
          const double distance = glm::length(glm::dvec3(at) - p);
          if (distance >= least || !holds(part, at)) continue;
          if (is_deep && !std::all_of(faces.begin(), faces.end(),
                                      [&](const glm::ivec3& face) { return holds(part, at + face); }))
            continue;
          least = distance;
          found = at;
        }
    return found;
  };
  const double most = 2.0 * side;  // rounded to an integer below
  if (!glm::all(glm::lessThan(glm::abs(p), glm::dvec3(most)))) return {};
  const std::optional<glm::ivec3> seed = nearest(whole, false);
  if (!seed) return {};
  voxel::Octree part = voxel::components_at(whole, {*seed});
  const glm::ivec3 deep = nearest(part, true).value_or(*seed);
  return std::pair{deep, std::move(part)};
}

}  // namespace

Json part(Session& session, const Json& said, const Watched&) {
  const std::string id = said.at("object");
  const auto near_mm = point_of(said, "near_mm");
  const Snapshot snapshot = session.snapshot();
  if (snapshot.evaluation)
    for (const Object& object : snapshot.evaluation->objects) {
      if (object.id != id) continue;
      const voxel::Octree& whole = object.voxel.octree;
      const voxel::Components parts = voxel::components(whole);
      Json told{{"parts", parts.voxel_counts.size()}, {"whole_mm3", object.voxel.measures.volume_mm3}};
      if (near_mm) {
        const auto near = part_near(whole, *near_mm);
        if (!near) refuse("no part of '" + id + "' lies there: click on one of its parts");
        told.update(
            {{"mm3", voxel::measure(near->second).volume_mm3},
             {"at_mm", planner::to_json(whole.universe().lattice().lps_mm(glm::dvec3(near->first)))}});
        return told;
      }
      const voxel::Measures largest = voxel::measure(parts.largest);
      told.update({{"mm3", largest.volume_mm3},
                   {"at_mm", largest.centroid_mm ? planner::to_json(*largest.centroid_mm) : Json(nullptr)}});
      return told;
    }
  refuse("'" + id + "' is not evaluated yet");
}

Json try_steps(Session& session, const Json& said, const Watched& watched) {
  const Json& steps = said.at("steps");
  std::vector<std::string> wanted;
  for (const Json& step : steps) wanted.push_back(step.at("id"));
  if (wanted.empty()) refuse("steps: name at least one step");
  const Evaluation made = session.evaluate(
      session.with_document([&](const Document& document) { return document.with_steps(steps); }), wanted,
      false, watched);
  const auto is_wanted = [&](const std::string& id) {
    return std::find(wanted.begin(), wanted.end(), id) != wanted.end();
  };
  Json objects = Json::array(), scans = Json::array();
  for (const Object& object : made.objects)
    if (is_wanted(object.id))
      objects.push_back({{"id", object.id}, {"mm3", object.voxel.measures.volume_mm3}});
  for (const ScanRecord& scan : made.scans) {
    if (!is_wanted(scan.name)) continue;
    Json findings = Json::array();
    for (const voxel::Finding& finding : scan.audit)
      if (scan.made_by.starts_with(finding.check + " of ")) findings.push_back(finding.detail);
    scans.push_back({{"id", scan.name}, {"details", scan.details}, {"findings", findings}});
  }
  return {{"objects", objects}, {"scans", scans}};
}

Json movement(Session& session, const Json& said, const Watched&) {
  const Snapshot snapshot = session.snapshot();
  if (!snapshot.evaluation) refuse("nothing is evaluated yet");
  const std::string id = said.value("object", "");
  Json rows = Json::array();
  for (const Json& row : movements_json(snapshot.evaluation->objects, snapshot.plan->landmarks))
    if (id.empty() || row.value("object", "") == id) rows.push_back(row);
  return {{"rows", rows}};
}

Json mesh_audit(Session& session, const Json& said, const Watched&) {
  const fs::path folder =
      session.with_document([](const Document& document) { return document.path().parent_path(); });
  const fs::path path = session.folders.need_readable(folder / said.at("path").get<std::string>());
  const auto word = [&](const char* name) -> std::optional<std::string> {
    if (!said.contains(name) || said[name].is_null()) return std::nullopt;
    return said[name].get<std::string>();
  };
  brep::MeshFile file = brep::read_mesh(path, {word("frame"), word("unit")});
  const Json scans = session.state().at("scans");
  if (!scans.empty()) {
    const auto bounds = scans.front().at("bounds_mm").get<std::array<std::array<double, 3>, 2>>();
    const auto corner = [&](std::size_t i) { return glm::dvec3(bounds[i][0], bounds[i][1], bounds[i][2]); };
    for (const brep::MeshFinding& finding :
         brep::findings_beside(file.extent(), {corner(0), corner(1)}, "the scan"))
      file.audit.push_back(finding);
  }
  Json audit = planner::to_json(file.audit);
  for (Json& line : audit) line["sentence"] = line.value("detail", "");
  return {{"audit", audit}};
}

Json place_landmark(Session& session, const Json& said, const Watched&) {
  const std::string name = said.at("name");
  const auto asked = point_of(said, "point");
  if (!asked) refuse("point: is missing");
  std::optional<glm::dvec3> on_bone;
  const Snapshot snapshot = session.snapshot();
  if (said.value("snap", false) && snapshot.evaluation)
    on_bone = snapped(*snapshot.evaluation, *asked, said.value("object", ""));
  glm::dvec3 p_mm = on_bone.value_or(*asked);
  for (int axis = 0; axis < 3; ++axis) p_mm[axis] = std::round(p_mm[axis] * 1e4) / 1e4;
  session.with_document([&](Document& document) { document.place_landmark(name, planner::to_json(p_mm)); });
  return {{"point", planner::to_json(p_mm)}, {"snapped", on_bone.has_value()}};
}

Json find_landmarks(Session& session, const Json& said, const Watched& watched) {
  const std::string object = said.at("object");
  return measured(session, {{"do", "find_landmarks"}, {"object", object}}, {object}, true, watched);
}

Json export_file(Session& session, const Json& said, const Watched& watched) {
  const std::string object = said.at("object");
  const std::string kind = said.value("kind", "stl");
  const fs::path folder = files_folder(session);
  const fs::path asked =
      need_plain_name(said.contains("path") ? said["path"].get<std::string>() : object + "." + kind);
  const fs::path path = session.folders.need_within(unused_export(folder / asked));
  const Json step{
      {"id", asked_step}, {"do", "export"}, {"object", object}, {"path", path.filename().string()}};
  Plan plan = session.with_document(
      [&](const Document& document) { return document.with_steps(Json::array({step})); });
  const Step last = plan.steps.back();
  plan.steps.pop_back();
  const Evaluation evaluation = session.evaluate(plan, {object}, true, watched);
  plan.steps.push_back(last);
  Timings timings;
  std::map<std::string, std::shared_ptr<const void>> kept;
  NewFiles files(path.parent_path());
  const Exported exported =
      write_file(plan, evaluation, last, files.hidden(), timings, kept, {watched.stop, watched.progress});
  if (!exported.written)
    throw voxel::Error(voxel::ErrorCode::Geometry,
                       exported.findings.empty() ? object + " was not written" : exported.findings.front());
  files.commit(path.filename());
  return {{"file", fs::relative(path, folder).generic_string()},
          {"path", path.string()},
          {"content", exported.content},
          {"findings", exported.findings}};
}

namespace {

/// The plan of a snapshot without the steps that failed and without those that need them. Adds a finding for
/// each.
Plan with_answers(const Snapshot& made, std::vector<voxel::Finding>& findings) {
  Plan plan = *made.plan;
  std::erase_if(plan.steps, [&](const Step& step) {
    const std::set<std::string> needed = needed_for(*made.plan, {step.id});
    const auto failed = std::find_if(made.errors.begin(), made.errors.end(),
                                     [&](const auto& each) { return needed.contains(each.first); });
    if (failed == made.errors.end()) return false;
    const bool is_own = made.errors.contains(step.id);
    findings.push_back(
        {"step", voxel::Verdict::Fail,
         is_own ? "'" + step.id + "' is left out, because it failed: " + made.errors.at(step.id)
                : "'" + step.id + "' is left out, because it needs '" + failed->first + "', which failed"});
    return true;
  });
  return plan;
}

}  // namespace

Json report(Session& session, const Json& said, const Watched& watched) {
  const fs::path folder = session.folders.need_within(unused(files_folder(session) / "report"));
  const Snapshot made = session.evaluate({}, true, watched);
  Result result;
  result.plan = with_answers(made, result.findings);
  result.evaluation = *made.evaluation;
  result.anonymous = said.value("anonymous", false);
  result.pictures = plan_pictures(result.plan, result.evaluation);
  // Only the parent is created here: write_result() creates the folder when all files are complete.
  fs::create_directories(folder.parent_path());
  write_result(result, folder, {watched.stop, watched.progress, true});
  Json left_out = Json::array();
  for (const Step& step : made.plan->steps)
    if (std::none_of(result.plan.steps.begin(), result.plan.steps.end(),
                     [&](const Step& kept) { return kept.id == step.id; }))
      left_out.push_back(step.id);
  for (const Exported& exported : result.exported)
    if (!exported.written) left_out.push_back(exported.id);
  return {{"folder", folder.string()},
          {"file", folder.filename().string() + "/report.html"},
          {"counts", counts_json(result)},
          {"left_out", left_out}};
}

Json outcome(Session& session, const Json& said, const Watched& watched) {
  const fs::path path = session.folders.need_within(said.at("path").get<std::string>());
  need_readable_samples(session.folders, path);
  const Snapshot made = session.evaluate({}, true, watched);
  std::vector<voxel::Finding> left_out;
  const Plan plan = with_answers(made, left_out);
  const Evaluation& before = *made.evaluation;
  const voxel::Progress progress{watched.stop, [&](double share) {
                                   if (watched.progress) watched.progress("pieces on the later scan", share);
                                 }};
  voxel::ReadOptions reading;
  reading.progress = progress;
  OutcomeOptions options;
  options.low = number_of(said, "low");
  options.unmoved = said.value("unmoved", "");
  options.progress = progress;
  Json json = planner::to_json(outcome_of(plan, before, voxel::read_scene(path, reading), options));
  for (const voxel::Finding& finding : left_out) json["unmoved"]["findings"].push_back(finding.detail);
  json["path"] = path.string();
  return json;
}

namespace {

/// A text as one quoted word of a POSIX shell.
std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char symbol : text) {
    if (symbol == '\'')
      safe += "'\\''";
    else
      safe += symbol;
  }
  return safe + "'";
}

/// The plan of one step: with the steps on which it depends, landmarks and head position, and with the step
/// that determines the voxels.
Json plan_to(const std::string& id, const Plan& plan) {
  std::set<std::string> kept = needed_for(plan, {id});
  bool has_first_scan = false;
  for (const Step& step : plan.steps) {
    const std::string& word = verb(step);
    if (word == "landmarks" || word == "head_position") kept.insert(step.id);
    // The first scan that a step uses determines the voxels, so that step is kept.
    if (!has_first_scan && !scans_used(step.action).empty()) {
      kept.insert(step.id);
      has_first_scan = true;
    }
  }
  Json json = Json::parse(plan.text);
  for (auto& [name, scan] : json.at("scans").items())
    scan["path"] = scan_path(plan, plan.scans.at(name)).string();
  Json& steps = json.at("steps");
  for (std::size_t i = steps.size(); i-- > 0;)
    if (!kept.contains(steps[i].at("id").get<std::string>())) steps.erase(i);
  return json;
}

/// A JSON value as a Python expression.
std::string python_of(const Json& value) {
  if (value.is_null()) return "None";
  if (value.is_boolean()) return value.get<bool>() ? "True" : "False";
  if (value.is_array()) {
    std::string text;
    for (const Json& part : value) text += (text.empty() ? "" : ", ") + python_of(part);
    return "[" + text + "]";
  }
  if (!value.is_object()) return value.dump();
  std::string text;
  for (const auto& [key, part] : value.items())
    text += (text.empty() ? "" : ", ") + Json(key).dump() + ": " + python_of(part);
  return "{" + text + "}";
}

}  // namespace

Json command_of_step(Session& session, const Json& said, const Watched&) {
  const std::string id = said.at("step");
  return session.with_document([&](const Document& document) -> Json {
    const Json whole = document.json();
    for (const Json& step : whole.at("steps")) {
      if (step.value("id", "") != id) continue;
      std::string call = "plan." + step.value("do", "") + "(" + Json(id).dump();
      for (const auto& [key, value] : step.items())
        if (key != "id" && key != "do") call += ", " + key + "=" + python_of(value);
      const std::string folder = document.path().parent_path().string(),
                        name = quoted(id + ".step.plan.json");
      return {{"shell", "cd " + quoted(folder) + " &&\ncat > " + name + " <<'PLAN' &&\n" +
                            json_text(plan_to(id, *document.plan()), 2) + "\nPLAN\noctotomy run " + name +
                            " -o " + quoted(id + " result") + "\n"},
              {"python", call + ")"}};
    }
    refuse("the plan has no step '" + id + "'");
  });
}

}  // namespace octotomy::planner::serve
