// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/implicit_solid.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace octotomy::verify {

// A primitive is evaluated at q = local_from_lps (p - origin). In a stretched frame, lengths are at most
// |local_from_lps| times those in millimetres. `scale` is the reciprocal of that norm and of the primitive's
// own Lipschitz constant. So the value times `scale` has Lipschitz constant 1.
struct Primitive {
  enum class Kind { Ball, Capsule, Box, HalfSpace };
  Kind kind = Kind::Ball;
  glm::dvec3 origin_mm{0.0};
  glm::dmat3 local_from_lps{1.0};
  double scale = 1.0;
  glm::dvec3 extent{0.0};  // capsule: the vector between its ends; box: half edges less rounding
  double extent2 = 0.0;    // capsule: the square of its length
  double first = 1.0;      // capsule: radius at the origin; box: rounding
  double taper = 0.0;      // capsule: change of radius to its other end
};

namespace {

double value(const Primitive& form, const glm::dvec3& p_mm) {
  const glm::dvec3 from_origin = p_mm - form.origin_mm;
  const glm::dmat3& map = form.local_from_lps;
  switch (form.kind) {
    case Primitive::Kind::Ball:
      return form.scale * (glm::length(map * from_origin) - 1.0);
    case Primitive::Kind::Capsule: {
      // A capsule's frame is stretched along the axes and not turned.
      const glm::dvec3 q = glm::dvec3(map[0].x, map[1].y, map[2].z) * from_origin;
      const double along = glm::clamp(glm::dot(q, form.extent) / form.extent2, 0.0, 1.0);
      return form.scale * (glm::length(q - along * form.extent) - (form.first + along * form.taper));
    }
    case Primitive::Kind::Box: {
      const glm::dvec3 beyond = glm::abs(map * from_origin) - form.extent;
      const double inside = std::min(std::max({beyond.x, beyond.y, beyond.z}), 0.0);
      return glm::length(glm::max(beyond, glm::dvec3(0.0))) + inside - form.first;
    }
    case Primitive::Kind::HalfSpace:
      return map[0].x * from_origin.x + map[1].x * from_origin.y + map[2].x * from_origin.z;
  }
  return 0.0;
}

// The polynomial smooth minimum. It equals the minimum where a and b differ by more than the width. Its
// gradient is a convex combination of the gradients of a and b, so it keeps their Lipschitz constant.
double smooth_min(double a, double b, double width) {
  const double lesser = std::min(a, b), apart = std::abs(a - b);
  if (apart >= width) return lesser;
  const double near = (width - apart) / width;
  return lesser - 0.25 * near * near * width;
}

double combined(const ImplicitSolid::Step& step, double a, double b) {
  return step.kind == ImplicitSolid::Kind::Union ? smooth_min(a, b, step.mm) : -smooth_min(-a, -b, step.mm);
}

// Largest number of operands on the stack. Unions are left-associative, so an expression needs as many as it
// is deep.
constexpr std::size_t stack_depth = 32;

glm::dvec3 catmull_rom(const glm::dvec3& before, const glm::dvec3& a, const glm::dvec3& b,
                       const glm::dvec3& after, double t) {
  const glm::dvec3 out = (b - before) * 0.5, in = (after - a) * 0.5;
  return a + t * (out + t * (3.0 * (b - a) - 2.0 * out - in + t * (2.0 * (a - b) + out + in)));
}

}  // namespace

double value(const ImplicitSolid::Steps& steps, const glm::dvec3& p_mm) {
  std::array<double, stack_depth> stack;
  std::size_t top = 0;
  for (const ImplicitSolid::Step& step : steps) {
    assert(top < stack_depth);
    switch (step.kind) {
      case ImplicitSolid::Kind::Leaf:
        stack[top++] = value(*step.primitive, p_mm);
        break;
      case ImplicitSolid::Kind::Negation:
        stack[top - 1] = -stack[top - 1];
        break;
      case ImplicitSolid::Kind::Growth:
        stack[top - 1] -= step.mm;
        break;
      default:
        --top;
        stack[top - 1] = combined(step, stack[top - 1], stack[top]);
    }
  }
  return stack[0];
}

double prune(const ImplicitSolid::Steps& steps, const glm::dvec3& p_mm, double radius_mm,
             ImplicitSolid::Steps& pruned) {
  struct Operand {
    double value;
    std::size_t begin;
  };
  std::array<Operand, stack_depth> stack;
  std::size_t top = 0;
  pruned.clear();
  for (const ImplicitSolid::Step& step : steps) {
    assert(top < stack_depth);
    if (step.kind == ImplicitSolid::Kind::Leaf) {
      stack[top++] = {value(*step.primitive, p_mm), pruned.size()};
      pruned.push_back(step);
    } else if (step.kind == ImplicitSolid::Kind::Negation || step.kind == ImplicitSolid::Kind::Growth) {
      Operand& operand = stack[top - 1];
      operand.value = step.kind == ImplicitSolid::Kind::Negation ? -operand.value : operand.value - step.mm;
      pruned.push_back(step);
    } else {
      const Operand b = stack[--top];
      Operand& a = stack[top - 1];
      const double excess = step.kind == ImplicitSolid::Kind::Union ? a.value - b.value : b.value - a.value;
      // Within the ball each operand changes by at most the radius, so the difference changes by at most
      // twice the radius. An additional millionth covers rounding by far.
      const double decided = 2.000001 * radius_mm + step.mm;
      a.value = combined(step, a.value, b.value);
      if (excess > decided)
        pruned.erase(pruned.begin() + static_cast<std::ptrdiff_t>(a.begin),
                     pruned.begin() + static_cast<std::ptrdiff_t>(b.begin));
      else if (excess < -decided)
        pruned.resize(b.begin);
      else
        pruned.push_back(step);
    }
  }
  return stack[0].value;
}

double ImplicitSolid::operator()(const glm::dvec3& p_mm) const {
  return value(steps_, p_mm);
}

void ImplicitSolid::append(const ImplicitSolid& b) {
  steps_.insert(steps_.end(), b.steps_.begin(), b.steps_.end());
  primitives_.insert(primitives_.end(), b.primitives_.begin(), b.primitives_.end());
}

ImplicitSolid blended(ImplicitSolid a, const ImplicitSolid& b, double width_mm) {
  if (a.steps_.empty()) return b;
  a.append(b);
  a.steps_.push_back({ImplicitSolid::Kind::Union, nullptr, width_mm});
  return a;
}

ImplicitSolid carved(ImplicitSolid a, const ImplicitSolid& b, double width_mm) {
  a.append(b);
  a.steps_.push_back({ImplicitSolid::Kind::Negation, nullptr, 0.0});
  a.steps_.push_back({ImplicitSolid::Kind::Intersection, nullptr, width_mm});
  return a;
}

ImplicitSolid operator|(ImplicitSolid a, const ImplicitSolid& b) {
  return blended(std::move(a), b, 0.0);
}

ImplicitSolid operator-(ImplicitSolid a, const ImplicitSolid& b) {
  return carved(std::move(a), b, 0.0);
}

ImplicitSolid operator&(ImplicitSolid a, const ImplicitSolid& b) {
  a.append(b);
  a.steps_.push_back({ImplicitSolid::Kind::Intersection, nullptr, 0.0});
  return a;
}

ImplicitSolid grown(ImplicitSolid a, double mm) {
  a.steps_.push_back({ImplicitSolid::Kind::Growth, nullptr, mm});
  return a;
}

ImplicitSolid mirrored(const ImplicitSolid& a) {
  ImplicitSolid result = a;
  result.primitives_.clear();
  for (ImplicitSolid::Step& step : result.steps_) {
    if (step.primitive == nullptr) continue;
    Primitive primitive = *step.primitive;
    primitive.origin_mm.x = -primitive.origin_mm.x;
    primitive.local_from_lps[0] = -primitive.local_from_lps[0];
    result.primitives_.push_back(std::make_shared<const Primitive>(primitive));
    step.primitive = result.primitives_.back().get();
  }
  return result;
}

ImplicitSolid leaf(const Primitive& primitive) {
  ImplicitSolid form;
  form.primitives_.push_back(std::make_shared<const Primitive>(primitive));
  form.steps_.push_back({ImplicitSolid::Kind::Leaf, form.primitives_.back().get(), 0.0});
  return form;
}

ImplicitSolid ellipsoid(const glm::dvec3& centre_mm, const glm::dvec3& radii_mm, const glm::dmat3& turn) {
  Primitive ball;
  ball.origin_mm = centre_mm;
  const glm::dmat3 shrink(1.0 / radii_mm.x, 0, 0, 0, 1.0 / radii_mm.y, 0, 0, 0, 1.0 / radii_mm.z);
  ball.local_from_lps = shrink * glm::transpose(turn);
  ball.scale = std::min({radii_mm.x, radii_mm.y, radii_mm.z});
  return leaf(ball);
}

ImplicitSolid rounded_box(const glm::dvec3& centre_mm, const glm::dvec3& half_mm, double rounding_mm,
                          const glm::dmat3& turn) {
  Primitive box;
  box.kind = Primitive::Kind::Box;
  box.origin_mm = centre_mm;
  box.local_from_lps = glm::transpose(turn);
  box.extent = half_mm - rounding_mm;
  box.first = rounding_mm;
  return leaf(box);
}

ImplicitSolid half_space(const glm::dvec3& normal, double offset_mm) {
  Primitive plane;
  plane.kind = Primitive::Kind::HalfSpace;
  plane.origin_mm = normal * offset_mm;
  plane.local_from_lps = glm::transpose(glm::dmat3(normal, glm::dvec3(0), glm::dvec3(0)));
  return leaf(plane);
}

ImplicitSolid tapered_capsule(const Station& from, const Station& to, const glm::dvec3& stretch) {
  Primitive capsule;
  capsule.kind = Primitive::Kind::Capsule;
  capsule.origin_mm = from.p_mm;
  capsule.local_from_lps = glm::dmat3(1.0 / stretch.x, 0, 0, 0, 1.0 / stretch.y, 0, 0, 0, 1.0 / stretch.z);
  capsule.extent = (to.p_mm - from.p_mm) / stretch;
  capsule.extent2 = glm::dot(capsule.extent, capsule.extent);
  capsule.first = from.radius_mm;
  capsule.taper = to.radius_mm - from.radius_mm;
  // Across the axis the value's derivative is 1; along the axis it is the taper's slope.
  const double slope = capsule.taper / glm::length(capsule.extent);
  capsule.scale = std::min({stretch.x, stretch.y, stretch.z}) / std::sqrt(1.0 + slope * slope);
  return leaf(capsule);
}

ImplicitSolid tube(const std::vector<Station>& stations, const glm::dvec3& stretch, int pieces) {
  ImplicitSolid form;
  for (std::size_t span = 0; span + 1 < stations.size(); ++span) {
    const Station& a = stations[span];
    const Station& b = stations[span + 1];
    const glm::dvec3 before = span > 0 ? stations[span - 1].p_mm : 2.0 * a.p_mm - b.p_mm;
    const glm::dvec3 after = span + 2 < stations.size() ? stations[span + 2].p_mm : 2.0 * b.p_mm - a.p_mm;
    const auto at = [&](int piece) {
      const double t = static_cast<double>(piece) / pieces;
      return Station{catmull_rom(before, a.p_mm, b.p_mm, after, t), glm::mix(a.radius_mm, b.radius_mm, t)};
    };
    for (int piece = 0; piece < pieces; ++piece)
      form = std::move(form) | tapered_capsule(at(piece), at(piece + 1), stretch);
  }
  return form;
}

glm::dmat3 turned(const glm::dvec3& degrees) {
  const glm::dvec3 angle = glm::radians(degrees);
  const glm::dvec3 c = glm::cos(angle), s = glm::sin(angle);
  const glm::dmat3 about_x(1, 0, 0, 0, c.x, s.x, 0, -s.x, c.x);
  const glm::dmat3 about_y(c.y, 0, -s.y, 0, 1, 0, s.y, 0, c.y);
  const glm::dmat3 about_z(c.z, s.z, 0, -s.z, c.z, 0, 0, 0, 1);
  return about_z * about_y * about_x;
}

}  // namespace octotomy::verify
