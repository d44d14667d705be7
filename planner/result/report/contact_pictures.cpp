// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/contact_pictures.h"

#include <algorithm>
#include <limits>

#include "planner/result/report/measurement.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

constexpr int contact_picture_px = 480;
/// Bone within `about_mm` of the contacts is drawn, up to `above_mm` above the highest one.
constexpr double about_mm = 20.0, above_mm = 3.0;

/// The axis-aligned view that looks most directly against `normal`.
std::string view_onto(const glm::dvec3& normal, const glm::dmat3& lps_from_head) {
  std::string best;
  double least = std::numeric_limits<double>::infinity();
  for (const char* name : {"anterior", "posterior", "left", "right", "superior", "inferior"})
    if (const double along = glm::dot(lps_from_head * voxel::parse_view(name).look, normal); along < least)
      best = name, least = along;
  return best;
}

/// The part of an object near its contacts, without bone above them that would hide them.
voxel::Octree part_about(const voxel::Octree& octree, const std::vector<glm::dvec3>& places_mm,
                         const glm::dvec3& towards_reader) {
  voxel::Box box{places_mm.front(), places_mm.front()};
  double highest = -std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p : places_mm) {
    box = {glm::min(box.low_mm, p), glm::max(box.high_mm, p)};
    highest = std::max(highest, glm::dot(p, towards_reader));
  }
  return voxel::combine(octree.universe(), voxel::Expression(octree) &
                                               voxel::Box{box.low_mm - about_mm, box.high_mm + about_mm} &
                                               voxel::HalfSpace{towards_reader, highest + above_mm});
}

}  // namespace

void add_contact_pictures(Result& result) {
  const Objects& objects = result.evaluation.objects;
  for (const Measurement& measurement : measurements_of(result.measurements)) {
    if (!measurement.contacts || !measurement.contacts->nearest_mm) continue;
    const MeasuredContacts& map = *measurement.contacts;
    const std::string name = "contacts_" + measurement.id;
    if (std::any_of(result.pictures.begin(), result.pictures.end(),
                    [&](const PictureGroup& group) { return group.name == name; }))
      continue;
    const Object& object = objects.at(map.object);
    const Object& against = objects.at(map.against);
    const double most_mm = std::max(2.0, 4.0 * map.within_mm);
    PictureGroup group{name, object.id + " where it touches " + against.id, {}, {}, {}, most_mm};
    glm::dvec3 normal(0.0);
    for (const MeasuredContact& contact : map.contacts) {
      group.marks_mm.push_back(contact.at_mm);
      normal += contact.area_mm2.value_or(1.0) * contact.normal;
    }
    const std::vector<glm::dvec3> places_mm =
        group.marks_mm.empty() ? std::vector{map.nearest_at_mm.value_or(glm::dvec3(0.0))} : group.marks_mm;
    if (group.marks_mm.empty()) {
      const auto middle = [](const Object& of) {
        return of.voxel.measures.centroid_mm.value_or(glm::dvec3(0.0));
      };
      normal = middle(against) - middle(object);
    }
    const std::string view = view_onto(normal, objects.lps_from_head);
    const glm::dvec3 towards_reader = -(objects.lps_from_head * voxel::parse_view(view).look);
    voxel::DrawnObject drawn{object.id, part_about(object.voxel.octree, places_mm, towards_reader)};
    if (drawn.octree.is_empty()) continue;
    drawn.scalar = std::make_shared<const voxel::SurfaceScalar>(
        voxel::distance_to(against.voxel.octree, drawn.octree, most_mm));
    group.objects.push_back(std::move(drawn));
    draw(group, {view, view == "superior" || view == "inferior" ? "anterior" : "superior"}, group.objects,
         contact_picture_px, objects.lps_from_head);
    result.pictures.push_back(std::move(group));
  }
}

}  // namespace octotomy::planner
