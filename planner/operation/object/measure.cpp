// SPDX-License-Identifier: AGPL-3.0-or-later
// The size of an object, the gap between two objects, the distance between two points or the angle of three;
// each number with its half-width and the terms of that half-width.
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "planner/operation/file/path_checks.h"
#include "planner/operation/measure/counted_window.h"
#include "planner/operation/measure/digitised.h"
#include "planner/operation/measure/gap.h"
#include "planner/operation/measure/measurement.h"
#include "planner/operation/measure/recommended.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/measure/surface_questions.h"
#include "planner/operation/measure/wall_thickness.h"
#include "planner/operation/object/measure_file.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/deformation.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/label_map.h"

namespace octotomy::planner {
namespace {

void check(const Measure& measure, const FieldLocation& place) {
  if (place.scope == nullptr) return;
  const FieldLocation points = place.at("points_mm");
  if (measure.asks_surface() && (measure.to || !measure.points_mm.empty()))
    place.refuse(
        "requests measures of a surface together with a gap or points: use a separate step for each");
  if (measure.points_mm.empty()) {
    if (!measure.object) place.refuse("'object' is missing: add it");
    if (measure.to && measure.to->name == measure.object->name)
      place.at("to").refuse("is the object itself: name another object to which the gap is measured");
    return;
  }
  if (measure.object || measure.to)
    points.refuse("excludes other measures: measure objects and points in separate steps");
  if (measure.points_mm.size() != 2 && measure.points_mm.size() != 3)
    points.refuse("must be two points [x, y, z] for a distance, or three for the angle at the second");
  if (measure.points_mm.size() == 3 &&
      (measure.points_mm[1] == measure.points_mm[0] || measure.points_mm[1] == measure.points_mm[2]))
    points.refuse("has its second point twice, so a leg of the angle has no length: choose another point");
}

/// A recommended volume and area, with the facts on which their findings depend.
struct Recommended {
  verify::SizeIntervals intervals;
  bool is_of_phases = false, has_core = false;
};

/// The two-phase estimate from the samples of a window's scan; none for labels and for windows with an upper
/// bound. It is cached, because several objects may come from one window.
const std::optional<verify::TwoPhase>& phases_of(const AnswerBench& bench, const Shown& window) {
  std::shared_ptr<const void>& kept =
      bench.kept["phases of " + window.scan + " from " + std::to_string(window.threshold)];
  if (!kept) {
    std::optional<verify::TwoPhase> found;
    if (window.samples && std::isinf(window.high) && window.samples->meaning != voxel::Meaning::Label)
      found = verify::two_phase(*window.samples, window.threshold, {bench.stop, {}});
    kept = std::make_shared<const std::optional<verify::TwoPhase>>(std::move(found));
  }
  return *static_cast<const std::optional<verify::TwoPhase>*>(kept.get());
}

/// Whether the object is the whole selection of a window step, or an image of the whole.
bool is_whole_window(const Objects& objects, const Object& object) {
  return still_of(objects, object).kind == "window" && (!object.image || object.image->is_whole);
}

/// The window if the object is the whole window on a label map; else null.
const Shown* label_window_of(const AnswerBench& bench, const Object& object) {
  if (object.bound.windows.empty() || !is_whole_window(bench.objects, object)) return nullptr;
  const Shown& window = object.bound.windows.front();
  return window.samples && window.samples->meaning == voxel::Meaning::Label ? &window : nullptr;
}

/// Adds to the recommended size the difference between the sum of the samples and the surface. A whole window
/// gets the two-phase numbers. A part of a window gets a wider half-width in proportion to its share of the
/// window's surface, because the positions of thin walls are unknown.
void take_phases(const AnswerBench& bench, const Object& object, Recommended& found) {
  std::vector<const Shown*> windows;
  for (const Shown& window : object.bound.windows)
    if (std::none_of(windows.begin(), windows.end(), [&](const Shown* known) {
          return known->scan == window.scan && known->threshold == window.threshold;
        }))
      windows.push_back(&window);
  for (const Shown* window : windows) {
    const std::optional<verify::TwoPhase>& phases = phases_of(bench, *window);
    if (!phases) continue;
    if (is_whole_window(bench.objects, object)) {
      found.intervals = intervals_of_phases(*phases, std::move(found.intervals));
      found.is_of_phases = !phases->evidence.is_ambiguous;
      found.has_core = phases->evidence.has_core;
      return;
    }
    const double whole_mm2 = phases->evidence.level_mm2[0];
    if (!(whole_mm2 > 0.0)) continue;
    const double share = std::min(1.0, object.mesh.within->size().area_mm2 / whole_mm2);
    const auto widen = [&](verify::Interval& interval, double lost) {
      interval.half_width += share * lost;
      interval.sources.push_back({"thin or sharp",
                                  "share of the whole window's difference between samples and surface",
                                  share * lost, true});
    };
    widen(found.intervals.volume_mm3,
          std::abs(phases->volume_mm3.value - phases->evidence.counted_mm3) + phases->volume_mm3.half_width);
    widen(found.intervals.area_mm2,
          std::abs(phases->area_mm2.value - whole_mm2) + phases->area_mm2.half_width);
  }
}

/// The change of a window's size if samples are twice as thick. It is cached, because several objects may
/// come from one window.
const std::optional<Thickness>& kept_thickness(const AnswerBench& bench, const Shown& window) {
  std::shared_ptr<const void>& kept =
      bench.kept["thickness of " + window.scan + " from " + std::to_string(window.threshold) + " to " +
                 std::to_string(window.high)];
  if (!kept) {
    std::optional<Thickness> found;
    if (window.samples && window.samples->meaning != voxel::Meaning::Label)
      found = thickness_of(*window.samples, window.threshold, window.high);
    kept = std::make_shared<const std::optional<Thickness>>(found);
  }
  return *static_cast<const std::optional<Thickness>*>(kept.get());
}

/// For windows without a two-phase estimate, adds the error due to the samples' thickness, in proportion to
/// the object's share of the window's surface.
void take_thickness(const AnswerBench& bench, const Object& object, Recommended& found) {
  std::set<std::tuple<std::string, double, double>> known;
  for (const Shown& window : object.bound.windows) {
    if (!known.emplace(window.scan, window.threshold, window.high).second) continue;
    if (const auto& phases = phases_of(bench, window); phases && !phases->evidence.is_ambiguous) continue;
    const std::optional<Thickness>& thickness = kept_thickness(bench, window);
    if (!thickness || !(thickness->faces_mm2 > 0.0)) continue;
    const double share =
        is_whole_window(bench.objects, object)
            ? 1.0
            : std::min(1.0, 1.5 * object.mesh.within->size().area_mm2 / thickness->faces_mm2);
    add_thickness(*thickness, share, found.intervals);
  }
}

/// The counting error in mm3 of an object without a mesh, from its scan's samples. A motion that changes the
/// volume changes it in proportion. None if the object comes from no scan.
std::optional<double> counting_doubt_of(const AnswerBench& bench, const Object& object) {
  const Object& still = still_of(bench.objects, object);
  for (const ScanRecord& scan : bench.scans)
    if (scan.lattice.spacing_mm() == still.bound.spacing_mm) {
      const voxel::LabelMap samples =
          voxel::label_map(scan.lattice, {&still.voxel.octree, 1}, {bench.stop, {}});
      const double doubt_mm3 = counting_doubt_mm3(samples.scene, 1.0, 1.0);
      if (!object.image || keeps_lengths(object.image->image_from_object)) return doubt_mm3;
      return std::abs(glm::determinant(glm::dmat3(object.image->image_from_object))) * doubt_mm3;
    }
  return std::nullopt;
}

Recommended of_voxels_alone(const AnswerBench& bench, const Object& object, const Digitised& digitised) {
  Recommended found{
      intervals_of_count(object.voxel.measures, digitised, bench.universe.lattice(), seen_size_of(object))};
  if (const std::optional<double> doubt_mm3 = counting_doubt_of(bench, object))
    add_counting(*doubt_mm3, found.intervals);
  return found;
}

/// The size of a mesh that comes from no scan. It is exact except for the rounding of its points.
Recommended of_mesh_alone(const brep::Solid& mesh) {
  constexpr double rounding = 1e-6;  // relative rounding, for points that a file stores in single precision
  const brep::Size& size = mesh.size();
  const auto exact = [](double value) {
    return verify::Interval{
        value, rounding * value, {{"points", "1e-6 of the value, by rounding", rounding * value}}};
  };
  Recommended found;
  found.intervals.volume_mm3 = exact(size.volume_mm3);
  found.intervals.area_mm2 = exact(size.area_mm2);
  found.intervals.triangles.area_mm2 = size.area_mm2;
  return found;
}

/// The intervals from the object's own surface, without regard to the object of which it is an image.
Recommended own_intervals_of(const AnswerBench& bench, const Object& object, const Digitised& digitised) {
  const glm::dvec3 voxel_mm = bench.universe.lattice().spacing_mm();
  if (object.is_surely_empty) return {};
  const bool is_of_scan = object.bound.spacing_mm != glm::dvec3(0.0);
  if (!object.mesh.within || (!is_of_scan && object.mesh.within->empty()))
    return of_voxels_alone(bench, object, digitised);
  if (!is_of_scan) return of_mesh_alone(*object.mesh.within);
  if (object.mesh.within->empty())
    return {verify::nothing_found(glm::max(object.bound.spacing_mm, voxel_mm))};
  std::vector<SurfaceSamples> sources;
  for (const Shown& window : object.bound.windows) {
    SurfaceSamples samples;
    samples.grey = window.grey;
    samples.samples = window.samples;
    samples.moved_from_still = window.moved_from_still;
    samples.window_shift_mm = digitised.shift_mm;
    samples.low = window.threshold;
    samples.high = window.high;
    for (const ScanRecord& scan : bench.scans) {
      if (scan.name != window.scan) continue;
      samples.lps_from_scan = scan.lattice.lps_from_voxel;
      samples.voxels_are_samples = on_samples(scan.lattice, window.grey.universe().lattice());
    }
    if (std::none_of(sources.begin(), sources.end(), [&](const SurfaceSamples& known) {
          return known.moved_from_still == samples.moved_from_still && known.low == samples.low &&
                 known.high == samples.high && known.lps_from_scan == samples.lps_from_scan;
        }))
      sources.push_back(std::move(samples));
  }
  if (sources.empty()) {
    SurfaceSamples samples;
    for (int axis = 0; axis < 3; ++axis) samples.lps_from_scan[axis] *= object.bound.spacing_mm[axis];
    samples.window_shift_mm = digitised.shift_mm;
    sources.push_back(std::move(samples));
  }
  Recommended found{intervals_of_surface(*object.mesh.within, sources)};
  if (const Shown* labels = label_window_of(bench, object))
    found.intervals =
        intervals_of_labels(*labels->samples, labels->threshold, labels->high, std::move(found.intervals));
  take_phases(bench, object, found);
  take_thickness(bench, object, found);
  add_voxels(voxel_mm, object.mesh.within->size().area_mm2, found.intervals);
  return found;
}

Recommended intervals_of(const AnswerBench& bench, const Object& object, const Digitised& digitised);

/// The intervals of an object before its motions. They are cached, because the object may have several
/// images.
const Recommended& kept_intervals_of(const AnswerBench& bench, const Object& still) {
  std::shared_ptr<const void>& kept = bench.kept["recommended size of " + still.id];
  if (!kept)
    kept = std::make_shared<const Recommended>(intervals_of(bench, still, digitised_of(bench, still)));
  return *static_cast<const Recommended*>(kept.get());
}

void scale(verify::Interval& interval, double value_factor, double width_factor) {
  interval.value *= value_factor;
  interval.half_width *= width_factor;
  for (verify::DoubtSource& source : interval.sources) source.half_width *= width_factor;
}

/// The sizes of a scaled or sheared image. Its volume and the volume's half-width change by the determinant.
/// Its area changes by the ratio of the two meshes' areas; without meshes, by the middle of the range that
/// the map allows. The area's half-width grows by at most the largest factor of areas.
Recommended deformed_intervals(Recommended found, const Deformation& deformation, const Object& still,
                               const Object& object) {
  const double volume_factor = std::abs(deformation.volume_factor);
  double area_factor = 0.5 * (deformation.least_area + deformation.greatest_area);
  double unknown_mm2 =
      0.5 * (deformation.greatest_area - deformation.least_area) * found.intervals.area_mm2.value;
  if (still.mesh.whole && object.mesh.whole && !still.mesh.whole->empty()) {
    area_factor = object.mesh.whole->size().area_mm2 / still.mesh.whole->size().area_mm2;
    unknown_mm2 = 0.0;
  }
  scale(found.intervals.volume_mm3, volume_factor, volume_factor);
  scale(found.intervals.area_mm2, area_factor, deformation.greatest_area);
  found.intervals.triangles.area_mm2 *= area_factor;
  if (unknown_mm2 > 0.0) {
    found.intervals.area_mm2.half_width += unknown_mm2;
    found.intervals.area_mm2.sources.push_back(
        {"directions", "half the range of the map's area factors", unknown_mm2, true});
  }
  return found;
}

/// The recommended volume and area. If there is a mesh, they come from it, because its cuts are exact. A part
/// of an object has the uncertainty of the whole object's windows. The image of a whole object gets that
/// object's values, scaled by the map, if the universe contains both, because the image's own voxels and
/// points were rounded once more. An object made from another object's surface has the uncertainty of that
/// surface.
Recommended intervals_of(const AnswerBench& bench, const Object& object, const Digitised& digitised) {
  if (object.image && object.image->is_whole) {
    const Object& still = still_of(bench.objects, object);
    const glm::dmat4& map = object.image->image_from_object;
    const Recommended& found = kept_intervals_of(bench, still);
    return keeps_lengths(map) ? found
                              : deformed_intervals(found, deformation_of(glm::dmat3(map)), still, object);
  }
  Recommended found = own_intervals_of(bench, object, digitised);
  const std::set<std::string> reshaped(object.bound.reshaped.begin(), object.bound.reshaped.end());
  for (const std::string& name : reshaped) {
    const Object& operand = bench.objects.at(name);
    const verify::SizeIntervals of = intervals_of(bench, operand, digitised_of(bench, operand)).intervals;
    if (!(of.area_mm2.value > 0.0)) continue;
    const auto add = [&](verify::Interval& interval, const char* formula, double half_width) {
      interval.half_width += half_width;
      interval.sources.push_back({"operand", formula, half_width, true});
    };
    const double share = found.intervals.area_mm2.value / of.area_mm2.value;
    add(found.intervals.volume_mm3, "half-width of the operand's volume, times the share of its area",
        share * of.volume_mm3.half_width);
    add(found.intervals.area_mm2, "half-width of the operand's area, times the share of this area",
        share * of.area_mm2.half_width);
  }
  return found;
}

Json points_json(const Measure& asked, const AnswerBench& bench) {
  const Digitised digitised = digitised_of(bench);
  std::vector<glm::dvec3> p;
  for (const Mark& mark : asked.points_mm) p.push_back(mark_mm(mark, bench.objects));
  if (p.size() == 2) {
    const HalfWidth width = distance_half_width({p[0], p[1]}, digitised);
    return print_record(MeasuredDistance{p, glm::distance(p[0], p[1]), width.value, width.terms});
  }
  const HalfWidth width = angle_half_width({p[0], p[1], p[2]}, digitised);
  const glm::dvec3 first = p[0] - p[1], last = p[2] - p[1];
  const double angle_deg =
      glm::degrees(std::atan2(glm::length(glm::cross(first, last)), glm::dot(first, last)));
  return print_record(MeasuredAngle{p, angle_deg, width.value, width.terms});
}

MeasuredGap measured_gap(const Measure& asked, const AnswerBench& bench) {
  const Object &object = bench.objects.at(asked.object->name), &other = bench.objects.at(asked.to->name);
  MeasuredGap made;
  made.object = object.id;
  made.to = other.id;
  if (object.voxel.octree.is_empty() || other.voxel.octree.is_empty()) {
    made.finding = "there is no gap: " + why_no_voxels(object.voxel.octree.is_empty() ? object : other);
    return made;
  }
  const Gap gap = gap_between(object.voxel.octree, other.voxel.octree, object.mesh.within, other.mesh.within);
  const HalfWidth width =
      gap_half_width(gap.to_mm - gap.from_mm, digitised_of(bench, object), digitised_of(bench, other));
  made.gap_mm = gap.voxel_mm;
  made.gap_mesh_mm = gap.mesh_mm;
  made.gap_half_width_mm = width.value;
  made.overlap_mm3 = gap.overlap_mm3;
  made.gap_estimator = "faces of the two voxels with the nearest centres";
  made.gap_half_width_terms = width.terms;
  made.from_mm = gap.from_mm;
  made.to_mm = gap.to_mm;
  return made;
}

MeasuredSize measured_size(const Measure& asked, const AnswerBench& bench) {
  const Object& object = bench.objects.at(asked.object->name);
  MeasuredSize made;
  made.object = object.id;
  made.voxel = size_of(object.voxel.measures);
  made.volume_mm3 = made.voxel.volume_mm3;
  made.volume_estimator = made.voxel.volume_estimator;
  made.centroid_mm = made.voxel.centroid_mm;
  const Digitised digitised = digitised_of(bench, object);
  const Recommended with_reason = intervals_of(bench, object, digitised);
  const verify::SizeIntervals& recommended = with_reason.intervals;
  made.volume = measured(recommended.volume_mm3, "mm3");
  made.area = measured(recommended.area_mm2, "mm2");
  const HalfWidth width = volume_half_width(object.voxel.measures, digitised, seen_size_of(object));
  made.volume_half_width_mm3 = width.value;
  made.volume_half_width_terms = width.terms;
  std::vector<std::string> findings =
      findings_of(recommended, with_reason.is_of_phases, with_reason.has_core,
                  {made.volume_mm3,
                   object.mesh.within ? std::optional(object.mesh.within->size().volume_mm3) : std::nullopt},
                  {object.voxel.measures.area_crofton13_mm2,
                   object.mesh.within ? std::optional(object.mesh.within->size().area_mm2) : std::nullopt});
  if (object.border_finding) findings.push_back(*object.border_finding);
  if (const auto finding = too_coarse_finding(object, width)) findings.insert(findings.begin(), *finding);
  for (const std::string& finding : findings)
    made.finding = made.finding ? *made.finding + "; " + finding : finding;
  if (!object.mesh.within) {
    made.area_mm2 = made.voxel.area_mm2;
    made.area_estimator = made.voxel.area_estimator;
    return made;
  }
  made.mesh = size_of(object.mesh.within->measures());
  made.area_mm2 = made.mesh->area_mm2;
  made.area_estimator = made.mesh->area_estimator;
  // The half-width of the triangles' area is the recommended half-width plus the difference of the two areas.
  // If voxels are too coarse, the recommended half-width already is this difference.
  const double off_mm2 = std::abs(recommended.area_mm2.value - made.mesh->area_mm2);
  const double doubt_mm2 = recommended.area_mm2.half_width;
  made.area_half_width_mm2 = doubt_mm2 == off_mm2 ? off_mm2 : doubt_mm2 + off_mm2;
  const double mesh_mm3 = made.mesh->volume_mm3;
  made.difference_mm3 = made.volume_mm3 - mesh_mm3;
  if (mesh_mm3 > 0.0) made.difference_percent = 100.0 * (made.volume_mm3 - mesh_mm3) / mesh_mm3;
  return made;
}

/// The requested measures of an object's mesh besides its size, as JSON; null with a finding if it has no
/// mesh.
Json surface_json(const Measure& asked, const AnswerBench& bench) {
  const Object& object = bench.objects.at(asked.object->name);
  Json json = print_record(measured_size(asked, bench));
  if (asked.thickness) {
    const Stopwatch watch(bench.timings, "thickness_voxel");
    json["thickness_voxel"] = thickness_json(object.voxel.octree, bench.progress("walls of " + object.id));
  }
  if (!object.mesh.within || object.mesh.within->empty()) {
    for (const auto& [key, is_asked] :
         {std::pair("section", !asked.section.empty()), std::pair("along", !asked.along.empty()),
          std::pair("thickness", asked.thickness), std::pair("curvature", asked.curvature)})
      if (is_asked) json[key] = nullptr;
    json["finding"] = "'" + object.id + "' has no mesh, see its findings";
    return json;
  }
  AtVertices shown;
  json.update(surface_answers({.section = asked.section,
                               .along = asked.along,
                               .thickness = asked.thickness,
                               .curvature = asked.curvature},
                              *object.mesh.within, bench.progress("measuring " + object.id), bench.timings,
                              shown));
  return json;
}

Json measure(const Measure& asked, const AnswerBench& bench) {
  if (asked.asks_surface()) return surface_json(asked, bench);
  return !asked.points_mm.empty() ? points_json(asked, bench)
         : asked.to               ? print_record(measured_gap(asked, bench))
                                  : print_record(measured_size(asked, bench));
}

}  // namespace

Operation measure_operation() {
  return Describe<Measure>("measure",
                           "Measures an object, the gap between two objects, a distance or an angle.",
                           Makes::Measurement)
      .takes(field("object", &Measure::object,
                   "The object whose volume, area and extents are measured; on the command line a scan or "
                   "grey octree (with "
                   "a window), an octree or a mesh.")
                 .positional("file"))
      .takes(field("to", &Measure::to,
                   "A second object. The gap between the two is measured instead of the sizes."))
      .takes(field("points_mm", &Measure::points_mm,
                   "Two points [x, y, z] or landmarks, whose distance is measured; or three, for the angle "
                   "at the second.")
                 .in_plans_only())
      .takes(field("section", &Measure::section,
                   "A point and a normal of a plane: the area and perimeter of the section in which it cuts "
                   "the surface.")
                 .from(2)
                 .to(2))
      .takes(field("along", &Measure::along, "Two points: the length of the shortest path along the surface.")
                 .from(2)
                 .to(2))
      .takes(field("thickness", &Measure::thickness,
                   "Local thickness of a mesh or an octree: at each point of the volume and of the surface, "
                   "the diameter of the largest ball inside that contains the point; also the thinnest wall "
                   "away from edges."))
      .takes(field("curvature", &Measure::curvature, "Mean and Gaussian curvature of the surface."))
      .verb_takes(field("distance", &Measure::distance, "Two points, whose straight distance is measured.")
                      .from(2)
                      .to(2))
      .verb_takes(field("angle", &Measure::angle, "Three points: the angle at the second one.").from(3).to(3))
      .verb_takes(field("window", &Measure::window,
                        "The samples of the object: LOW:HIGH or LOW: in sample units, or a tissue."))
      .verb_takes(
          field("voxel_mm", &Measure::voxel_mm,
                "Edge of a voxel. Default: the scan's finest spacing, with at most 512 voxels a side.")
              .greater_than(0.0)
              .read_if<Measure>(
                  [](const Measure& asked) { return !asked.object || !is_octree(asked.object->name); },
                  "does not apply to an .octree file, which already has voxels: leave it out"))
      .verb_takes(field("out", &Measure::out,
                        "A .vtp or .ply file for the mesh with thickness or curvature as scalars."))
      .reads_scans()
      .example(R"({"id": "maxilla_size", "do": "measure", "object": "maxilla"})")
      .on_files(
          "octotomy measure head.nrrd --window 300: --json\n"
          "  octotomy measure skull.octree\n"
          "  octotomy measure skull.stl --section 0,0,20 0,0,1 --thickness --json",
          measure_file)
      .check(check)
      .measure(measure);
}

}  // namespace octotomy::planner
