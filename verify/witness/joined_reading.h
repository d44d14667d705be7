// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "verify/witness/reading.h"

// Computes the reading of a Boolean from the readings of its operands.
namespace octotomy::verify {

inline AllowedSides negated(const AllowedSides& a) {
  return {a.out, a.in, a.near, a.chosen};
}

/// Whether the result is open only by choices of parts: a choice opens every operand that is open.
inline bool by_choice(const AllowedSides& a, const AllowedSides& b) {
  return (a.chosen || b.chosen) && (a.chosen || !a.is_open()) && (b.chosen || !b.is_open());
}

inline AllowedSides conjunction(const AllowedSides& a, const AllowedSides& b) {
  const bool in = a.in && b.in, out = a.out || b.out;
  return {in, out, in && out && ((a.near && b.in) || (b.near && a.in)), in && out && by_choice(a, b)};
}

/// The sides of an exclusive or. It has a surface wherever one of the operands has one.
inline AllowedSides exclusive(const AllowedSides& a, const AllowedSides& b) {
  return {(a.in && b.out) || (a.out && b.in), (a.in && b.in) || (a.out && b.out), a.near || b.near,
          by_choice(a, b)};
}

inline Reading negated(const Reading& a) {
  return {negated(a.voxel), negated(a.mesh), a.surfaces};
}

inline Reading conjunction(const Reading& a, const Reading& b) {
  return {conjunction(a.voxel, b.voxel), conjunction(a.mesh, b.mesh), a.surfaces + b.surfaces};
}
inline Reading exclusive(const Reading& a, const Reading& b) {
  return {exclusive(a.voxel, b.voxel), exclusive(a.mesh, b.mesh), a.surfaces + b.surfaces};
}

}  // namespace octotomy::verify
