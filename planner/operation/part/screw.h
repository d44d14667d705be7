// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/field.h"

// Screws as objects of a plan. Guides have holes for them before the cut; plates have holes where the plan's
// motions carry the screws.
namespace octotomy::planner {

struct Screw {
  ObjectName object;       ///< the bone or piece in which it sits
  std::optional<Mark> at;  ///< where its axis meets the surface
  std::optional<glm::dvec3> direction;
  std::optional<ObjectName> flap;  ///< in place of `at` and `direction`: a space of a flap, whose axis
                                   ///< the screw's axis meets
  double share = 0.5;              ///< where on the flap's axis
  /// The view of the head from whose side the screw is driven in. With `at` it replaces `direction`; with
  /// `flap` it refers to the segment at its new place.
  std::optional<std::string> side;
  double diameter_mm = 2.0, length_mm = 6.0;
  std::vector<ObjectName> away_from, cuts;
  double least_mm = 1.0;
  // Settled.
  glm::dvec3 head_mm{0.0}, tip_mm{0.0};
};

/// A screw's axis in its position after the plan's motions.
struct ScrewAxis {
  std::string screw;    ///< the name of the object
  std::string sits_in;  ///< the bone or piece of the plan
  glm::dvec3 head_mm{0.0};
  glm::dvec3 along{0.0, 1.0, 0.0};  ///< unit, from the head to the tip
  double diameter_mm = 2.0, length_mm = 6.0;
};

/// The axis of a screw of the plan, or of a screw that steps of the plan have moved. Throws
/// std::runtime_error, which names the object, if it is no screw.
ScrewAxis screw_axis(const std::string& name, const SettleBench& bench);

/// The distance of a screw from one object, in both kernels.
struct ScrewClear {
  std::string object;
  bool is_cut = false;
  double mesh_mm = 0.0;
  std::optional<double> voxel_mm;
};
/// The distances of a screw from objects, all at their places. Throws std::runtime_error if an object has no
/// mesh.
std::vector<ScrewClear> clear_of_objects(const ScrewAxis& axis, const std::vector<ObjectName>& away_from,
                                         const SettleBench& bench);
nlohmann::ordered_json to_json(const ScrewClear& clear);
/// The finding on a screw that is too near an object: "the screw comes within 0.4 mm of 'roots', ...";
/// `screw` is the sentence's subject. Empty if the distance is at least `least_mm`.
std::string too_near(const std::string& screw, const ScrewClear& clear, double least_mm);

/// The mesh of a rod between two points: a prism of 48 sides with the volume of the cylinder of this radius.
/// Preconditions: the points differ, and the radius is above 0.
brep::Solid rod(const glm::dvec3& from_mm, const glm::dvec3& to_mm, double radius_mm);

/// The distance of the hole in a mesh from a screw's axis: the centre of the circle fitted by least squares
/// to the hole's points. None if too few points are left for a fit.
std::optional<double> hole_off_mm(const brep::Solid& solid, const ScrewAxis& axis, double radius_mm);

}  // namespace octotomy::planner
