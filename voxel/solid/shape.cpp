// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/shape.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace octotomy::voxel {
namespace {

void need(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument(message);
}

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// A direction computed in double precision, then normalised, misses length 1 by a few units in the last
// place; one read from text with nine digits by 1e-9.
constexpr double unit_slack = 1e-8;

bool unit(const glm::dvec3& v) {
  return finite(v) && std::abs(glm::length(v) - 1.0) <= unit_slack;
}

bool rotation(const glm::dmat3& turn) {
  return unit(turn[0]) && unit(turn[1]) && unit(turn[2]) &&
         std::abs(glm::dot(turn[0], turn[1])) <= unit_slack &&
         std::abs(glm::dot(turn[0], turn[2])) <= unit_slack &&
         std::abs(glm::dot(turn[1], turn[2])) <= unit_slack;
}

void positive(const std::string& what, double length_mm) {
  need(std::isfinite(length_mm) && length_mm > 0.0,
       what + " must be a positive number of millimetres, not " + std::to_string(length_mm));
}

void check(const Sphere& sphere) {
  need(finite(sphere.centre_mm), "a sphere's centre has a coordinate that is not a finite number");
  positive("a sphere's radius", sphere.radius_mm);
}

void check(const Ellipsoid& ellipsoid) {
  need(finite(ellipsoid.centre_mm), "an ellipsoid's centre has a coordinate that is not a finite number");
  for (int axis = 0; axis < 3; ++axis) positive("an ellipsoid's radius", ellipsoid.radii_mm[axis]);
  need(rotation(ellipsoid.lps_from_axes), "an ellipsoid's axes must be unit vectors at right angles");
}

void check(const Box& box) {
  need(finite(box.low_mm) && finite(box.high_mm), "a box has a coordinate that is not a finite number");
  for (int axis = 0; axis < 3; ++axis) positive("a box's edge", box.high_mm[axis] - box.low_mm[axis]);
}

void check(const OrientedBox& box) {
  need(finite(box.centre_mm), "a box's centre has a coordinate that is not a finite number");
  for (int axis = 0; axis < 3; ++axis) positive("half a box's edge", box.half_mm[axis]);
  need(rotation(box.lps_from_axes), "a box's axes must be unit vectors at right angles");
}

void check(const HalfSpace& half_space) {
  need(unit(half_space.normal), "a half-space's normal must be a unit vector");
  need(std::isfinite(half_space.offset_mm), "a half-space's offset is not a finite number");
}

void check(const Cylinder& cylinder) {
  need(finite(cylinder.from_mm) && finite(cylinder.to_mm),
       "a cylinder's end has a coordinate that is not a finite number");
  positive("a cylinder's length", glm::distance(cylinder.from_mm, cylinder.to_mm));
  positive("a cylinder's radius", cylinder.radius_mm);
}

void check(const Torus& torus) {
  need(finite(torus.centre_mm), "a torus's centre has a coordinate that is not a finite number");
  need(unit(torus.axis), "a torus's axis must be a unit vector");
  positive("a torus's tube radius", torus.tube_radius_mm);
  positive("a torus's ring radius less its tube radius", torus.ring_radius_mm - torus.tube_radius_mm);
}

void check(const Prism& prism) {
  check(RegionMask{{prism.region}});
  need(rotation(glm::dmat3(prism.region.view.right, prism.region.view.up, prism.region.view.look)),
       "a prism's view must have unit vectors at right angles");
  need(std::isfinite(prism.low_mm) && std::isfinite(prism.high_mm), "a prism's depth is not a finite number");
  positive("a prism's height", prism.high_mm - prism.low_mm);
}

}  // namespace

Shape::Shape(const Primitive& primitive) : parts_{{primitive, false}} {
  std::visit([](const auto& solid) { check(solid); }, primitive);
}

Shape operator~(Shape shape) {
  if (shape.parts_.size() == 1 && !shape.complement_)
    shape.parts_.front().complement = !shape.parts_.front().complement;
  else
    shape.complement_ = !shape.complement_;
  return shape;
}

Shape operator&(const Shape& a, const Shape& b) {
  need(!a.complement_ && !b.complement_,
       "the complement of an intersection cannot be intersected: digitise it and combine the octrees");
  Shape both = a;
  both.parts_.insert(both.parts_.end(), b.parts_.begin(), b.parts_.end());
  return both;
}

}  // namespace octotomy::voxel
