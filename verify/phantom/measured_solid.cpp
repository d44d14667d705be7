// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/measured_solid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "verify/phantom/implicit_solid.h"

namespace octotomy::verify {
namespace {

using std::numbers::pi;
using voxel::Expression;
using voxel::HalfSpace;

glm::dmat3 any_turn(Chance& chance) {
  return turned(360.0 * glm::dvec3(chance.even(), chance.even(), chance.even()));
}
/// The axes of the lattice, rotated among each other at random; they stay right-handed.
glm::dmat3 any_axes(Chance& chance) {
  glm::dmat3 axes(1.0);
  const int first = static_cast<int>(chance.between(0.0, 3.0)) % 3;
  return {axes[first], axes[(first + 1) % 3], axes[(first + 2) % 3]};
}

/// The pose and size of a solid, and the solid as far as it is built.
struct Pose {
  SolidPhantom made;
  glm::dmat3 axes{1.0};  ///< columns: the solid's own axes in LPS
  glm::dvec3 at_mm{0.0};
  double radius_mm = 1.0;
  Chance& chance;

  HalfSpace below(const glm::dvec3& own_normal, double from_centre_mm) const {
    const glm::dvec3 normal = axes * own_normal;
    return {normal, glm::dot(normal, at_mm) + from_centre_mm};
  }
  SolidPhantom is(Expression shape, double volume_mm3, double area_mm2) {
    made.shape = std::move(shape);
    made.volume_mm3 = volume_mm3;
    made.area_mm2 = area_mm2;
    made.centroid_mm = at_mm;
    return std::move(made);
  }
};

SolidPhantom box(Pose& pose) {
  const glm::dvec3 half =
      pose.radius_mm * glm::dvec3(1.0, pose.chance.between(0.7, 1.0), pose.chance.between(0.65, 0.9)) / 1.3;
  return pose.is(voxel::OrientedBox{pose.at_mm, half, pose.axes}, 8.0 * half.x * half.y * half.z,
                 8.0 * (half.x * half.y + half.y * half.z + half.z * half.x));
}

/// The part of a ball below a plane perpendicular to the pose's z axis.
SolidPhantom cap(Pose& pose) {
  const double r = pose.radius_mm, h = pose.chance.between(0.8, 1.5) * r;
  return pose.is(Expression(voxel::Sphere{pose.at_mm, r}) & pose.below({0, 0, 1}, h - r),
                 pi * h * h * (r - h / 3.0), 2.0 * pi * r * h + pi * h * (2.0 * r - h));
}

/// The part of a ball between two half planes that meet in a line through its centre.
SolidPhantom lune(Pose& pose) {
  const double r = pose.radius_mm, angle = pose.chance.between(0.5, 0.9) * pi;
  const glm::dvec3 other(-std::sin(angle), std::cos(angle), 0.0);
  return pose.is(
      Expression(voxel::Sphere{pose.at_mm, r}) & pose.below({0, -1, 0}, 0.0) & pose.below(other, 0.0),
      2.0 / 3.0 * angle * r * r * r, 2.0 * angle * r * r + pi * r * r);
}

/// A cylinder halved by a plane through its centre, perpendicular to the pose's z axis, that meets only its
/// wall.
SolidPhantom halved_cylinder(Pose& pose) {
  const double r = 0.6 * pose.radius_mm, height = 1.6 * pose.radius_mm;
  const double tilt = pose.chance.between(0.1, 0.8) * std::atan(0.5 * height / r);
  const glm::dvec3 along = pose.axes * glm::dvec3(std::sin(tilt), 0.0, std::cos(tilt));
  return pose.is(
      Expression(voxel::Cylinder{pose.at_mm - 0.5 * height * along, pose.at_mm + 0.5 * height * along, r}) &
          pose.below({0, 0, 1}, 0.0),
      0.5 * pi * r * r * height, pi * r * r + pi * r * height + pi * r * r / std::cos(tilt));
}

/// A box halved by a plane through its centre and its y axis, perpendicular to the pose's z axis.
SolidPhantom halved_box(Pose& pose) {
  const glm::dvec3 half = pose.radius_mm * glm::dvec3(0.7, pose.chance.between(0.6, 0.8), 0.8);
  const double tilt = pose.chance.between(0.1, 0.8) * std::atan(half.z / half.x);
  const glm::dmat3 lean(std::cos(tilt), 0.0, -std::sin(tilt), 0.0, 1.0, 0.0, std::sin(tilt), 0.0,
                        std::cos(tilt));
  return pose.is(
      Expression(voxel::OrientedBox{pose.at_mm, half, pose.axes * lean}) & pose.below({0, 0, 1}, 0.0),
      4.0 * half.x * half.y * half.z,
      4.0 * (half.x * half.y + half.y * half.z + half.z * half.x) + 4.0 * half.x * half.y / std::cos(tilt));
}

SolidPhantom torus(Pose& pose) {
  const double ring = 0.6 * pose.radius_mm, tube = 0.35 * pose.radius_mm;
  return pose.is(voxel::Torus{pose.at_mm, pose.axes[2], ring, tube}, 2.0 * pi * pi * ring * tube * tube,
                 4.0 * pi * pi * ring * tube);
}

SolidPhantom plate(Pose& pose, double longest_mm) {
  const glm::dvec3 half(pose.radius_mm, 0.75 * pose.radius_mm,
                        0.5 * pose.chance.between(2.0, 4.0) * longest_mm);
  return pose.is(voxel::OrientedBox{pose.at_mm, half, pose.axes}, 8.0 * half.x * half.y * half.z,
                 8.0 * (half.x * half.y + half.y * half.z + half.z * half.x));
}

SolidPhantom shell(Pose& pose, double longest_mm) {
  const double r = pose.radius_mm;
  const double inner = std::max(r - pose.chance.between(2.0, 4.0) * longest_mm, 0.3 * r);
  return pose.is(Expression(voxel::Sphere{pose.at_mm, r}) - voxel::Sphere{pose.at_mm, inner},
                 4.0 / 3.0 * pi * (r * r * r - inner * inner * inner), 4.0 * pi * (r * r + inner * inner));
}

SolidPhantom named(const char* kind, const Pose& pose, const glm::dvec3& spacing_mm, double shortest_mm,
                   double size) {
  SolidPhantomOptions options;
  options.voxels = pose.made.universe.side();
  options.radius_voxels = size * pose.radius_mm / shortest_mm;
  options.spacing_mm = spacing_mm;
  options.centre_mm = pose.at_mm;
  options.lps_from_axes = pose.axes;
  return solid_phantom(kind, options);
}

}  // namespace

const std::vector<std::string>& measured_groups() {
  static const std::vector<std::string> all{"smooth", "edges", "cut across", "cut along", "thin"};
  return all;
}

SolidPhantom measured_solid(std::string_view group, std::uint64_t kind, const glm::dvec3& spacing_mm,
                            Chance& chance) {
  const double longest_mm = std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const double shortest_mm = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const double coarseness = longest_mm / shortest_mm;
  SolidPhantomOptions frame;
  frame.voxels = coarseness > 2.0 ? 128 : coarseness > 1.0 ? 64 : 32;
  frame.radius_voxels = 1.0;
  frame.spacing_mm = spacing_mm;
  Pose pose{solid_phantom("sphere", frame), {}, {}, 0.0, chance};
  pose.radius_mm = longest_mm * (coarseness > 1.0 ? chance.between(7.5, 9.3) : chance.between(8.8, 11.2));
  pose.at_mm = glm::dvec3(chance.even(), chance.even(), chance.even()) * spacing_mm;
  pose.axes = group == "cut along" ? any_axes(chance) : any_turn(chance);
  const auto of = [&](const char* name, double size) {
    return named(name, pose, spacing_mm, shortest_mm, size);
  };
  if (group == "smooth")
    return kind % 3 == 0 ? of("sphere", 1.0) : kind % 3 == 1 ? of("ellipsoid", 1.0) : torus(pose);
  if (group == "edges")
    return kind % 3 == 0 ? box(pose) : kind % 3 == 1 ? of("cylinder", 0.89) : of("lens", 1.0);
  if (group == "thin") return kind % 2 == 0 ? plate(pose, longest_mm) : shell(pose, longest_mm);
  if (group != "cut across" && group != "cut along")
    throw std::invalid_argument("no group of measured solids is called " + std::string(group));
  const bool along = group == "cut along";
  switch (kind % (along ? 5 : 4)) {
    case 0:
      return cap(pose);
    case 1:
      return lune(pose);
    case 2:
      return halved_cylinder(pose);
    case 3:
      return halved_box(pose);
    default:
      return box(pose);
  }
}

}  // namespace octotomy::verify
