// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "voxel/solid/operand.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// An expression in a target's index space: its operands, and what cubes and points hold of all of them at
/// once. The expression must outlive it. Preconditions of its questions: those of the operands' (operand.h).
class TargetExpression {
 public:
  TargetExpression(PostfixExpression postfix, const Universe& target, const Resampling& resampling = {});

  const PostfixExpression& postfix() const { return postfix_; }
  const std::vector<Operand>& operands() const { return operands_; }

  /// Bounds at the cost of one look at each operand.
  Meets meets(const Cube& cube) const;
  /// The same, with undecided cubes halved until they are decided or 2^-6 of the cube wide. What is left then
  /// counts as met, in and out: a thin end that comes as close as that to a voxel may make it a boundary
  /// voxel.
  Meets resolve(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  /// The share of the cube that lies inside. The cube is halved until at most one surface cuts each piece, no
  /// more than 2^-9 of a voxel from its tangent plane, whose cut is a closed form. Pieces of 2^-4 of the cube
  /// that an edge still runs through take the shares of their surfaces as independent. Error: within 2^-9 on
  /// a surface of curvature up to 1/3 a voxel, within 2^-4 of the length of edges through the cube.
  double fraction(const Cube& cube) const;

 private:
  template <typename Value, typename Get>
  Value run(const Get& get) const;
  Meets refined(const Cube& cube, int halvings) const;
  double share(const Cube& cube, int halvings) const;

  PostfixExpression postfix_;
  std::vector<Operand> operands_;
};

/// Decides the voxels of leaves otherwise than by their centres.
struct LeafRule {
  double margin = TargetBlock::cuboids;                         ///< as TargetBlock's
  std::function<std::uint64_t(const glm::ivec3& origin)> word;  ///< of a leaf; called from several threads
};

/// The walk behind combine(), digitise() and digitise_partial(). A rule is asked about the leaves that the
/// covers of blocks leave open; without one, voxels are decided by their centres. Cost: as combine().
Octree walk(const Universe& universe, const TargetExpression& expression, const LeafRule* rule = nullptr);

}  // namespace octotomy::voxel
