// SPDX-License-Identifier: AGPL-3.0-or-later
// The size of an airway and its narrowest section, between two ends.
#include <cmath>

#include "planner/operation/measure/airway_sections.h"
#include "planner/operation/measure/digitised.h"
#include "planner/operation/measure/measurement.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Airway {
  ObjectName object;
  Mark begin, end;
  double step_mm = 1.0;
};

MeasuredSection measured(const AirwaySection& section, const Digitised& digitised) {
  return {section.along_mm,
          section.at_mm,
          section.direction,
          section.area_mm2(),
          section_half_width(section, digitised).value,
          section.voxel_mm2,
          section.mesh_mm2,
          {}};
}

Json measure(const Airway& asked, const AnswerBench& bench) {
  const Stopwatch watch(bench.timings, "airway");
  const Object& object = bench.objects.at(asked.object.name);
  const AirwaySections found =
      airway_sections(object.voxel.octree, object.mesh.within, mark_mm(asked.begin, bench.objects),
                      mark_mm(asked.end, bench.objects), asked.step_mm);
  const Digitised digitised = digitised_of(bench, object);
  const HalfWidth of_volume = volume_half_width(object.voxel.measures, digitised, seen_size_of(object));
  const AirwaySection& least = found.sections[found.narrowest];
  MeasuredAirway made{object.id, {}, {}};
  AirwaySize& airway = made.airway;
  airway.volume_mm3 = object.voxel.measures.volume_mm3;
  airway.volume_half_width_mm3 = of_volume.value;
  if (object.mesh.within) airway.volume_mesh_mm3 = object.mesh.within->measures().volume_mm3;
  airway.length_mm = found.length_mm;
  airway.narrowest = measured(least, digitised);
  airway.narrowest.half_width_terms = section_half_width(least, digitised).terms;
  for (const AirwaySection& section : found.sections) airway.sections.push_back(measured(section, digitised));
  if (!object.mesh.within)
    made.findings.push_back(
        "there is no mesh, so all areas and volumes are counted in voxels: see the object's findings");
  if (const auto finding = too_coarse_finding(object, of_volume)) made.findings.push_back(*finding);
  const double differ = least.mesh_mm2 ? std::abs(*least.mesh_mm2 - least.voxel_mm2) : 0.0;
  if (differ > airway.narrowest.half_width_mm2)
    made.findings.push_back(
        "the two kernels' areas of the narrowest section differ by more than the half-width: measure again "
        "with smaller voxels");
  return print_record(made);
}

}  // namespace

Operation airway_operation() {
  return Describe<Airway>("airway",
                          "Measures an airway: its volume, the areas of its sections across its centre line, "
                          "and its narrowest section.",
                          Makes::Measurement)
      .takes(field("object", &Airway::object,
                   "The object of the air in the airway: usually one part of a window on air, cut at the "
                   "airway's ends.")
                 .required())
      .takes(field("begin", &Airway::begin, "The beginning of the airway: a point or a landmark in its air.")
                 .required())
      .takes(field("end", &Airway::end, "The airway's end.").required())
      .takes(field("step_mm", &Airway::step_mm, "The distance between sections.").from(0.1).to(20.0))
      .example(
          R"({"id": "narrow", "do": "airway", "object": "rest", "begin": [0, 0, 20], "end": [0, 0, -20]})")
      .measure(measure);
}

}  // namespace octotomy::planner
