// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/surface_questions.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "brep/align/oriented_box.h"
#include "brep/contour/cross_section.h"
#include "brep/measure/curvature.h"
#include "brep/measure/gap.h"
#include "brep/measure/shortest_path.h"
#include "brep/mesh/measure.h"
#include "planner/operation/measure/wall_thickness.h"
#include "planner/operation/table/number_format.h"

namespace octotomy::planner {
namespace {

Json section_json(const SurfaceQuestions& questions, const brep::Mesh& mesh) {
  const brep::Plane plane = brep::plane_through(questions.section[0], questions.section[1]);
  const brep::CrossSection section = brep::cross_section(mesh, plane);
  Json contours = Json::array();
  for (const brep::Contour& contour : section.contours)
    contours.push_back({{"area_mm2", brep::signed_area_mm2(contour)},
                        {"perimeter_mm", brep::perimeter_mm(contour)},
                        {"points", contour.points_mm.size()}});
  return {{"origin_mm", to_json(plane.origin_mm)},
          {"normal", to_json(plane.normal)},
          {"right", to_json(plane.right)},
          {"up", to_json(plane.up)},
          {"area_mm2", section.area_mm2},
          {"perimeter_mm", section.perimeter_mm},
          {"contours", contours}};
}

Json box_json(const brep::Mesh& mesh) {
  const brep::OrientedBox box = brep::oriented_box(mesh);
  Json axes = Json::array();
  for (const glm::dvec3& axis : box.axes) axes.push_back(to_json(axis));
  return {{"centre_mm", to_json(box.centre_mm)},
          {"edges_mm", to_json(box.edges_mm)},
          {"axes", axes},
          {"volume_mm3", box.volume_mm3()}};
}

Json curvature_json(const brep::Mesh& mesh, AtVertices& shown) {
  brep::Curvature found = brep::curvature(mesh);
  std::vector<std::pair<double, double>> mean, gaussian;
  double total = 0.0;
  for (std::size_t v = 0; v < found.known.size(); ++v) {
    if (!found.known[v]) continue;
    mean.emplace_back(found.mean_per_mm[v], found.areas_mm2[v]);
    gaussian.emplace_back(found.gaussian_per_mm2[v], found.areas_mm2[v]);
    total += found.gaussian_per_mm2[v] * found.areas_mm2[v];
  }
  shown = {"mean_curvature_per_mm", std::move(found.mean_per_mm)};
  return {{"estimator", "at vertices, by cotangent weights and angle defects over mixed Voronoi areas"},
          {"mean", weighted_summary(std::move(mean), "per_mm")},
          {"gaussian", weighted_summary(std::move(gaussian), "per_mm2")},
          {"total_gaussian", total}};
}

Json along_json(const SurfaceQuestions& questions, const brep::Mesh& mesh) {
  const brep::SurfacePath path = brep::shortest_path(mesh, questions.along[0], questions.along[1]);
  Json points = Json::array();
  for (const glm::dvec3& p : path.points_mm) points.push_back(to_json(p));
  return {{"length_mm", path.length_mm},
          {"straight_mm", glm::distance(path.points_mm.front(), path.points_mm.back())},
          {"off_mm",
           {glm::distance(questions.along[0], path.points_mm.front()),
            glm::distance(questions.along[1], path.points_mm.back())}},
          {"points_mm", points}};
}

Json gap_json(const brep::Mesh& mesh, const brep::Mesh& other) {
  const brep::Gap gap = brep::gap(brep::triangles_of(mesh), brep::triangles_of(other));
  return {
      {"distance_mm", gap.distance_mm}, {"on_a_mm", to_json(gap.on_a_mm)}, {"on_b_mm", to_json(gap.on_b_mm)}};
}

double angle_deg(const std::vector<glm::dvec3>& points_mm) {
  const glm::dvec3& at = points_mm[1];
  const glm::dvec3 one = points_mm[0] - at, other = points_mm[2] - at;
  if (!(glm::length(one) > 0.0) || !(glm::length(other) > 0.0))
    throw std::runtime_error(
        "--angle: a point coincides with the corner, so the angle is undefined: choose another point");
  return std::atan2(glm::length(glm::cross(one, other)), glm::dot(one, other)) * 180.0 / std::numbers::pi;
}

}  // namespace

Json point_answers(const SurfaceQuestions& questions) {
  Json json = Json::object();
  if (!questions.distance.empty())
    json["distance_mm"] = glm::distance(questions.distance[0], questions.distance[1]);
  if (!questions.angle.empty()) json["angle_deg"] = angle_deg(questions.angle);
  return json;
}

Json surface_answers(const SurfaceQuestions& questions, const brep::Solid& solid,
                     const voxel::Progress& progress, Timings& timings, AtVertices& shown) {
  Json json;
  const auto put = [&](const char* key, const auto& make) {
    const Stopwatch watch(timings, key);
    json[key] = make();
  };
  put("oriented_box", [&] { return box_json(solid); });
  if (!questions.section.empty()) put("section", [&] { return section_json(questions, solid); });
  json.update(point_answers(questions));
  if (!questions.along.empty()) put("along", [&] { return along_json(questions, solid); });
  if (questions.to != nullptr) put("gap", [&] { return gap_json(solid, *questions.to); });
  if (questions.curvature) put("curvature", [&] { return curvature_json(solid, shown); });
  if (questions.thickness) {
    put("thickness", [&] {
      shown.name = "thickness_mm";
      return thickness_json(solid, progress, shown.values);
    });
  }
  return json;
}

std::vector<std::pair<std::string, std::string>> surface_rows(const Json& answers) {
  std::vector<std::pair<std::string, std::string>> rows;
  const auto number = [](const Json& value, int decimals, const char* unit) {
    return value.is_null() ? std::string("none") : grouped(value.get<double>(), decimals) + unit;
  };
  const auto add = [&](const char* key, const auto& text) {
    if (answers.contains(key)) rows.emplace_back(key, text(answers[key]));
  };
  add("oriented_box", [&](const Json& box) {
    return number(box["edges_mm"][0], 1, " x ") + number(box["edges_mm"][1], 1, " x ") +
           number(box["edges_mm"][2], 1, " mm");
  });
  add("section", [&](const Json& section) {
    return number(section["area_mm2"], 1, " mm\u00b2, ") + number(section["perimeter_mm"], 1, " mm round");
  });
  add("distance_mm", [&](const Json& distance) { return number(distance, 2, " mm"); });
  add("angle_deg", [&](const Json& angle) { return number(angle, 2, "\u00b0"); });
  add("along", [&](const Json& path) {
    return number(path["length_mm"], 2, " mm") + ", from " + number(path["off_mm"][0], 2, " mm") + " to " +
           number(path["off_mm"][1], 2, " mm") + " beside the points";
  });
  add("gap", [&](const Json& gap) { return number(gap["distance_mm"], 3, " mm"); });
  add("curvature", [&](const Json& curvature) {
    return number(curvature["mean"]["mean_per_mm"], 4, " /mm, ") +
           number(curvature["gaussian"]["mean_per_mm2"], 5, " /mm\u00b2");
  });
  add("thickness", [&](const Json& thickness) {
    const Json& average = thickness["volume"]["average"];
    return grouped(average["value"].get<double>(), 2) + " \u00b1 " +
           three_figures(average["half_width"].get<double>()) + " mm on average, thinnest wall " +
           number(thickness["wall"]["min_mm"], 2, " mm");
  });
  return rows;
}

}  // namespace octotomy::planner
