// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "verify/phantom/implicit_solid.h"
#include "voxel/space/lattice.h"

namespace octotomy::verify {

/// The solids of the head phantom. The first rule that applies determines a point's tissue: outside the skin
/// it is headrest or air; within `air` it is air, within `tooth_core` tooth, within `bone` bone; everywhere
/// else it is soft tissue. Bone is two millimetres or more away from all air, and `tooth_core` from the
/// surface of the teeth.
struct HeadSolids {
  ImplicitSolid skin, bone, mandible, teeth, tooth_core, air, headrest;
};

/// Returns the solids, which are built at the first call. The head has a modern adult's proportions
/// (Frankfurt plane horizontal, at z = -6). It is symmetric except for an exostosis at the angle of the
/// mandible on the patient's left.
const HeadSolids& head_solids();

/// Whether a ball lies inside (1) or outside (0) a field. `value` is the field's value at the ball's centre.
/// Undecided (-1) unless |value| exceeds the radius by a millionth, which covers rounding.
signed char place(double value, double radius_mm);

/// The solids pruned to each of the bricks that fill head_bounds(), so that a point or a small block
/// evaluates a handful of primitives instead of hundreds.
class HeadBricks {
 public:
  enum Field { Skin, Bone, ToothCore, Air, Headrest, Mandible, Teeth, field_count };
  using Fields = std::array<ImplicitSolid::Steps, field_count>;
  /// For each field the result of place() for one ball.
  using Places = std::array<signed char, field_count>;
  struct Brick {
    Fields steps;
    Places places;
  };

  /// Built once and kept.
  static const HeadBricks& instance();
  /// Returns steps and places that are valid in a ball around `p_mm`. The steps are pruned if the radius is
  /// at most margin_mm and the centre is within head_bounds(). Otherwise they are all steps, and no field is
  /// decided.
  const Brick& at(const glm::dvec3& p_mm, double radius_mm = 0.0) const;
  /// Edge of the cubic bricks.
  static constexpr double edge_mm = 8.0;
  /// The margin around a brick in which its steps are valid: enough for 4^3 voxels of 1 mm, or one voxel of 4
  /// mm, around a point of the brick.
  static constexpr double margin_mm = 3.5;

 private:
  HeadBricks();
  glm::ivec3 dims_{0};
  glm::dvec3 low_mm_{0.0};
  Brick whole_;
  std::vector<Brick> bricks_;
};

}  // namespace octotomy::verify
