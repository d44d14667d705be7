// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "voxel/solid/operand.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// An expression in a target's index space: its operands, and the result of the expression for cubes and
/// points. Precondition: the Expression outlives this object. The preconditions of the queries are those of
/// the operands (operand.h).
class TargetExpression {
 public:
  TargetExpression(PostfixExpression postfix, const Universe& target, const Resampling& resampling = {});

  const PostfixExpression& postfix() const { return postfix_; }
  const std::vector<Operand>& operands() const { return operands_; }

  /// Whether parts of the cube are inside and outside; possibly undecided. Cost: one query to each operand.
  Meets meets(const Cube& cube) const;
  /// Like meets(), but undecided cubes are split into octants until they are decided or 2^-6 of the cube
  /// wide. Cubes that are then still undecided count as having parts inside and outside, so a thin part of
  /// the solid within that distance of a voxel may make it a boundary voxel.
  Meets resolve(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  /// The share of the cube that lies inside. The cube is split into octants until at most one surface cuts
  /// each piece and deviates by at most 2^-9 of a voxel from its tangent plane, for which the share is a
  /// closed form. In pieces 2^-4 of the cube wide that an edge still crosses, the shares of the surfaces are
  /// combined as independent. The error is at most 2^-9 on a surface with a curvature of up to 1/3 per voxel,
  /// and at most 2^-4 of the length of edges through the cube.
  double fraction(const Cube& cube) const;

 private:
  template <typename Value, typename Get>
  Value run(const Get& get) const;
  Meets refined(const Cube& cube, int halvings) const;
  double share(const Cube& cube, int halvings) const;

  PostfixExpression postfix_;
  std::vector<Operand> operands_;
};

/// A rule other than voxel centres, for the leaves that are undecided in the covers of blocks.
struct LeafRule {
  double margin = TargetBlock::cuboids;  ///< as in TargetBlock
  /// Returns the word of the leaf at `origin`; called from several threads.
  std::function<std::uint64_t(const glm::ivec3& origin)> word;
};

/// The walk behind combine(), digitise() and digitise_partial(). `rule` decides the leaves that are undecided
/// in the covers of blocks; without a rule, voxel centres decide. Cost: as combine().
Octree walk(const Universe& universe, const TargetExpression& expression, const LeafRule* rule = nullptr);

}  // namespace octotomy::voxel
