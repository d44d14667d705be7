// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "brep/boolean/boolean.h"
#include "brep/mesh/solid.h"
#include "verify/question/expression_tree.h"

namespace octotomy::verify {

/// Parses an expression as MeshExpressions does. Leaf i has the name names[i]. Throws as
/// MeshExpressions::evaluate().
ExpressionTree expression_tree_of(std::string_view text, std::vector<std::string>& names);

/// Evaluates Boolean expressions on solids, with code independent of voxel::combine() on octrees. The grammar
/// is that of voxel::parse_expression(). The parser is a separate one, so the kernels disagree if either
/// parser has a wrong precedence.
///
/// Complements stay symbolic (a & ~b is a - b, ~a & ~b is ~(a | b)), so no mesh is ever inside out. If the
/// result is a complement, it is computed within `world`. An expression that names a solid several times is
/// replaced by a read-once expression if there is one, so that no surface meets itself. The same applies to
/// solids that were computed from a common solid: skull - piece with piece = skull & mask becomes
/// skull - mask. If piece is some connected parts of skull & mask, the other parts are added to
/// skull - (skull & mask). a ^ b is (a | b) - (a & b).
/// Every pair of operands is corefined once; its union, intersection and difference are kept.
class MeshExpressions {
 public:
  /// `world` is the solid that represents all space: the universe's box.
  explicit MeshExpressions(brep::Solid world) : world_(std::move(world)) {}

  using Lookup = std::function<brep::Solid(std::string_view name)>;
  /// Returns the expression from which a solid was computed, with names for `Lookup`. Empty if it was not
  /// computed from an expression.
  using Origin = std::function<std::string(std::string_view name)>;

  /// A choice of connected parts: the name of the solid that they belong to, and the parts of it that were
  /// left out.
  struct PartsOf {
    std::string whole;
    brep::Solid others;
  };
  /// Returns for the name of a solid the choice of parts that produced it; none if it is no such choice.
  using Choice = std::function<std::optional<PartsOf>(std::string_view name)>;

  /// Returns the solid of an expression. `origin` and `choice` may be empty. Throws std::invalid_argument
  /// with the position and the expected symbol if the text is no expression; as `lookup` and brep::boolean().
  brep::Solid evaluate(std::string_view text, const Lookup& lookup, const std::stop_token& stop = {},
                       const Origin& origin = {}, const Choice& choice = {});

  /// The sum of the distances by which the corefinements of the last evaluate() moved operands.
  double shift_mm() const { return shift_mm_; }
  /// Findings of the corefinements in the last evaluate().
  const std::vector<std::string>& findings() const { return findings_; }

 private:
  struct Signed {
    brep::Solid solid;
    bool complement = false;
  };
  /// Computes a - p, where p is some connected parts of w = a & m, as the union of a - w and the other parts
  /// of w. Those share the faces of the cut. A direct difference would have coincident surfaces of p and a.
  /// None if the expression does not have this form.
  std::optional<brep::Solid> less_parts(const ExpressionTree& tree, const std::vector<std::string>& names,
                                        const Lookup& lookup, const Origin& origin, const Choice& choice);
  Signed value(const ExpressionTree& tree, const std::vector<brep::Solid>& leaves);
  brep::Solid boolean(const brep::Solid& a, brep::Operation operation, const brep::Solid& b);
  using Answers = std::map<brep::Operation, brep::Solid>;
  Signed intersection(const Signed& a, const Signed& b);

  brep::Solid world_;
  /// The answers for a pair of operands. `pairs_` finds them by the addresses of the operands' triangles.
  /// Pair keeps the operands alive, so that no address is reused.
  struct Pair {
    brep::Solid a, b;
    Answers answers;
    double shift_mm = 0.0;
  };
  /// Corefines a pair, and adds the answer for `operation` and any others to the pair's answers.
  void corefine(brep::Operation operation, Pair& pair);
  std::map<std::pair<const brep::Linked*, const brep::Linked*>, Pair> pairs_;
  double shift_mm_ = 0.0;
  std::vector<std::string> findings_;
  std::stop_token stop_;  ///< of the current call of evaluate()
};

}  // namespace octotomy::verify
