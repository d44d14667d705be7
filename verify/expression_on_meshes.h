// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "brep/boolean.h"
#include "brep/mesh.h"
#include "verify/formula.h"

namespace octotomy::verify {

using SharedMesh = std::shared_ptr<const brep::Mesh>;

/// Evaluates Boolean expressions on solids: the second lineage of what voxel::combine answers on octrees.
/// Text, precedence and names are those of voxel::parse_expression, read here by a parser of its own, so that
/// a wrong precedence in one of them shows as disagreement.
///
/// Complements are carried symbolically (a & ~b is a - b, ~a & ~b is ~(a | b)), so no mesh is ever turned
/// inside out; one that is left at the end is taken within `world`. An expression that names a solid several
/// times is written with each name once where that can be done, so that no surface meets itself. a ^ b is (a
/// | b) - (a & b). Every operand pair is corefined once and answers its union, intersection and difference
/// from then on.
class MeshExpressions {
 public:
  /// `world` is the solid that the complement of everything is taken in: the universe's box.
  explicit MeshExpressions(SharedMesh world) : world_(std::move(world)) {}

  /// The solid of the expression; without faces where the set is empty. Throws std::invalid_argument naming
  /// position and what was expected, what `lookup` throws, and what brep::boolean throws.
  SharedMesh evaluate(std::string_view text, const std::function<SharedMesh(std::string_view name)>& lookup);

  /// Doubts that corefinements of the last evaluate() left.
  const std::vector<std::string>& findings() const { return findings_; }

 private:
  struct Signed {
    SharedMesh mesh;
    bool complement = false;
  };
  Signed value(const Tree& tree, const std::vector<SharedMesh>& leaves);
  SharedMesh boolean(const SharedMesh& a, brep::Operation operation, const SharedMesh& b);
  /// Adds what one corefinement answers to what is known of the pair; the operation asked for is among it.
  void corefine(const SharedMesh& a, brep::Operation operation, const SharedMesh& b,
                std::map<brep::Operation, SharedMesh>& known);
  Signed intersection(const Signed& a, const Signed& b);

  SharedMesh world_;
  /// By operands and operation; the operands are kept alive with the answers, so that no address is reused.
  std::map<std::pair<SharedMesh, SharedMesh>, std::map<brep::Operation, SharedMesh>> answers_;
  std::vector<std::string> findings_;
};

}  // namespace octotomy::verify
