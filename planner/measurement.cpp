// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/measurement.h"

#include <cmath>

#include "planner/gap.h"

namespace octotomy::planner {
namespace {

/// How finely the plan's universe and its scans tell places apart.
Digitised digitised_of(const Evaluation& evaluation) {
  Digitised digitised{evaluation.universe.lattice().spacing_mm()};
  for (const ScanRecord& scan : evaluation.scans)
    digitised.sample_mm = glm::max(digitised.sample_mm, scan.lattice.spacing_mm());
  return digitised;
}

/// What the object's scan and window make doubtful.
Digitised digitised_of(const Evaluation& evaluation, const Object& object) {
  Digitised digitised = digitised_of(evaluation);
  if (object.grey) digitised.shift_mm = window_shift_mm({*object.grey, object.threshold});
  return digitised;
}

Json points_json(const Measured& measured, const Evaluation& evaluation) {
  const Digitised digitised = digitised_of(evaluation);
  const std::vector<glm::dvec3>& p = measured.points_mm;
  Json json{{"id", measured.id}, {"points_mm", Json::array()}};
  for (const glm::dvec3& point : p) json["points_mm"].push_back(to_json(point));
  if (p.size() == 2) {
    const HalfWidth width = distance_half_width({p[0], p[1]}, digitised);
    json["distance_mm"] = glm::distance(p[0], p[1]);
    json["distance_half_width_mm"] = width.value;
    json["distance_half_width_terms"] = to_json(width);
  } else {
    const HalfWidth width = angle_half_width({p[0], p[1], p[2]}, digitised);
    const glm::dvec3 first = p[0] - p[1], last = p[2] - p[1];
    json["angle_deg"] = glm::degrees(std::atan2(glm::length(glm::cross(first, last)), glm::dot(first, last)));
    json["angle_half_width_deg"] = width.value;
    json["angle_half_width_terms"] = to_json(width);
  }
  return json;
}

Json gap_json(const Measured& measured, const Evaluation& evaluation) {
  const Object &object = evaluation.objects[measured.object], &other = evaluation.objects[*measured.to];
  Json json{{"id", measured.id},     {"object", object.id},    {"to", other.id},
            {"gap_mm", nullptr},     {"gap_mesh_mm", nullptr}, {"gap_half_width_mm", nullptr},
            {"overlap_mm3", nullptr}};
  if (object.octree.is_empty() || other.octree.is_empty()) {
    json["finding"] = "there is no gap: " + (object.octree.is_empty() ? object.id : other.id) + " is empty";
    return json;
  }
  const Gap gap = gap_between(object.octree, other.octree, object.mesh.get(), other.mesh.get());
  const HalfWidth width = gap_half_width(gap.to_mm - gap.from_mm, digitised_of(evaluation, object),
                                         digitised_of(evaluation, other));
  json["gap_mm"] = gap.voxel_mm;
  json["gap_estimator"] = "faces of the two voxels whose centres are nearest";
  if (gap.mesh_mm) json["gap_mesh_mm"] = *gap.mesh_mm;
  json["gap_half_width_mm"] = width.value;
  json["gap_half_width_terms"] = to_json(width);
  json["overlap_mm3"] = gap.overlap_mm3;
  json["from_mm"] = to_json(gap.from_mm);
  json["to_mm"] = to_json(gap.to_mm);
  return json;
}

Json size_json(const Measured& measured, const Evaluation& evaluation) {
  const Object& object = evaluation.objects[measured.object];
  const double voxels_mm3 = object.voxel_measures.volume_mm3;
  Json json{{"id", measured.id},
            {"object", object.id},
            {"volume_mm3", voxels_mm3},
            {"volume_estimator", "voxels counted"},
            {"area_mm2", nullptr},
            {"area_estimator", mesh_area_estimator},
            {"centroid_mm", to_json(object.voxel_measures.centroid_mm)},
            {"voxel", to_json(object.voxel_measures)},
            {"mesh", nullptr},
            {"difference_mm3", nullptr},
            {"difference_percent", nullptr}};
  const HalfWidth width = volume_half_width(object.voxel_measures, digitised_of(evaluation, object));
  json["volume_half_width_mm3"] = width.value;
  json["volume_half_width_terms"] = to_json(width);
  json["area_half_width_mm2"] = nullptr;
  if (object.certificate)
    for (const verify::Comparison& comparison : object.certificate->comparisons)
      if (comparison.quantity == "area" && comparison.tolerance)
        json["area_half_width_mm2"] = *comparison.tolerance;
  if (object.mesh_measures) {
    const double mesh_mm3 = object.mesh_measures->volume_mm3;
    json["area_mm2"] = object.mesh_measures->area_mm2;
    json["mesh"] = to_json(*object.mesh_measures);
    json["difference_mm3"] = voxels_mm3 - mesh_mm3;
    if (mesh_mm3 > 0.0) json["difference_percent"] = 100.0 * (voxels_mm3 - mesh_mm3) / mesh_mm3;
  } else {
    json["area_mm2"] = object.voxel_measures.area_crofton13_mm2;
    json["area_estimator"] = voxel_area_estimator;
  }
  return json;
}

}  // namespace

Json measurements_json(const Evaluation& evaluation) {
  Json all = Json::array();
  for (const Measured& measured : evaluation.measured)
    all.push_back(!measured.points_mm.empty() ? points_json(measured, evaluation)
                  : measured.to               ? gap_json(measured, evaluation)
                                              : size_json(measured, evaluation));
  return all;
}

}  // namespace octotomy::planner
