// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/contour_request.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/contour/contour_edit.h"
#include "brep/contour/thin.h"
#include "brep/mesh/mesh.h"
#include "convert/surface/expression_surface.h"
#include "planner/browser/server/pane_fields.h"
#include "planner/operation/file/plane_contours.h"
#include "planner/operation/table/number_format.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

[[noreturn]] void refuse_contours(const std::string& why) {
  throw voxel::Error(voxel::ErrorCode::Input, why);
}

/// Thins a contour. Returns it unchanged if the thinned one would cross itself.
std::vector<glm::dvec2> thinned(const std::vector<glm::dvec2>& polygon, double thin_mm) {
  if (!(thin_mm > 0.0)) return polygon;
  const brep::Contour thin = brep::thin({polygon}, thin_mm);
  return brep::first_crossing(thin) ? polygon : thin.points_mm;
}

/// Contours as JSON, thinned and rounded to hundredths of a millimetre. Leaves out points that then equal the
/// previous one, and contours that then enclose no area.
Json polygons_json(const PlaneContours& polygons, double thin_mm) {
  constexpr double least_mm2 = 0.01 * 0.01;
  Json all = Json::array();
  for (const auto& polygon : polygons) {
    brep::Contour rounded;
    for (const glm::dvec2& p : thinned(polygon, thin_mm)) {
      const glm::dvec2 point = glm::round(100.0 * p) / 100.0;
      if (rounded.points_mm.empty() || rounded.points_mm.back() != point) rounded.points_mm.push_back(point);
    }
    if (rounded.points_mm.size() > 3 && rounded.points_mm.front() == rounded.points_mm.back())
      rounded.points_mm.pop_back();
    if (rounded.points_mm.size() < 3 || std::abs(brep::signed_area_mm2(rounded)) < least_mm2) continue;
    Json points = Json::array();
    for (const glm::dvec2& p : rounded.points_mm) points.push_back({p.x, p.y});
    all.push_back(std::move(points));
  }
  return all;
}

/// The mesh kernel's surface of an object. If the object is not certified yet, this is the surface half way
/// between its voxels and those outside.
brep::Mesh surface_of(const Object& object) {
  if (object.mesh.within) return object.mesh.within->mesh();
  if (object.certificate) refuse_contours("'" + object.id + "' has no surface: see its findings");
  return brep::mesh_of(convert::isosurface(object.voxel.octree.universe(), object.voxel.octree));
}

}  // namespace

Json trace_contours(Session& session, const Json& said, const Watched&) {
  const Snapshot snapshot = session.snapshot();
  if (!snapshot.evaluation) refuse_contours("nothing is evaluated yet");
  const ViewPlane plane{voxel::parse_view(said.at("view")), said.at("position_mm").get<double>()};
  const double thin_mm = number_of(said, "thin_mm").value_or(0.1);
  if (said.contains("object")) {
    const std::string id = said["object"];
    for (const Object& object : snapshot.evaluation->objects) {
      if (object.id != id) continue;
      const Json polygons = polygons_json(contours_in_plane(surface_of(object), plane), thin_mm);
      if (polygons.empty()) refuse_contours("the slice does not meet '" + id + "': choose another slice");
      return {{"polygons_mm", polygons}};
    }
    refuse_contours("'" + id + "' is not evaluated yet");
  }
  const auto& loaded = snapshot.evaluation->loaded;
  if (loaded.empty()) refuse_contours("no scan is open");
  const auto named = loaded.find(said.value("scan", loaded.begin()->first));
  if (named == loaded.end()) refuse_contours("scan: the plan has no scan of that name");
  const voxel::Scene& scene = named->second->scene();
  const auto seed_mm = point_of(said, "seed_mm");
  if (!seed_mm) refuse_contours("seed_mm: give a point");
  const glm::dvec3 p_voxel = scene.lattice.voxel(*seed_mm);
  if (glm::any(glm::lessThan(p_voxel, glm::dvec3(-0.5))) ||
      glm::any(glm::greaterThan(p_voxel, glm::dvec3(scene.lattice.dims) - 0.5)))
    refuse_contours("the scan has no sample there: click within it");
  const double sample = voxel::interpolate(scene, p_voxel);
  double low = number_of(said, "low").value_or(-std::numeric_limits<double>::infinity()),
         high = number_of(said, "high").value_or(std::numeric_limits<double>::infinity());
  if (const auto tolerance = number_of(said, "tolerance")) {
    low = sample - *tolerance;
    high = sample + *tolerance;
  }
  const PlaneContours region =
      region_around(contours_in_plane(scene, low, high, plane), plane.view.project(*seed_mm));
  if (region.empty())
    refuse_contours("the sample there is " + plain(std::round(10.0 * sample) / 10.0) +
                    ", which lies outside the window: click within the region, or choose other bounds");
  return {{"polygons_mm", polygons_json(region, thin_mm)}, {"sample", sample}};
}

}  // namespace octotomy::planner::serve
