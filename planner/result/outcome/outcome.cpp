// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Compute the surface of the later scan.
// 2 Fit the bone that did not move to it: after_from_before.
// 3 Fit each piece to it, starting at its planned position transformed by 2. The achieved motion is the
//   inverse of 2 times 3.
// 4 Compute intervals from both fits' covariances and the deviation of their residuals, which includes the
//   noise of both scans. A sample represents two samples of the scan a side, because the noise of neighbours
//   is correlated. Adds a systematic error: a lattice shifts an isosurface by some hundredths of its spacing,
//   equally wherever bone is flat.
#include "planner/result/outcome/outcome.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "brep/align/register_surfaces.h"
#include "brep/mesh/error.h"
#include "brep/mesh/triangles.h"
#include "convert/surface/isosurface.h"
#include "planner/operation/anatomy/movement.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/deformation.h"
#include "planner/operation/table/number_format.h"
#include "verify/interval/size_interval.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

constexpr double deviations = 2.5758;  ///< of a normal distribution: half-width that contains 99 %
constexpr double lattice_share = 0.03;
constexpr std::size_t samples = 5000;

/// An object that the plan moves: its last position, its position before the first rigid motion, and the
/// motion between both.
struct MovedObject {
  const Object* moved;
  const Object* still;
  glm::dmat4 motion;
};

/// Whether an object was made by a rigid motion. An object that was scaled or sheared counts as new, so that
/// its later motions are rigid.
bool moves_rigidly(const Object& object) {
  return object.moved && is_rigid(object.moved->motion);
}

std::vector<MovedObject> pieces_of(const Objects& objects) {
  std::vector<MovedObject> pieces;
  for (const Object& object : objects) {
    if (!moves_rigidly(object)) continue;
    const Object* still = &object;
    glm::dmat4 motion(1.0);
    for (; moves_rigidly(*still); still = &objects.at(still->moved->object)) motion *= still->moved->motion;
    const MovedObject piece{&object, still, motion};
    const auto same = std::find_if(pieces.begin(), pieces.end(),
                                   [&](const MovedObject& other) { return other.still == still; });
    if (same == pieces.end())
      pieces.push_back(piece);
    else
      *same = piece;
  }
  if (pieces.empty())
    throw std::runtime_error("the plan moves no object rigidly, so that there is no outcome to compare");
  return pieces;
}

bool shares_bone(const Object& object, const Object& piece) {
  return !voxel::combine(object.voxel.octree.universe(),
                         voxel::Expression(object.voxel.octree) & voxel::Expression(piece.voxel.octree))
              .is_empty();
}

/// The largest object from a scan that shares no bone with a moved piece. If there is none, the largest
/// object from a scan.
const Object& unmoved_of(const Objects& objects, const std::vector<MovedObject>& pieces,
                         const std::string& asked) {
  if (!asked.empty()) return objects.at(asked);
  const Object* best = nullptr;
  for (const bool apart : {true, false}) {
    for (const Object& object : objects) {
      if (object.is_tool || object.moved || !object.shown || !object.mesh.whole) continue;
      if (apart && std::any_of(pieces.begin(), pieces.end(),
                               [&](const MovedObject& piece) { return shares_bone(object, *piece.still); }))
        continue;
      if (best == nullptr || object.voxel.measures.volume_mm3 > best->voxel.measures.volume_mm3)
        best = &object;
    }
    if (best != nullptr) return *best;
  }
  throw std::runtime_error("the plan has no bone that does not move: name one by --unmoved");
}

const brep::Solid& solid_of(const Object& object) {
  if (!object.mesh.whole || object.mesh.whole->empty())
    throw std::runtime_error("'" + object.id + "' has no mesh to fit to the later scan");
  return *object.mesh.whole;
}

/// A fit of two surfaces, with the standard deviation of one sample's distance.
struct Laid {
  brep::SurfaceFit fit;
  double deviation_mm = 0.0;
  double lattice_mm = 0.0;

  double half_width_mm(const glm::dvec3& p_mm, const glm::dvec3& along) const {
    return std::hypot(deviations * deviation_mm * fit.doubt.deviation(p_mm, along), lattice_mm);
  }
  double turn_half_width_deg(const glm::dvec3& axis) const {
    return glm::degrees(std::hypot(deviations * deviation_mm * fit.doubt.turn_deviation(axis),
                                   lattice_mm / fit.doubt.spread_mm));
  }
};

Laid laid(const brep::Solid& moving, const brep::Mesh& fixed, const std::optional<glm::dmat4>& start,
          double sample_mm, const OutcomeOptions& options) {
  brep::SurfaceFitOptions fit;
  fit.start = start;
  fit.samples = samples;
  fit.stop = options.progress.stop;
  try {
    Laid made{brep::register_surfaces(moving.mesh(), fixed, fit), 0.0, lattice_share * sample_mm};
    const double each_mm2 = moving.measures().area_mm2 / static_cast<double>(samples);
    const double independent = std::min(1.0, each_mm2 / (4.0 * sample_mm * sample_mm));
    made.deviation_mm = made.fit.rms_mm / std::sqrt(independent);
    return made;
  } catch (const brep::Error&) {
    if (options.progress.stop.stop_requested())
      throw voxel::Stopped("stopped while surfaces were registered");
    throw;
  }
}

PointOutcome point_outcome(const std::string& name, const glm::dvec3& p_mm, const PieceOutcome& piece,
                           const glm::dmat3& head, const Laid& whole, const Laid& part) {
  const glm::dvec3 planned = carried(piece.planned, p_mm), achieved = carried(piece.achieved, p_mm);
  const glm::dmat3 turned(whole.fit.fixed_from_moving);
  const glm::dvec3 at = carried(whole.fit.fixed_from_moving, achieved);
  const auto half_width = [&](const glm::dvec3& direction) {
    const glm::dvec3 along = turned * direction;
    return std::hypot(whole.half_width_mm(at, along), part.half_width_mm(at, along));
  };
  return {name,
          displacement_of(planned - p_mm, head),
          displacement_of(achieved - p_mm, head),
          {half_width(head[1]), half_width(head[0]), half_width(head[2])},
          glm::distance(planned, achieved)};
}

Turns turn_half_width(const glm::dmat3& head, const Laid& whole, const Laid& part) {
  const glm::dmat3 turned(whole.fit.fixed_from_moving);
  const auto about = [&](int axis) {
    const glm::dvec3 along = turned * head[axis];
    return std::hypot(whole.turn_half_width_deg(along), part.turn_half_width_deg(along));
  };
  return {about(0), about(2), about(1)};
}

Json to_json(const Displacement& by) {
  return {{"forward_mm", by.forward_mm}, {"left_mm", by.left_mm}, {"up_mm", by.up_mm}};
}
Json to_json(const Turns& turns) {
  return {{"pitch_deg", turns.pitch_deg}, {"yaw_deg", turns.yaw_deg}, {"roll_deg", turns.roll_deg}};
}
template <typename Told>
Json told(const Told& value) {
  Json json = to_json(value);
  json["words"] = in_words(value);
  return json;
}

/// A warning if the lower bound of labels is a whole number. The surface then passes through the centres of
/// samples. None for other bounds and samples.
std::optional<std::string> bound_finding(const voxel::Scene& after, double low) {
  const voxel::Range range = voxel::range(after);
  const bool are_labels = after.meaning == voxel::Meaning::Label || (range.low == 0.0 && range.high == 1.0);
  if (!are_labels || low != std::floor(low)) return std::nullopt;
  return "WARN low: the later scan's samples are labels, and with a lower bound of " + plain(low) +
         " its surface passes through the centres of the outermost voxels, half a voxel inside: give --low " +
         plain(low - 0.5);
}

}  // namespace

Outcome outcome_of(const Plan& plan, const Evaluation& evaluation, const voxel::Scene& after,
                   const OutcomeOptions& options) {
  const Objects& objects = evaluation.objects;
  const std::vector<MovedObject> pieces = pieces_of(objects);
  const Object& unmoved = unmoved_of(objects, pieces, options.unmoved);
  if (!options.low && !unmoved.shown)
    throw std::runtime_error(
        "'" + unmoved.id + "' does not come from a window of a scan: give the lower bound of bone by --low");
  const double low = options.low.value_or(unmoved.shown ? unmoved.shown->threshold : 0.0);
  const brep::Mesh surface = brep::mesh_of(
      convert::isosurface(after, low, std::numeric_limits<double>::infinity(), {options.progress.stop, {}}));
  if (surface.n_faces() == 0)
    throw std::runtime_error("the later scan has no sample of " + std::to_string(low) +
                             " or more: give its lower bound of bone by --low");
  const glm::dvec3 spacing_mm = after.lattice.spacing_mm();
  const double sample_mm = std::cbrt(spacing_mm.x * spacing_mm.y * spacing_mm.z);
  const Laid whole = laid(solid_of(unmoved), surface, {}, sample_mm, options);
  Outcome outcome{unmoved.id,           whole.fit.fixed_from_moving, whole.fit.rms_mm,
                  whole.fit.kept_share, whole.fit.findings,          {}};
  if (auto finding = bound_finding(after, low)) outcome.findings.push_back(std::move(*finding));
  const std::vector<MovedLandmark> landmarks = moved_landmarks(objects, plan.landmarks);
  const glm::dmat3& head = objects.lps_from_head;
  for (const MovedObject& piece : pieces) {
    const Laid part =
        laid(solid_of(*piece.still), surface, outcome.after_from_before * piece.motion, sample_mm, options);
    PieceOutcome made;
    made.object = piece.moved->id;
    made.still = piece.still->id;
    made.planned = piece.motion;
    made.achieved = glm::inverse(outcome.after_from_before) * part.fit.fixed_from_moving;
    made.planned_turns = turns_of(glm::dmat3(made.planned), head);
    made.achieved_turns = turns_of(glm::dmat3(made.achieved), head);
    made.turn_half_width = turn_half_width(head, whole, part);
    made.rms_mm = part.fit.rms_mm;
    made.kept_share = part.fit.kept_share;
    made.findings = part.fit.findings;
    if (const std::optional<glm::dvec3>& centre = piece.still->voxel.measures.centroid_mm)
      made.points.push_back(point_outcome(made.object, *centre, made, head, whole, part));
    // A landmark moves with a piece if it has the same motion since the scan, which includes steps that
    // scaled the piece.
    const glm::dmat4 still_from_scan = moved_since_made(objects, piece.still->id);
    const glm::dmat4 since_scan = moved_since_made(objects, piece.moved->id);
    for (const MovedLandmark& landmark : landmarks)
      if (landmark.moved_from_still == since_scan && since_scan != glm::dmat4(1.0))
        made.points.push_back(point_outcome(landmark.landmark.name,
                                            carried(still_from_scan, landmark.landmark.p_mm), made, head,
                                            whole, part));
    outcome.pieces.push_back(std::move(made));
    if (options.progress.report)
      options.progress.report(static_cast<double>(outcome.pieces.size()) /
                              static_cast<double>(pieces.size()));
  }
  return outcome;
}

Json to_json(const Outcome& outcome) {
  Json json{{"unmoved",
             {{"object", outcome.unmoved},
              {"after_from_before", to_json(outcome.after_from_before)},
              {"rms_mm", outcome.rms_mm},
              {"kept_share", outcome.kept_share},
              {"findings", outcome.findings}}},
            {"coverage", verify::claimed_coverage},
            {"pieces", Json::array()}};
  for (const PieceOutcome& piece : outcome.pieces) {
    Json points = Json::array();
    for (const PointOutcome& point : piece.points)
      points.push_back({{"name", point.name},
                        {"planned", told(point.planned)},
                        {"achieved", told(point.achieved)},
                        {"half_width", to_json(point.half_width)},
                        {"off_mm", point.off_mm}});
    json["pieces"].push_back({{"object", piece.object},
                              {"still", piece.still},
                              {"planned", told(piece.planned_turns)},
                              {"achieved", told(piece.achieved_turns)},
                              {"half_width", to_json(piece.turn_half_width)},
                              {"planned_matrix", to_json(piece.planned)},
                              {"achieved_matrix", to_json(piece.achieved)},
                              {"points", points},
                              {"rms_mm", piece.rms_mm},
                              {"kept_share", piece.kept_share},
                              {"findings", piece.findings}});
  }
  return json;
}

}  // namespace octotomy::planner
