// SPDX-License-Identifier: AGPL-3.0-or-later
// The surgeon's figures of a free flap: its segments in order, their lengths and angles, the cuts on the
// donor, and the area of contact at every osteotomy. A contact area is the volume that both bones share
// within a slab around the cut, divided by the slab's thickness. This volume is an object, so that both
// kernels compute it and it has a certificate.
#include <algorithm>
#include <cmath>

#include "planner/operation/flap/fields.h"
#include "planner/operation/flap/measured_flap.h"
#include "planner/operation/table/operation.h"
#include "verify/certificate/certificate.h"

namespace octotomy::planner {
namespace {

struct Flap : FlapFields {
  std::vector<ObjectName> segments, contacts;
  double slab_mm = 2.0;
};

void check(const Flap& flap, const FieldLocation& place) {
  check_flap(flap, place);
  const std::size_t count = flap.curve.size() - 1;
  if (flap.segments.size() != count)
    place.at("segments").refuse("must name " + std::to_string(count) + " objects, one a segment");
  if (flap.contacts.size() != count + 1 && flap.contacts.size() != count)
    place.at("contacts")
        .refuse(
            "must name " + std::to_string(count + 1) +
            " objects, one for each osteotomy; if the new bone has a free end, leave out the last object");
}

std::optional<std::string> verdict_of(const Object& object) {
  if (!object.certificate) return std::nullopt;
  return verify::to_string(object.certificate->verdict);
}

MeasuredSegment measured(const FlapSegment& segment, const Object& object, int number) {
  const auto cut = [](const FlapPlane& plane, double at_mm, double tilt_deg) {
    return DonorCut{at_mm, tilt_deg, plane.point_mm, plane.normal};
  };
  return {number,
          object.id,
          segment.length_mm,
          segment.shortest_mm,
          segment.longest_mm,
          number == 1 ? std::nullopt : std::optional(segment.turn_deg),
          object.voxel.measures.volume_mm3,
          verdict_of(object),
          cut(segment.donor_start, segment.donor_start_mm, segment.start_tilt_deg),
          cut(segment.donor_end, segment.donor_end_mm, segment.end_tilt_deg)};
}

/// The largest error of a contact area that the slab's thickness causes. Within the slab the bones diverge on
/// either side by the tangent of half their angle. For equal convex sections that extend at most `reach_mm`
/// to each side, the mean area over the slab is too small by at most this error.
double drift_mm2(const Flap& flap, double turn_deg) {
  const double mean_shift_mm = 0.25 * flap.slab_mm * 2.0 * std::tan(glm::radians(0.5 * turn_deg));
  return mean_shift_mm * 2.0 * flap.reach_mm;
}

MeasuredOsteotomy measured(const Flap& flap, const Object& object, const std::vector<FlapSegment>& segments,
                           std::size_t cut) {
  const auto side = [&](std::size_t number) {
    return number == 0 || number > segments.size() ? "bone" : flap.segments[number - 1].name;
  };
  MeasuredOsteotomy made;
  made.number = static_cast<int>(cut) + 1;
  made.object = object.id;
  made.between = {side(cut), side(cut + 1)};
  made.contact_voxels_mm2 = made.contact_mm2 = object.voxel.measures.volume_mm3 / flap.slab_mm;
  if (object.mesh.within)
    made.contact_mesh_mm2 = made.contact_mm2 = object.mesh.within->size().volume_mm3 / flap.slab_mm;
  if (object.certificate) made.tolerance_mm2 = object.certificate->tolerance_mm3 / flap.slab_mm;
  made.verdict = verdict_of(object);
  const bool is_inner = cut > 0 && cut < segments.size();
  if (is_inner) made.slab_lacks_at_most_mm2 = drift_mm2(flap, segments[cut].turn_deg);
  if (object.voxel.octree.is_empty())
    made.finding = "the two bones do not meet here: move the corner, or the donor's start";
  return made;
}

Json measure(const Flap& flap, const AnswerBench& bench) {
  const std::vector<FlapSegment> segments = segments_of(flap);
  MeasuredFlap made;
  for (std::size_t i = 0; i < segments.size(); ++i)
    made.flap_segments.push_back(
        measured(segments[i], bench.objects.at(flap.segments[i].name), static_cast<int>(i) + 1));
  for (std::size_t cut = 0; cut < flap.contacts.size(); ++cut)
    made.osteotomies.push_back(measured(flap, bench.objects.at(flap.contacts[cut].name), segments, cut));
  made.donor_used_mm = segments.back().donor_end_mm - segments.front().donor_start_mm;
  made.contact_estimator = "contact area: the common volume of both bones within " +
                           Json(flap.slab_mm).dump() + " mm about the cut, divided by this thickness";
  return print_record(made);
}

}  // namespace

Operation flap_operation() {
  Describe<Flap> entry("flap", "Reports the segments of a free flap: their order, cuts and contact areas.",
                       Makes::Measurement);
  for (Field& each : flap_fields<Flap>()) std::move(entry).takes(std::move(each));
  return std::move(entry)
      .takes(field("segments", &Flap::segments, "The placed segments, in order along the curve.").required())
      .takes(field("contacts", &Flap::contacts,
                   "The common volume of both bones in each osteotomy's slab, in order along the curve. If "
                   "the new bone ends freely, as in a joint, leave out the last slab.")
                 .required())
      .takes(field("slab_mm", &Flap::slab_mm, "The thickness of the slabs in 'osteotomies'.")
                 .greater_than(0)
                 .to(10))
      .example(R"({"id": "flap", "do": "flap", "segments": ["skull"], "contacts": ["skull", "skull"],
        "curve": [[-30, -60, -80], [0, -80, -85]],
        "donor": [[30, 12, 90], [33, 15, -90]], "face": [45, 12, 90]})")
      .check(check)
      .measure(measure);
}

}  // namespace octotomy::planner
