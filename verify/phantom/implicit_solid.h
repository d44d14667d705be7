// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace octotomy::verify {

/// A ball, capsule, box or half-space in a frame of its own; see implicit_solid.cpp.
struct Primitive;

/// A solid as a closed form: a function of position in LPS millimetres, negative inside and positive outside,
/// with Lipschitz constant 1. So |value| never exceeds the distance to the surface, and a ball with a radius
/// below |value| holds no surface. Copies share their primitives.
class ImplicitSolid {
 public:
  enum class Kind { Leaf, Union, Intersection, Negation, Growth };
  /// One operation of the function, in postfix order.
  struct Step {
    Kind kind = Kind::Leaf;
    const Primitive* primitive = nullptr;  ///< of a leaf
    double mm = 0.0;                       ///< blending width of a union or intersection; growth
  };
  /// The steps of a solid: all of them, or only those that affect the value within a ball. The steps are
  /// valid as long as the solid exists.
  using Steps = std::vector<Step>;

  double operator()(const glm::dvec3& p_mm) const;
  const Steps& steps() const { return steps_; }

  friend ImplicitSolid operator|(ImplicitSolid a, const ImplicitSolid& b);
  friend ImplicitSolid operator&(ImplicitSolid a, const ImplicitSolid& b);
  friend ImplicitSolid operator-(ImplicitSolid a, const ImplicitSolid& b);
  /// Union and difference with a rounded edge, where the two values differ by less than `width_mm`.
  friend ImplicitSolid blended(ImplicitSolid a, const ImplicitSolid& b, double width_mm);
  friend ImplicitSolid carved(ImplicitSolid a, const ImplicitSolid& b, double width_mm);
  /// A solid that contains at least all points within `mm` of this one. A negative `mm` shrinks the solid by
  /// at least that much.
  friend ImplicitSolid grown(ImplicitSolid a, double mm);
  /// The reflection of a solid in the plane x = 0.
  friend ImplicitSolid mirrored(const ImplicitSolid& a);

 private:
  friend ImplicitSolid leaf(const Primitive& primitive);
  void append(const ImplicitSolid& b);

  Steps steps_;
  std::vector<std::shared_ptr<const Primitive>> primitives_;
};

/// A point of a tube's middle line and the tube's radius there, both in millimetres.
struct Station {
  glm::dvec3 p_mm{0.0};
  double radius_mm = 1.0;
};

/// `turn`: columns are the axes of the ellipsoid or box in LPS.
ImplicitSolid ellipsoid(const glm::dvec3& centre_mm, const glm::dvec3& radii_mm,
                        const glm::dmat3& turn = glm::dmat3(1));
ImplicitSolid rounded_box(const glm::dvec3& centre_mm, const glm::dvec3& half_mm, double rounding_mm,
                          const glm::dmat3& turn = glm::dmat3(1));
/// The points p with normal . p <= offset_mm; the normal is a unit vector.
ImplicitSolid half_space(const glm::dvec3& normal, double offset_mm);
/// The sweep of a ball whose radius changes linearly from one station to the other. It is then stretched
/// along the axes about the first station, so that its cross-section is an ellipse of radius times stretch.
ImplicitSolid tapered_capsule(const Station& from, const Station& to,
                              const glm::dvec3& stretch = glm::dvec3(1));
/// Tapered capsules along a Catmull-Rom spline through the stations; `pieces` of them between two stations.
/// Precondition: two stations at least.
ImplicitSolid tube(const std::vector<Station>& stations, const glm::dvec3& stretch = glm::dvec3(1),
                   int pieces = 4);
/// Returns the rotation by these angles about x, then y, then z, right-handed.
glm::dmat3 turned(const glm::dvec3& degrees);

/// Returns the value of a solid's steps at a point.
double value(const ImplicitSolid::Steps& steps, const glm::dvec3& p_mm);

/// Writes to `pruned` the steps that decide the value within `radius_mm` of a point, and returns the value at
/// the point. An operand of a union is dropped if it exceeds the other by more than twice the radius plus the
/// blending width, because neither operand changes by more than the radius. Source: Barbier et al., Lipschitz
/// Pruning, 2025. Departure: a single ball instead of a hierarchy.
double prune(const ImplicitSolid::Steps& steps, const glm::dvec3& p_mm, double radius_mm,
             ImplicitSolid::Steps& pruned);

}  // namespace octotomy::verify
