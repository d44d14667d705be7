// SPDX-License-Identifier: AGPL-3.0-or-later
// The insertion direction with the least undercut: of a grid of directions about a first one, that along
// which the object's shadow adds the least volume. The voxel kernel measures all directions; the mesh kernel
// measures the first and the best one again.
#include <algorithm>
#include <cmath>
#include <vector>

#include "brep/shape/shadow.h"
#include "planner/operation/measure/digitised.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/part/insertion.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/shadow.h"

namespace octotomy::planner {
namespace {

struct InsertionSearch {
  ObjectName object;
  Insertion insertion;
  double within_deg = 30.0;
  double step_deg = 10.0;
};

void check(const InsertionSearch& asked, const FieldLocation& place) {
  check(asked.insertion, place);
  if (asked.step_deg > asked.within_deg)
    place.at("step_deg")
        .refuse("is larger than 'within_deg', so only the first direction would be tried: make it smaller");
}

double by_mesh_mm3(const brep::Solid& solid, const glm::dvec3& direction, const AnswerBench& bench) {
  const brep::Shadow found =
      brep::shadow(solid, {direction, brep::far_end_mm(solid, direction), {bench.stop, {}}});
  return brep::volume_mm3(found.solid) - brep::volume_mm3(solid);
}

Json measure(const InsertionSearch& asked, const AnswerBench& bench) {
  const Stopwatch watch(bench.timings, "insertion_search");
  const Object& object = bench.objects.at(asked.object.name);
  Json json{{"object", object.id},   {"direction", nullptr},       {"tilt_deg", nullptr},
            {"filled_mm3", nullptr}, {"mesh_filled_mm3", nullptr}, {"first", nullptr},
            {"map", Json::array()},  {"findings", Json::array()}};
  if (object.voxel.octree.is_empty() || !object.voxel.symbol) {
    json["findings"].push_back(why_no_voxels(object) + ": no direction can be found");
    return json;
  }
  const glm::dvec3 first = direction_of(asked.insertion, bench.objects.lps_from_head);
  const std::vector<glm::dvec3> directions = directions_about(first, asked.within_deg, asked.step_deg);
  const voxel::Expression solid =
      *object.voxel.symbol & voxel::Expression(voxel::bounds(bench.universe.lattice()));
  const std::vector<double> filled =
      voxel::filled_mm3(object.voxel.octree, solid, directions, bench.progress("insertion_search"));
  const auto tilt_deg = [&](const glm::dvec3& direction) {
    return glm::degrees(std::acos(std::clamp(glm::dot(first, direction), -1.0, 1.0)));
  };
  for (std::size_t i = 0; i < directions.size(); ++i)
    json["map"].push_back({{"direction", to_json(directions[i])},
                           {"tilt_deg", tilt_deg(directions[i])},
                           {"filled_mm3", filled[i]}});
  const auto best = static_cast<std::size_t>(std::min_element(filled.begin(), filled.end()) - filled.begin());
  json["direction"] = to_json(directions[best]);
  json["tilt_deg"] = tilt_deg(directions[best]);
  json["filled_mm3"] = filled[best];
  json["first"] = {{"direction", to_json(first)}, {"filled_mm3", filled[0]}, {"mesh_filled_mm3", nullptr}};
  if (!object.mesh.within || object.mesh.within->empty()) {
    json["findings"].push_back("there is no mesh of '" + object.id + "': only voxels were used");
    return json;
  }
  json["first"]["mesh_filled_mm3"] = by_mesh_mm3(*object.mesh.within, first, bench);
  json["mesh_filled_mm3"] = best == 0 ? json["first"]["mesh_filled_mm3"]
                                      : Json(by_mesh_mm3(*object.mesh.within, directions[best], bench));
  if (json["mesh_filled_mm3"].get<double>() > json["first"]["mesh_filled_mm3"].get<double>())
    json["findings"].push_back(
        "in the mesh, the first direction has a smaller undercut than the direction that is best in voxels: "
        "use the first direction");
  return json;
}

}  // namespace

Operation insertion_search_operation() {
  return Describe<InsertionSearch>(
             "insertion_search",
             "Searches for the insertion direction along which an object has the least undercut.",
             Makes::Measurement)
      .takes(field("object", &InsertionSearch::object, "The bone or teeth on which a part is to sit.")
                 .required())
      .takes(insertion_direction(&InsertionSearch::insertion))
      .takes(insertion_view(&InsertionSearch::insertion))
      .takes(field("within_deg", &InsertionSearch::within_deg,
                   "The largest angle between the first direction and the other directions that are tried.")
                 .greater_than(0.0)
                 .to(80.0))
      .takes(field("step_deg", &InsertionSearch::step_deg,
                   "The angle between neighbouring directions that are tried.")
                 .from(1.0)
                 .to(45.0))
      .example(R"({"id": "way_in", "do": "insertion_search", "object": "maxilla", "direction": [0, 0, 1],
        "within_deg": 20, "step_deg": 5})")
      .of_head()
      .check(check)
      .measure(measure);
}

}  // namespace octotomy::planner
