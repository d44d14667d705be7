// SPDX-License-Identifier: AGPL-3.0-or-later
// Contacts of two objects, like marks of articulating paper on teeth: positions, areas, depths and distances.
#include <algorithm>

#include "planner/operation/measure/digitised.h"
#include "planner/operation/measure/measurement.h"
#include "planner/operation/measure/near_surfaces.h"
#include "planner/operation/table/operation.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

struct ContactMap {
  ObjectName object, against;
  double within_mm = ContactOptions{}.within_mm, apart_mm = ContactOptions{}.apart_mm;
};

void check(const ContactMap& asked, const FieldLocation& place) {
  if (asked.object.name == asked.against.name)
    place.at("against").refuse("is the object itself: name the object that it shall touch");
}

MeasuredContacts measured(const ContactMap& asked, const AnswerBench& bench) {
  const Object& object = bench.objects.at(asked.object.name);
  const Object& other = bench.objects.at(asked.against.name);
  MeasuredContacts made;
  made.object = object.id;
  made.against = other.id;
  made.within_mm = asked.within_mm;
  for (const Object* each : {&object, &other})
    if (each->voxel.octree.is_empty()) {
      made.findings.push_back(why_no_voxels(*each) + ": nothing touches");
      return made;
    }
  const Stopwatch watch(bench.timings, "contacts");
  const Contacts found = contacts_between(object.voxel.octree, other.voxel.octree, object.mesh.within,
                                          other.mesh.within, {asked.within_mm, asked.apart_mm});
  const Digitised digitised = digitised_of(bench, object), digitised_other = digitised_of(bench, other);
  int certain = 0;
  double area_mm2 = 0.0;
  for (const Contact& contact : found.contacts) {
    const double half_width_mm = gap_half_width(contact.normal, digitised, digitised_other).value;
    made.contacts.push_back({contact.at_mm, contact.normal, contact.nearest_mm, contact.voxel_nearest_mm,
                             std::max(0.0, -contact.nearest_mm), contact.area_mm2, half_width_mm});
    certain += contact.nearest_mm + half_width_mm <= asked.within_mm ? 1 : 0;
    area_mm2 += contact.area_mm2.value_or(0.0);
  }
  made.certain_count = certain;
  if (found.by_mesh) made.area_mm2 = area_mm2;
  made.nearest_mm = found.nearest_mm;
  made.nearest_at_mm = found.nearest_at_mm;
  made.voxel_nearest_mm = found.voxel_nearest_mm;
  made.overlap_mm3 =
      static_cast<double>(
          voxel::combine(bench.universe, voxel::Expression(object.voxel.octree) & other.voxel.octree)
              .voxel_count()) *
      bench.universe.lattice().voxel_mm3();
  made.estimator =
      found.by_mesh
          ? "distance from points of the first mesh to the nearest triangle of the second"
          : "distance from voxels on the first object's boundary to the nearest voxel of the second";
  if (!found.by_mesh)
    made.findings.push_back("at least one object has no mesh, so areas are not reported: see its findings");
  return made;
}

Json measure(const ContactMap& asked, const AnswerBench& bench) {
  return print_record(measured(asked, bench));
}

}  // namespace

Operation contacts_operation() {
  return Describe<ContactMap>("contacts",
                              "Reports where two objects touch, as articulating paper does between teeth.",
                              Makes::Measurement)
      .takes(field("object", &ContactMap::object,
                   "The object on whose surface contacts are reported, such as the lower teeth.")
                 .required())
      .takes(field("against", &ContactMap::against, "What it touches.").required())
      .takes(field("within_mm", &ContactMap::within_mm, "Surfaces count as touching up to this distance.")
                 .greater_than(0.0)
                 .to(20.0))
      .takes(field("apart_mm", &ContactMap::apart_mm,
                   "Contacts nearer to each other than this are reported as one.")
                 .greater_than(0.0)
                 .to(50.0))
      .example(R"({"id": "bite", "do": "contacts", "object": "rest", "against": "advanced",
        "within_mm": 0.5})")
      .check(check)
      .measure(measure);
}

}  // namespace octotomy::planner
