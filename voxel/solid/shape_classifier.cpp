// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/shape_classifier.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

namespace octotomy::voxel {
namespace {

Swept swept_along(const glm::dmat3& lps_from_axes, const glm::dvec3& origin_mm,
                  const glm::dmat4& lps_from_voxel, double low_mm, double high_mm) {
  const glm::dmat3 axes_from_lps = glm::transpose(lps_from_axes);
  return {axes_from_lps * glm::dmat3(lps_from_voxel),
          axes_from_lps * (glm::dvec3(lps_from_voxel[3]) - origin_mm), low_mm, high_mm};
}

// Any right-handed frame whose third axis is the given one; with a lattice's own axis, the lattice's frame.
glm::dmat3 frame_along(const glm::dvec3& axis) {
  const glm::dvec3 size = glm::abs(axis);
  glm::dvec3 other(0.0);
  other[size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2] = 1.0;
  const glm::dvec3 v = glm::normalize(glm::cross(axis, other));
  return {glm::cross(v, axis), v, axis};
}

glm::dmat4 affine(const glm::dmat3& linear, const glm::dvec3& origin) {
  glm::dmat4 map(linear);
  map[3] = glm::dvec4(origin, 1.0);
  return map;
}

}  // namespace

double share_below(const Tangent& tangent, double half) {
  glm::dvec3 m = glm::abs(tangent.gradient);
  const double sum = m.x + m.y + m.z;
  if (sum == 0.0) return tangent.value <= 0.0 ? 1.0 : 0.0;
  // Place of the plane from the innermost corner to the opposite one.
  const double alpha = 0.5 - tangent.value / (2.0 * half * sum);
  if (alpha <= 0.0) return 0.0;
  if (alpha >= 1.0) return 1.0;
  m /= sum;
  if (m.x > m.y) std::swap(m.x, m.y);
  if (m.y > m.z) std::swap(m.y, m.z);
  if (m.x > m.y) std::swap(m.x, m.y);
  // The cubic cases divide by m.x what has cancelled down to it: below the square root of the machine's
  // epsilon the plane counts as parallel to that axis, which moves the share by less than m.x.
  if (m.x < 0x1p-26) m.x = 0.0;
  const double a = std::min(alpha, 1.0 - alpha);
  const double pair = m.x + m.y;
  const double volume = 6.0 * m.x * m.y * m.z;
  const auto beyond = [&](double edge) { return edge * edge * (edge - 3.0 * a); };
  double below = 0.0;
  if (a < m.x)
    below = a * a * a / volume;
  else if (a < m.y)
    below = (3.0 * a * (a - m.x) + m.x * m.x) / (6.0 * m.y * m.z);
  else if (a < std::min(pair, m.z))
    below = (a * a * (3.0 * pair - a) + beyond(m.x) + beyond(m.y)) / volume;
  else if (m.z < pair)
    below = (a * a * (3.0 - 2.0 * a) + beyond(m.x) + beyond(m.y) + beyond(m.z)) / volume;
  else
    below = (2.0 * a - pair) / (2.0 * m.z);
  below = std::clamp(below, 0.0, 0.5);
  return alpha <= 0.5 ? below : 1.0 - below;
}

ShapeClassifier::ShapeClassifier(const Shape& shape, const glm::dmat4& lps_from_voxel)
    : complement_(shape.complement()) {
  const glm::dmat3 edges(lps_from_voxel);
  const glm::dvec3 first_mm(lps_from_voxel[3]);
  const auto cut = [&](const auto& solid) -> Primitive {
    using Solid = std::decay_t<decltype(solid)>;
    if constexpr (std::is_same_v<Solid, Sphere>) {
      return BallClassifier(affine(edges, first_mm - solid.centre_mm), solid.radius_mm);
    } else if constexpr (std::is_same_v<Solid, Ellipsoid>) {
      glm::dmat3 unit_from_lps = glm::transpose(solid.lps_from_axes);
      for (int column = 0; column < 3; ++column) unit_from_lps[column] /= solid.radii_mm;
      return BallClassifier(affine(unit_from_lps * edges, unit_from_lps * (first_mm - solid.centre_mm)), 1.0);
    } else if constexpr (std::is_same_v<Solid, Box>) {
      return BoxClassifier(affine(edges, first_mm - 0.5 * (solid.low_mm + solid.high_mm)),
                           0.5 * (solid.high_mm - solid.low_mm));
    } else if constexpr (std::is_same_v<Solid, OrientedBox>) {
      const glm::dmat3 axes_from_lps = glm::transpose(solid.lps_from_axes);
      return BoxClassifier(affine(axes_from_lps * edges, axes_from_lps * (first_mm - solid.centre_mm)),
                           solid.half_mm);
    } else if constexpr (std::is_same_v<Solid, HalfSpace>) {
      return HalfSpaceClassifier(glm::transpose(edges) * solid.normal,
                                 glm::dot(solid.normal, first_mm) - solid.offset_mm);
    } else if constexpr (std::is_same_v<Solid, Cylinder>) {
      const double length_mm = glm::distance(solid.from_mm, solid.to_mm);
      return CylinderClassifier(swept_along(frame_along((solid.to_mm - solid.from_mm) / length_mm),
                                            solid.from_mm, lps_from_voxel, 0.0, length_mm),
                                solid.radius_mm);
    } else if constexpr (std::is_same_v<Solid, Torus>) {
      constexpr double everywhere = std::numeric_limits<double>::infinity();
      return TorusClassifier(
          swept_along(frame_along(solid.axis), solid.centre_mm, lps_from_voxel, -everywhere, everywhere),
          solid.ring_radius_mm, solid.tube_radius_mm);
    } else {
      const View& view = solid.region.view;
      return PrismClassifier(swept_along(glm::dmat3(view.right, view.up, view.look), glm::dvec3(0.0),
                                         lps_from_voxel, solid.low_mm, solid.high_mm),
                             solid.region);
    }
  };
  for (const Shape::Part& part : shape.parts())
    parts_.push_back({std::visit(cut, part.primitive), part.complement});
}

Meets ShapeClassifier::meets_all(const Cube& cube) const {
  Meets all{true, false, true, false};
  int cutting = 0;
  for (const Part& part : parts_) {
    Meets own = std::visit([&](const auto& primitive) { return primitive.meets(cube); }, part.primitive);
    if (part.complement) own = own.complement();
    if (!own.in) return Meets::exactly(false, true);
    if (!own.out) continue;
    all.out = true;
    all.sure_in = all.sure_in && own.sure_in && ++cutting == 1;
    all.sure_out = all.sure_out || own.sure_out;
  }
  return all;
}

Meets ShapeClassifier::meets(const Cube& cube) const {
  const Meets all = meets_all(cube);
  return complement_ ? all.complement() : all;
}

Meets ShapeClassifier::refined(const Cube& cube, int halvings) const {
  Meets all = meets_all(cube);
  if (all.decided()) return all;
  if (halvings == 0) return Meets::exactly(all.in, all.out);
  bool in = all.sure_in;
  bool out = all.sure_out;
  for (int number = 0; number < 8 && !(in && out); ++number) {
    const Meets part = refined(cube.octant(number), halvings - 1);
    in = in || part.in;
    out = out || part.out;
  }
  return Meets::exactly(in, out);
}

Meets ShapeClassifier::resolve(const Cube& cube) const {
  const Meets all = refined(cube, 6);
  return complement_ ? all.complement() : all;
}

bool ShapeClassifier::contains(const glm::dvec3& p_voxel) const {
  const bool all = std::all_of(parts_.begin(), parts_.end(), [&](const Part& part) {
    return std::visit([&](const auto& primitive) { return primitive.contains(p_voxel); }, part.primitive) !=
           part.complement;
  });
  return all != complement_;
}

double ShapeClassifier::share(const Cube& cube, int halvings) const {
  // What is left of the cube after each surface that runs through it.
  double product = 1.0;
  int sheets_count = 0;
  double off_voxels = 0.0;
  for (const Part& part : parts_) {
    Meets own = std::visit([&](const auto& primitive) { return primitive.meets(cube); }, part.primitive);
    if (part.complement) own = own.complement();
    if (!own.in) return 0.0;
    if (!own.out) continue;
    const Sheets sheets =
        std::visit([&](const auto& primitive) { return primitive.sheets(cube); }, part.primitive);
    sheets_count += std::max(sheets.count, 1);
    off_voxels += sheets.off_voxels;
    const double below = share_below(sheets.first, cube.half);
    product *= part.complement ? 1.0 - below : below;
  }
  if (sheets_count == 0) return 1.0;
  constexpr double flat_voxels = 0x1p-9;
  if (halvings == 0 || (sheets_count == 1 && off_voxels <= flat_voxels)) return product;
  double sum = 0.0;
  for (int number = 0; number < 8; ++number) sum += share(cube.octant(number), halvings - 1);
  return 0.125 * sum;
}

double ShapeClassifier::fraction(const Cube& cube) const {
  const double all = share(cube, 4);
  return complement_ ? 1.0 - all : all;
}

}  // namespace octotomy::voxel
