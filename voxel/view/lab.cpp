// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/lab.h"

#include <cmath>

#include "voxel/view/srgb.h"

namespace octotomy::voxel {
namespace {

/// The matrix from linear sRGB to CIE XYZ; its columns are red, green and blue.
const glm::dmat3 xyz_from_linear{
    {0.4124564, 0.2126729, 0.0193339}, {0.3575761, 0.7151522, 0.1191920}, {0.1804375, 0.0721750, 0.9503041}};

glm::dvec3 white() {
  return xyz_from_linear * glm::dvec3(1.0);
}

constexpr double knee = 6.0 / 29.0;

double bend(double t) {
  return t > knee * knee * knee ? std::cbrt(t) : t / (3.0 * knee * knee) + 4.0 / 29.0;
}
double unbend(double t) {
  return t > knee ? t * t * t : 3.0 * knee * knee * (t - 4.0 / 29.0);
}

}  // namespace

glm::dvec3 lab_from_srgb(const glm::vec3& colour) {
  const glm::dvec3 xyz = xyz_from_linear * glm::dvec3(linear_from_srgb(colour)) / white();
  const glm::dvec3 f(bend(xyz.x), bend(xyz.y), bend(xyz.z));
  return {116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z)};
}

glm::vec3 srgb_from_lab(const glm::dvec3& lab) {
  const double y = (lab.x + 16.0) / 116.0;
  const glm::dvec3 xyz =
      white() * glm::dvec3(unbend(y + lab.y / 500.0), unbend(y), unbend(y - lab.z / 200.0));
  const glm::dvec3 linear = glm::clamp(glm::inverse(xyz_from_linear) * xyz, 0.0, 1.0);
  return {srgb_from_linear(static_cast<float>(linear.x)), srgb_from_linear(static_cast<float>(linear.y)),
          srgb_from_linear(static_cast<float>(linear.z))};
}

}  // namespace octotomy::voxel
