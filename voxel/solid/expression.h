// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "voxel/solid/primitive.h"
#include "voxel/solid/region_mask.h"
#include "voxel/solid/slice_mask.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The voxels of a grey octree whose samples lie in low..high, both included. The limits are in steps of the
/// octree's samples.
struct Window {
  GreyOctree grey;
  double low = 0.0;
  double high = 32767.0;
};
/// The window between two values in the scan's unit; without `high`, all samples from `low` up.
inline Window window_of(const GreyOctree& grey, double low,
                        const std::optional<double>& high = std::nullopt) {
  Window window{grey, grey.in_steps(low)};
  if (high) window.high = grey.in_steps(*high);
  return window;
}

/// A Boolean expression of objects under affine maps. It is immutable data and cheap to copy. combine(),
/// digitise() and renderers evaluate it.
class Expression {
 public:
  enum class Kind { Leaf, And, Or, Minus, Xor, Not, Moved };
  using Leaf = std::variant<Octree, Window, RegionMask, SliceMask, HalfSpace, Sphere, Box, Ellipsoid,
                            OrientedBox, Cylinder, Torus>;
  struct Term {
    Kind kind = Kind::Leaf;
    std::optional<Leaf> leaf;                 ///< Kind::Leaf only
    std::shared_ptr<const Term> left, right;  ///< right: binary kinds only
    glm::dmat4 moved_from_still{1.0};         ///< Kind::Moved only: LPS to LPS, affine

    Term() = default;
    Term(const Term&) = delete;
    Term& operator=(const Term&) = delete;
    ~Term();  ///< destroys terms iteratively, so that deep terms cannot exhaust the stack
  };

  /// An expression of a single object. Each constructor throws std::invalid_argument as check() of its type
  /// does: for a mask without polygons, a length that is not positive, or an axis that is not a unit vector.
  Expression(Octree octree) : Expression(Leaf(std::move(octree))) {}
  Expression(Window window) : Expression(Leaf(std::move(window))) {}
  Expression(RegionMask mask) : Expression(Leaf(std::move(mask))) {}
  Expression(SliceMask mask) : Expression(Leaf(std::move(mask))) {}
  Expression(const HalfSpace& half_space) : Expression(Leaf(half_space)) {}
  Expression(const Sphere& sphere) : Expression(Leaf(sphere)) {}
  Expression(const Box& box) : Expression(Leaf(box)) {}
  Expression(const Ellipsoid& ellipsoid) : Expression(Leaf(ellipsoid)) {}
  Expression(const OrientedBox& box) : Expression(Leaf(box)) {}
  Expression(const Cylinder& cylinder) : Expression(Leaf(cylinder)) {}
  Expression(const Torus& torus) : Expression(Leaf(torus)) {}

  friend Expression operator&(const Expression& a, const Expression& b) { return {Kind::And, a, b}; }
  friend Expression operator|(const Expression& a, const Expression& b) { return {Kind::Or, a, b}; }
  friend Expression operator-(const Expression& a, const Expression& b) { return {Kind::Minus, a, b}; }
  friend Expression operator^(const Expression& a, const Expression& b) { return {Kind::Xor, a, b}; }
  friend Expression operator~(const Expression& a);
  /// The expression after a rigid motion, LPS to LPS. Throws std::invalid_argument if the matrix is not
  /// rigid.
  friend Expression moved(const Expression& a, const glm::dmat4& moved_from_still);
  /// The expression's mirror image: the matrix is a reflection, LPS to LPS. Throws std::invalid_argument if
  /// the matrix is not a reflection.
  friend Expression reflected(const Expression& a, const glm::dmat4& mirrored_from_still);
  /// The expression after any affine map with an inverse, LPS to LPS: moved, reflected, scaled or sheared. A
  /// point is in the result if its preimage under the map is in the operand. Throws std::invalid_argument if
  /// an entry is not finite, the last row is not 0 0 0 1, or the map has no inverse.
  friend Expression carried(const Expression& a, const glm::dmat4& carried_from_still);

  /// A part of another expression, whose memory it shares. Precondition: not null.
  explicit Expression(std::shared_ptr<const Term> term) : term_(std::move(term)) {}

  const Term& term() const { return *term_; }

 private:
  explicit Expression(Leaf leaf);
  Expression(Kind kind, const Expression& a, const Expression& b);
  std::shared_ptr<const Term> term_;
};
Expression operator~(const Expression& a);
Expression moved(const Expression& a, const glm::dmat4& moved_from_still);
Expression reflected(const Expression& a, const glm::dmat4& mirrored_from_still);
Expression carried(const Expression& a, const glm::dmat4& carried_from_still);

/// A right-handed rotation in degrees about an axis through a point, followed by a translation; LPS
/// millimetres.
struct Motion {
  glm::dvec3 translate_mm{0.0};
  double degrees = 0.0;
  glm::dvec3 axis{0, 0, 1};
  glm::dvec3 about_mm{0.0};
};
/// Throws std::invalid_argument if a number is not finite or the axis has no length.
glm::dmat4 moved_from_still(const Motion& motion);

/// Look-ups for the names in an expression's text. Each throws InvalidInput for an unknown name.
struct Names {
  std::function<Expression(std::string_view name)> object;
  /// May be empty; `move` in the text is then an error.
  std::function<glm::dmat4(std::string_view name)> motion;
};

/// Parses `a & b`, `a | b`, `a - b`, `a ^ b`, `~a`, `move(a, m)` and parentheses. As in Python, `~` binds
/// strongest, then `-`, `&`, `^` and `|`; operators of one kind group from the left. Throws
/// std::invalid_argument with the position, the text found there and the text expected. If a look-up throws,
/// the exception carries the name's position.
Expression parse_expression(std::string_view text, const Names& names);

/// Names for the leaves and motions of an expression in its text, in the form that parse_expression() reads.
struct Labels {
  std::function<std::string(const Expression::Leaf& leaf)> object;
  std::function<std::string(const glm::dmat4& moved_from_still)> motion;
};
/// The expression as text with as few parentheses as possible. If names that are the inverse of the labels
/// are used, parsing this text yields the same expression, term by term.
std::string print_expression(const Expression& expression, const Labels& labels);

/// The names of the objects in an expression's text, each once, in the order of first use. Throws as
/// parse_expression() does.
std::vector<std::string> names_in(std::string_view text);

}  // namespace octotomy::voxel
