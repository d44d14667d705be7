// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "verify/form.h"
#include "voxel/lattice.h"

namespace octotomy::verify {

/// The solids a head phantom is made of. A point's tissue is decided in this order: outside the skin it is
/// headrest or air; then within `air` air, within `tooth_core` tooth, within `bone` bone, else soft. Bone
/// keeps at least two millimetres from all air, `tooth_core` as much from the surface of the teeth.
struct HeadForms {
  Form skin, bone, mandible, teeth, tooth_core, air, headrest;
};

/// Built once; a modern adult's proportions (Frankfurt plane horizontal, at z = -6), the same on both sides
/// but for a bony bump, an exostosis, at the angle of the mandible on the patient's left.
const HeadForms& head_forms();

/// Where a ball lies in the field that has a value at the ball's centre: decided where the value exceeds the
/// radius, by a millionth of it to cover rounding.
signed char place(double value, double radius_mm);

/// The forms pruned to each of the bricks that fill head_bounds(), so that a point or a small block meets a
/// handful of primitives instead of hundreds.
class HeadBricks {
 public:
  enum Field { Skin, Bone, ToothCore, Air, Headrest, Mandible, Teeth, field_count };
  using Fields = std::array<Form::Steps, field_count>;
  /// Where a ball lies in each field: all of it inside (1) or outside (0), or not decided (-1).
  using Places = std::array<signed char, field_count>;
  struct Brick {
    Fields steps;
    Places places;
  };

  /// Built once and kept.
  static const HeadBricks& instance();
  /// Steps and places that hold in a ball: few steps where its radius is at most margin_mm and its centre
  /// within head_bounds(), otherwise all, with nothing decided.
  const Brick& at(const glm::dvec3& p_mm, double radius_mm = 0.0) const;
  /// Edge of the cubic bricks.
  static constexpr double edge_mm = 8.0;
  /// How far beyond itself a brick's steps hold: enough for 4^3 voxels of 1 mm, or one of 4 mm, about a point
  /// of it.
  static constexpr double margin_mm = 3.5;

 private:
  HeadBricks();
  glm::ivec3 dims_{0};
  glm::dvec3 low_mm_{0.0};
  Brick whole_;
  std::vector<Brick> bricks_;
};

}  // namespace octotomy::verify
