// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace octotomy::verify {

/// One primitive solid in a frame of its own; see form.cpp.
struct Primitive;

/// A solid as a closed form: a function of position in LPS millimetres, negative inside and positive
/// outside, that never changes faster than position does (Lipschitz constant 1). Its value is therefore no
/// more than the distance to the surface, and a ball of a radius below |value| has no surface in it: that is
/// what scanning a form builds on. A value; copies share their primitives.
class Form {
 public:
  enum class Kind { Leaf, Union, Intersection, Negation, Growth };
  /// One step of the form in postfix order.
  struct Step {
    Kind kind = Kind::Leaf;
    const Primitive* primitive = nullptr;  ///< of a leaf
    double mm = 0.0;                       ///< blending width of a union or intersection; growth
  };
  /// The steps that matter within some ball. Lives no longer than the form it was taken from.
  using Steps = std::vector<Step>;

  double operator()(const glm::dvec3& p_mm) const;
  const Steps& steps() const { return steps_; }

  friend Form operator|(Form a, const Form& b);
  friend Form operator&(Form a, const Form& b);
  friend Form operator-(Form a, const Form& b);
  /// Union and difference whose edge is rounded where the two values are within `width_mm` of each other.
  friend Form blended(Form a, const Form& b, double width_mm);
  friend Form carved(Form a, const Form& b, double width_mm);
  /// At least the points within `mm` of the form; a negative growth shrinks at least so much.
  friend Form grown(Form a, double mm);
  /// The reflection in the plane x = 0.
  friend Form mirrored(const Form& a);

 private:
  friend Form leaf(const Primitive& primitive);
  void append(const Form& b);

  Steps steps_;
  std::vector<std::shared_ptr<const Primitive>> primitives_;
};

/// A point of a tube's middle line and the tube's radius there, both in millimetres.
struct Station {
  glm::dvec3 p_mm{0.0};
  double radius_mm = 1.0;
};

/// `turn` carries the axes of the ellipsoid or box to LPS.
Form ellipsoid(const glm::dvec3& centre_mm, const glm::dvec3& radii_mm,
               const glm::dmat3& turn = glm::dmat3(1));
Form rounded_box(const glm::dvec3& centre_mm, const glm::dvec3& half_mm, double rounding_mm,
                 const glm::dmat3& turn = glm::dmat3(1));
/// The points p with normal . p <= offset_mm; the normal is a unit vector.
Form half_space_form(const glm::dvec3& normal, double offset_mm);
/// The solid swept by a ball whose radius changes linearly between two stations, then stretched along the
/// axes about the first station's place: its cross-section is an ellipse of radius times stretch.
Form tapered_capsule(const Station& from, const Station& to, const glm::dvec3& stretch = glm::dvec3(1));
/// Tapered capsules along a Catmull-Rom spline through the stations, `pieces` of them a span. Precondition:
/// two stations at least.
Form tube(const std::vector<Station>& stations, const glm::dvec3& stretch = glm::dvec3(1), int pieces = 4);
/// Turns by degrees about x, then y, then z, right-handed.
glm::dmat3 turned(const glm::dvec3& degrees);

/// Value of steps at a point.
double value(const Form::Steps& steps, const glm::dvec3& p_mm);

/// The steps that decide the form's value anywhere within `radius_mm` of a point: an operand of a union is
/// left out where it exceeds the other by more than twice the radius plus the blending width, as neither
/// changes by more than the radius. Returns the value at the point. Source: the pruning of Barbier et al.,
/// Lipschitz Pruning, 2025, by a single ball instead of a hierarchy.
double prune(const Form::Steps& steps, const glm::dvec3& p_mm, double radius_mm, Form::Steps& pruned);

}  // namespace octotomy::verify
