// SPDX-License-Identifier: AGPL-3.0-or-later
// Whether a part can be put on: how deep bone or teeth reach into the space that it passes through on its way
// to its place. Each kernel sweeps its own version of the part and compares it with its own versions of the
// objects. The mesh's depth is the result; the voxels' must agree within their resolution.
#include "brep/shape/seating.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/part/insertion.h"
#include "planner/operation/part/seated_part.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/seating.h"
#include "voxel/space/rounded.h"

namespace octotomy::planner {
namespace {

struct Seating {
  ObjectName part;
  std::vector<ObjectName> against;
  Insertion insertion;
  double tolerance_mm = 0.12;
};

/// The accuracy of depths in the mesh, in mm.
constexpr double resolution_mm = 0.01;

void check(const Seating& seating, const FieldLocation& place) {
  check(seating.insertion, place);
  check_against(seating.part, seating.against, place);
}

/// The results of both kernels for one object.
struct Found {
  std::string object;
  std::optional<brep::Binding> mesh;
  std::optional<voxel::Binding> voxel;
  double mesh_swept_mm3 = 0.0, voxel_swept_mm3 = 0.0;

  double depth_mm() const { return mesh ? mesh->depth_mm : 0.0; }
  double voxel_depth_mm() const { return voxel ? voxel->depth_mm : 0.0; }
};

Json json_of(const Found& found, double tolerance_mm) {
  Json json{{"object", found.object},    {"depth_mm", found.depth_mm()},
            {"at_mm", nullptr},          {"binds_from_mm", nullptr},
            {"binds_until_mm", nullptr}, {"voxel_depth_mm", found.voxel_depth_mm()},
            {"voxel_at_mm", nullptr},    {"binds", found.depth_mm() > tolerance_mm}};
  if (found.mesh) {
    json["at_mm"] = to_json(found.mesh->at_mm);
    json["binds_from_mm"] = found.mesh->first_mm;
    json["binds_until_mm"] = found.mesh->last_mm;
  }
  if (found.voxel) json["voxel_at_mm"] = to_json(found.voxel->at_mm);
  return json;
}

std::string sentence_of(const Found& found, const std::string& part) {
  const brep::Binding& at = *found.mesh;
  return "'" + part + "' binds on '" + found.object + "': it would go " + three_figures(at.depth_mm) +
         " mm into it at " + voxel::rounded(at.at_mm) + " mm, from " + three_figures(at.first_mm) + " to " +
         three_figures(at.last_mm) +
         " mm before its seat: subtract the object's shadow along the insertion direction from the part, or "
         "choose another direction";
}

Found find(const Object& part, const Object& object, const glm::dvec3& along, const AnswerBench& bench) {
  Found found{object.id, {}, {}};
  const brep::Seating by_mesh =
      brep::seating(*part.mesh.within, *object.mesh.within, {along, resolution_mm, {bench.stop, {}}});
  found.mesh = by_mesh.binding;
  found.mesh_swept_mm3 = by_mesh.swept_mm3;
  const voxel::Box world = voxel::bounds(bench.universe.lattice());
  const voxel::Seating by_voxels =
      voxel::seating(part.voxel.octree, *part.voxel.symbol & voxel::Expression(world), object.voxel.octree,
                     {along, {bench.stop, {}}});
  found.voxel = by_voxels.binding;
  found.voxel_swept_mm3 = by_voxels.swept_mm3;
  return found;
}

Json measure(const Seating& asked, const AnswerBench& bench) {
  const Stopwatch watch(bench.timings, "seating");
  const Object& part = bench.objects.at(asked.part.name);
  const glm::dvec3 along = direction_of(asked.insertion, bench.objects.lps_from_head);
  Json json{{"object", part.id},         {"direction", to_json(along)}, {"tolerance_mm", asked.tolerance_mm},
            {"verdict", nullptr},        {"depth_mm", nullptr},         {"resolution_mm", resolution_mm},
            {"voxel_error_mm", nullptr}, {"against", Json::array()},    {"findings", Json::array()}};
  const auto add_missing = [&](const Object& object) {
    if (auto missing = missing_kernel(object, "nothing can be seated"))
      json["findings"].push_back(std::move(*missing));
  };
  add_missing(part);
  for (const ObjectName& name : asked.against) add_missing(bench.objects.at(name.name));
  if (!json["findings"].empty()) return json;

  // Each digitised surface may be displaced by half a voxel's diagonal.
  const double voxel_error_mm = glm::length(bench.universe.lattice().spacing_mm());
  json["voxel_error_mm"] = voxel_error_mm;
  double deepest_mm = 0.0;
  std::string verdict = "PASS";
  for (const ObjectName& name : asked.against) {
    const Found found = find(part, bench.objects.at(name.name), along, bench);
    json["against"].push_back(json_of(found, asked.tolerance_mm));
    deepest_mm = std::max(deepest_mm, found.depth_mm());
    if (std::abs(found.depth_mm() - found.voxel_depth_mm()) > voxel_error_mm) {
      if (verdict == "PASS") verdict = "WARN";
      json["findings"].push_back("the kernels disagree about '" + found.object +
                                 "': " + three_figures(found.depth_mm()) + " mm deep in meshes, " +
                                 three_figures(found.voxel_depth_mm()) + " mm in voxels");
    }
    if (found.depth_mm() > asked.tolerance_mm) {
      verdict = "FAIL";
      json["findings"].push_back(sentence_of(found, part.id));
    }
  }
  json["verdict"] = verdict;
  json["depth_mm"] = deepest_mm;
  return json;
}

}  // namespace

Operation seating_operation() {
  return Describe<Seating>(
             "seating",
             "Tests whether a part can be put on: measures the depth to which objects extend into its path.",
             Makes::Measurement)
      .takes(field("object", &Seating::part, "The part in its seated position.").required())
      .takes(field("against", &Seating::against, "The bone or teeth on which it sits.").required().from(1))
      .takes(insertion_direction(&Seating::insertion))
      .takes(insertion_view(&Seating::insertion))
      .takes(field("tolerance_mm", &Seating::tolerance_mm,
                   "The tolerated depth. Parts are elastic, so a part snaps onto an undercut of this depth.")
                 .from(0.0)
                 .to(2.0))
      .example(R"({"id": "goes_on", "do": "seating", "object": "advanced", "against": ["rest"],
        "direction": [0, 1, 0]})")
      .of_head()
      .check(check)
      .measure(measure);
}

}  // namespace octotomy::planner
