// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/slicer/scene_markups.h"

#include <cmath>
#include <optional>

#include "planner/operation/file/slicer_markup.h"
#include "planner/operation/object/mask.h"
#include "planner/operation/object/saw.h"
#include "planner/operation/part/screw.h"
#include "planner/operation/table/deformation.h"
#include "voxel/space/lattice.h"
#include "voxel/space/view.h"

namespace octotomy::planner {
namespace {

using Json = nlohmann::ordered_json;
using Points = std::vector<glm::dvec3>;

Json numbers(const glm::dvec3& v) {
  // Adding 0.0 makes a negative zero positive.
  return {v.x + 0.0, v.y + 0.0, v.z + 0.0};
}

Json control_point(std::size_t number, const std::string& label, const glm::dvec3& p_mm) {
  return {{"id", std::to_string(number)},
          {"label", label},
          {"position", numbers(p_mm)},
          {"selected", true},
          {"locked", false},
          {"visibility", true},
          {"positionStatus", "defined"}};
}

/// Makes a markup. `more` are members that only its type has.
SceneMarkup markup(const std::string& type, const std::string& name, Json points,
                   const Json& more = Json::object()) {
  Json list{{"type", type}, {"coordinateSystem", "LPS"}, {"coordinateUnits", "mm"}, {"labelFormat", "%N-%d"}};
  list.update(more);
  list["controlPoints"] = std::move(points);
  return {
      type,
      name,
      {{"@schema",
        "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
        "markups-schema-v1.0.3.json#"},
       {"markups", {std::move(list)}}}};
}

SceneMarkup markup_of_points(const std::string& type, const std::string& name, const Points& points_mm) {
  Json points = Json::array();
  for (const glm::dvec3& p_mm : points_mm)
    points.push_back(control_point(points.size() + 1, name + "-" + std::to_string(points.size() + 1), p_mm));
  return markup(type, name, std::move(points));
}

/// A plane as a markup. Slicer reads the control point, the axes in baseToNode and the bounds; other readers
/// may need centre, normal and orientation.
SceneMarkup markup_of_plane(const std::string& name, const MarkupPlane& plane) {
  const glm::dvec3 &x = plane.right, &y = plane.up, &z = plane.normal, &o = plane.origin_mm;
  const glm::dvec2 low = *plane.low_mm, high = *plane.high_mm;
  Json orientation = Json::array(), base = Json::array();
  for (int row = 0; row < 3; ++row)
    for (const double number : {x[row], y[row], z[row]}) orientation.push_back(number + 0.0);
  for (int row = 0; row < 3; ++row)
    for (const double number : {x[row], y[row], z[row], o[row]}) base.push_back(number + 0.0);
  for (const double number : {0.0, 0.0, 0.0, 1.0}) base.push_back(number);
  return markup("Plane", name, {control_point(1, name, o)},
                {{"planeType", "pointNormal"},
                 {"sizeMode", "absolute"},
                 {"center", numbers(o)},
                 {"normal", numbers(z)},
                 {"baseToNode", base},
                 {"orientation", orientation},
                 {"size", {high.x - low.x, high.y - low.y, 0.0}},
                 {"planeBounds", {low.x, high.x, low.y, high.y}}});
}

void add_saw(const std::string& id, const Saw& saw, std::vector<SceneMarkup>& made) {
  const glm::dvec3 along = glm::normalize(*saw.direction);
  double entry_mm = glm::dot(saw.line_mm.front(), along);
  for (const glm::dvec3& p_mm : saw.line_mm) entry_mm = std::min(entry_mm, glm::dot(p_mm, along));
  const std::size_t pieces = saw.line_mm.size() - 1;
  for (std::size_t i = 0; i < pieces; ++i) {
    const auto at_entry = [&](const glm::dvec3& p_mm) {
      return p_mm + (entry_mm - glm::dot(p_mm, along)) * along;
    };
    const glm::dvec3 from_mm = at_entry(saw.line_mm[i]), to_mm = at_entry(saw.line_mm[i + 1]);
    // A piece of the line that is parallel to the blade cuts nothing.
    if (!(glm::distance(from_mm, to_mm) > 0.0)) continue;
    MarkupPlane plane;
    plane.origin_mm = 0.5 * (from_mm + to_mm) + 0.5 * saw.depth_mm * along;
    plane.up = along;
    plane.right = glm::normalize(to_mm - from_mm);
    plane.normal = glm::cross(plane.right, plane.up);
    plane.high_mm = 0.5 * glm::dvec2(glm::distance(from_mm, to_mm), saw.depth_mm);
    plane.low_mm = -*plane.high_mm;
    made.push_back(
        markup_of_plane(pieces == 1 ? id + " plane" : id + " plane " + std::to_string(i + 1), plane));
  }
  if (pieces > 1) made.push_back(markup_of_points("Curve", id + " line", saw.line_mm));
}

/// Twice the signed area of a polygon; positive if it is counter-clockwise.
double signed_area(const std::vector<glm::dvec2>& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum;
}

void add_sides(const std::string& name, const std::vector<glm::dvec2>& polygon, const Points& corners_mm,
               const glm::dvec3& look, double reach_mm, std::vector<SceneMarkup>& made) {
  if (polygon.size() > most_sides) return;
  const double turn = signed_area(polygon) > 0.0 ? 1.0 : -1.0;
  int number = 0;
  for (std::size_t i = 0; i < corners_mm.size(); ++i) {
    const glm::dvec3 &a = corners_mm[i], &b = corners_mm[(i + 1) % corners_mm.size()];
    if (!(glm::distance(a, b) > 0.0)) continue;
    MarkupPlane plane;
    plane.origin_mm = 0.5 * (a + b);
    plane.right = glm::normalize(b - a);
    // right x up of a view points to the observer, against `look`.
    plane.normal = turn * glm::cross(plane.right, look);
    plane.up = glm::cross(plane.normal, plane.right);
    plane.high_mm = glm::dvec2(0.5 * glm::distance(a, b), reach_mm);
    plane.low_mm = -*plane.high_mm;
    made.push_back(markup_of_plane(name + " side " + std::to_string(++number), plane));
  }
}

void add_mask(const std::string& id, const Mask& mask, const Evaluation& evaluation,
              std::vector<SceneMarkup>& made) {
  const voxel::Box room = voxel::bounds(evaluation.universe.lattice());
  const glm::dvec3 middle_mm = 0.5 * (room.low_mm + room.high_mm);
  const double reach_mm = 0.5 * glm::distance(room.low_mm, room.high_mm);
  const glm::dmat3 turned = mask.views_of == "head" ? evaluation.objects.lps_from_head : glm::dmat3(1.0);
  for (const Mask::Region& region : mask.regions) {
    voxel::View view = voxel::parse_view(region.view);
    view = {turned * view.look, turned * view.up, turned * view.right};
    int number = 0;
    for (const std::vector<glm::dvec2>& polygon : region.polygons_mm) {
      const std::string name =
          id + " " + region.view + (region.polygons_mm.size() == 1 ? "" : " " + std::to_string(++number));
      Points corners_mm;
      for (const glm::dvec2& p_mm : polygon)
        corners_mm.push_back(p_mm.x * view.right + p_mm.y * view.up +
                             glm::dot(middle_mm, view.look) * view.look);
      made.push_back(markup_of_points("ClosedCurve", name, corners_mm));
      add_sides(name, polygon, corners_mm, view.look, reach_mm, made);
    }
  }
}

/// Adds a line for the axis of each screw, at the position of its object.
void add_screws(const Plan& plan, const Evaluation& evaluation, std::vector<SceneMarkup>& made) {
  const auto maker_of = [&](const std::string& name) -> const Action* {
    for (const Step& step : plan.steps)
      if (step.id == name) return &step.action;
    return nullptr;
  };
  const Scans no_scans = [](const std::string& name) -> const LoadedScan& {
    throw std::runtime_error("'" + name + "': an axis needs no scan");
  };
  Timings timings;
  Json details;
  std::vector<std::string> findings;
  const SettleBench bench{evaluation.objects, no_scans, timings,  {},
                          plan.folder,        details,  findings, maker_of};
  for (const Object& object : evaluation.objects) {
    const Action* maker = maker_of(still_of(evaluation.objects, object).id);
    if (maker == nullptr || maker->get_if<Screw>() == nullptr) continue;
    // A scaled screw no longer has its stated axis and length, so only its model is written.
    if (object.image && !keeps_lengths(object.image->image_from_object)) continue;
    const ScrewAxis axis = screw_axis(object.id, bench);
    made.push_back(markup_of_points("Line", object.id + " axis",
                                    {axis.head_mm, axis.head_mm + axis.length_mm * axis.along}));
  }
}

}  // namespace

std::vector<SceneMarkup> scene_markups(const Plan& plan, const Evaluation& evaluation) {
  std::vector<SceneMarkup> made;
  if (!plan.landmarks.empty()) {
    Json points = Json::array();
    for (const NamedPoint& landmark : plan.landmarks)
      points.push_back(control_point(points.size() + 1, landmark.name, landmark.p_mm));
    made.push_back(markup("Fiducial", "landmarks", std::move(points)));
  }
  for (const Step& step : plan.steps) {
    if (const auto* saw = step.action.get_if<Saw>())
      add_saw(step.id, with_plane_read(*saw, plan.folder), made);
    else if (const auto* mask = step.action.get_if<Mask>())
      add_mask(step.id, with_files_read(*mask, plan.folder, evaluation.objects.lps_from_head), evaluation,
               made);
  }
  add_screws(plan, evaluation, made);
  return made;
}

}  // namespace octotomy::planner
