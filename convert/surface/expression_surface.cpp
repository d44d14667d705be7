// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/expression_surface.h"

#include <algorithm>
#include <span>
#include <vector>

#include "convert/surface/surface_extraction.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/postfix_expression.h"
#include "voxel/tree/interpolate.h"

namespace octotomy::convert {
namespace {

/// The closest that a point of the surface may come to a sample, as a part of the edge: enough for points of
/// different edges to differ, and for voxels of up to 16 mm under a nanometre off a cut.
constexpr double closest_to_sample() {
  return 0x1p-24;
}

/// Halvings of an edge, which bring a point to within rounding of the expression's end.
constexpr int halvings = 40;

bool holds(const voxel::Octree& octree, const glm::dvec3& p_mm, const glm::dmat4& voxel_from_lps) {
  const glm::dvec3 v = voxel_from_lps * glm::dvec4(p_mm, 1.0);
  return octree.contains(glm::ivec3(glm::floor(v + 0.5)));
}
bool holds(const voxel::Window& window, const glm::dvec3& p_mm, const glm::dmat4& voxel_from_lps) {
  const double value =
      interpolate(window.grey, voxel_from_lps * glm::dvec4(p_mm, 1.0), voxel::Interpolation::Linear);
  return value >= window.low && value <= window.high;
}
bool holds(const voxel::RegionMask& mask, const glm::dvec3& p_mm, const glm::dmat4&) {
  return contains(mask, p_mm);
}
bool holds(const voxel::SliceMask& mask, const glm::dvec3& p_mm, const glm::dmat4&) {
  return voxel::SliceDistance(mask)(mask.view.project(p_mm), glm::dot(p_mm, mask.view.look), 0.0, 0.0).low <=
         0.0;
}
bool holds(const voxel::HalfSpace& half_space, const glm::dvec3& p_mm, const glm::dmat4&) {
  return glm::dot(half_space.normal, p_mm) <= half_space.offset_mm;
}
bool holds(const voxel::Sphere& sphere, const glm::dvec3& p_mm, const glm::dmat4&) {
  return glm::distance(sphere.centre_mm, p_mm) <= sphere.radius_mm;
}
bool holds(const voxel::Box& box, const glm::dvec3& p_mm, const glm::dmat4&) {
  return glm::all(glm::lessThanEqual(box.low_mm, p_mm)) && glm::all(glm::lessThanEqual(p_mm, box.high_mm));
}

/// To the lattice indices of a leaf, if it has a lattice.
glm::dmat4 voxel_from_lps(const voxel::Expression::Leaf& leaf) {
  if (const auto* octree = std::get_if<voxel::Octree>(&leaf))
    return glm::inverse(octree->universe().lps_from_voxel);
  if (const auto* window = std::get_if<voxel::Window>(&leaf))
    return glm::inverse(window->grey.universe().lps_from_voxel);
  return glm::dmat4(1.0);
}

/// Whether points lie in an expression.
class Membership {
 public:
  Membership(const voxel::Universe& universe, const voxel::Expression& expression)
      : postfix_(postfix_of(expression, universe)) {
    for (const voxel::PostfixExpression::Operand& operand : postfix_.operands) {
      still_from_lps_.push_back(operand.still ? glm::dmat4(1.0) : glm::inverse(operand.moved_from_still));
      voxel_from_lps_.push_back(voxel_from_lps(*operand.leaf));
    }
  }

  bool operator()(const glm::dvec3& p_mm) const {
    std::vector<std::uint64_t> stack(postfix_.stack_size);
    const auto value = [&](std::uint32_t i) -> std::uint64_t {
      const voxel::PostfixExpression::Operand& operand = postfix_.operands[i];
      const glm::dvec3 q_mm = operand.still ? p_mm : glm::dvec3(still_from_lps_[i] * glm::dvec4(p_mm, 1.0));
      return std::visit([&](const auto& leaf) { return holds(leaf, q_mm, voxel_from_lps_[i]); },
                        *operand.leaf)
                 ? ~std::uint64_t{0}
                 : 0;
    };
    return postfix_.run<std::uint64_t>(value, stack.data()) != 0;
  }

 private:
  voxel::PostfixExpression postfix_;
  std::vector<glm::dmat4> still_from_lps_;
  std::vector<glm::dmat4> voxel_from_lps_;
};

}  // namespace

brep::Triangles isosurface(const voxel::Universe& universe, const voxel::Expression& expression,
                           const voxel::Progress& progress) {
  progress.at(0.0);
  const voxel::Lattice lattice = universe.lattice();
  const Membership inside(universe, expression);
  const auto crossing = [&](const CrossedEdge& edge) {
    const glm::dvec3 first_mm = lattice.lps_mm(edge.voxel);
    glm::ivec3 next = edge.voxel;
    ++next[edge.axis];
    const glm::dvec3 step_mm = lattice.lps_mm(next) - first_mm;
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      (inside(first_mm + middle * step_mm) == edge.first_inside ? low : high) = middle;
    }
    return std::clamp(0.5 * (low + high), closest_to_sample(), 1.0 - closest_to_sample());
  };
  const Crossings crossings = [&](std::span<const CrossedEdge> edges, double* parts) {
    std::transform(edges.begin(), edges.end(), parts, crossing);
  };
  return extract_surface(lattice, inside_bits(combine(universe, expression)), crossings, progress);
}

}  // namespace octotomy::convert
