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

/// Reads an expression as MeshExpressions does: leaf i is names[i]. Throws as MeshExpressions::evaluate().
ExpressionTree expression_tree_of(std::string_view text, std::vector<std::string>& names);

/// Evaluates Boolean expressions on solids, as the second lineage beside voxel::combine() on octrees. The
/// grammar is that of voxel::parse_expression(), with a parser of its own, so that a wrong precedence in one
/// of them shows as disagreement.
///
/// Complements stay symbolic (a & ~b is a - b, ~a & ~b is ~(a | b)), so no mesh is ever inside out. A
/// complement left at the end is taken within `world`. An expression that names a solid several times is
/// replaced by a read-once one if there is one, so that no surface meets itself; so is one whose solids were
/// made of the same others: skull - piece, where piece is skull & mask, is skull - mask; where piece is some
/// parts of skull & mask, the other parts are joined to that. a ^ b is
/// (a | b) - (a & b).
/// Every pair of operands is corefined once; its union, intersection and difference are kept.
class MeshExpressions {
 public:
  /// `world` is the solid that the complement of everything is taken in: the universe's box.
  explicit MeshExpressions(brep::Solid world) : world_(std::move(world)) {}

  using Lookup = std::function<brep::Solid(std::string_view name)>;
  /// The expression that made a solid, of names that `Lookup` knows; empty where it was made otherwise.
  using Origin = std::function<std::string(std::string_view name)>;

  /// Some of the connected parts of another solid: which, and the parts that were left out.
  struct PartsOf {
    std::string whole;
    brep::Solid others;
  };
  /// What parts a solid is; none where it is no such choice.
  using Choice = std::function<std::optional<PartsOf>(std::string_view name)>;

  /// The solid of the expression. `origin` and `choice` may be empty. Throws std::invalid_argument with the
  /// position and the expected symbol; as `lookup` and brep::boolean().
  brep::Solid evaluate(std::string_view text, const Lookup& lookup, const std::stop_token& stop = {},
                       const Origin& origin = {}, const Choice& choice = {});

  /// How far the corefinements of the last evaluate() moved operands, one added to the other.
  double shift_mm() const { return shift_mm_; }
  /// Doubts of the corefinements in the last evaluate().
  const std::vector<std::string>& findings() const { return findings_; }

 private:
  struct Signed {
    brep::Solid solid;
    bool complement = false;
  };
  /// a - p, where p is some parts of a solid that is a & m: a - m and the other parts, which have the cut's
  /// faces in common. Without it, p's surface meets that of a wherever it is one. None where it is not so.
  std::optional<brep::Solid> less_parts(const ExpressionTree& tree, const std::vector<std::string>& names,
                                        const Lookup& lookup, const Origin& origin, const Choice& choice);
  Signed value(const ExpressionTree& tree, const std::vector<brep::Solid>& leaves);
  brep::Solid boolean(const brep::Solid& a, brep::Operation operation, const brep::Solid& b);
  using Answers = std::map<brep::Operation, brep::Solid>;
  Signed intersection(const Signed& a, const Signed& b);

  brep::Solid world_;
  /// By the triangles that each operand keeps. Keeps the operands, so that no address is reused.
  struct Pair {
    brep::Solid a, b;
    Answers answers;
    double shift_mm = 0.0;
  };
  /// Adds the answers of one corefinement to the known ones of the pair, `operation` among them.
  void corefine(brep::Operation operation, Pair& pair);
  std::map<std::pair<const brep::Linked*, const brep::Linked*>, Pair> pairs_;
  double shift_mm_ = 0.0;
  std::vector<std::string> findings_;
  std::stop_token stop_;  ///< of the evaluate() under way
};

}  // namespace octotomy::verify
