// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/field.h"

// Screws as objects of a plan. Guides have holes for them before the cut. Plates have holes for them in their
// positions after the plan's motions.
namespace octotomy::planner {

struct Screw {
  ObjectName object;       ///< the bone or piece in which it sits
  std::optional<Mark> at;  ///< the point at which its axis meets the bone's surface
  std::optional<glm::dvec3> direction;
  std::optional<ObjectName> flap;  ///< instead of `at` and `direction`: the space of a flap; the screw's axis
                                   ///< meets the axis of this space
  double share = 0.5;              ///< position on the flap's axis, see flap_place()
  /// The view from whose side the screw enters, relative to the head's position. With `at` it replaces
  /// `direction`; with `flap` it is relative to the segment in its new place.
  std::optional<std::string> side;
  double diameter_mm = 2.0, length_mm = 6.0;
  std::vector<ObjectName> away_from, cuts;
  double least_mm = 1.0;
  // Settled.
  glm::dvec3 head_mm{0.0}, tip_mm{0.0};
};

/// The axis of a screw in its position after the plan's motions.
struct ScrewAxis {
  std::string screw;    ///< name of the screw's object
  std::string sits_in;  ///< name of the bone or piece in which it sits
  glm::dvec3 head_mm{0.0};
  glm::dvec3 along{0.0, 1.0, 0.0};  ///< unit, from the head to the tip
  double diameter_mm = 2.0, length_mm = 6.0;
};

/// The axis of a screw of the plan, or of a screw that steps of the plan have moved. Throws
/// std::runtime_error that names the object if it is not a screw.
ScrewAxis screw_axis(const std::string& name, const SettleBench& bench);

/// The distance of a screw from one object or cut, measured by each kernel.
struct ScrewClear {
  std::string object;
  bool is_cut = false;
  double mesh_mm = 0.0;
  std::optional<double> voxel_mm;
};
/// The distances of a screw from objects, all in their positions in the plan. Throws std::runtime_error if an
/// object has no mesh.
std::vector<ScrewClear> clear_of_objects(const ScrewAxis& axis, const std::vector<ObjectName>& away_from,
                                         const SettleBench& bench);
nlohmann::ordered_json to_json(const ScrewClear& clear);
/// The finding on a screw that is too near an object: "the screw comes within 0.4 mm of 'roots', ...".
/// `screw` is the subject of the sentence. Empty if the distance is at least `least_mm`.
std::string too_near(const std::string& screw, const ScrewClear& clear, double least_mm);

/// The mesh of a rod between two points: a prism with 48 sides and the volume of a cylinder of this radius.
/// Preconditions: the points differ, and the radius is above 0.
brep::Solid rod(const glm::dvec3& from_mm, const glm::dvec3& to_mm, double radius_mm);

/// The distance in mm of a screw's axis from the centre of its hole in a mesh. The centre is that of the
/// circle that fits the hole's points by least squares. None if there are too few points for a fit.
std::optional<double> hole_off_mm(const brep::Solid& solid, const ScrewAxis& axis, double radius_mm);

}  // namespace octotomy::planner
