// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/scope.h"
#include "voxel/solid/expression.h"

namespace octotomy::planner {

/// A Boolean expression of earlier objects.
struct Combine {
  std::string expression;
};

/// Throws if the text is not an expression of earlier objects; the message states the position of the fault.
void check_expression(const std::string& expression, const FieldLocation& place);

/// Computes the voxel kernel's Boolean of earlier objects. `expression` builds the Boolean from the operands
/// of its names. It is called twice: with the objects' octrees, and with their symbols.
void combine_voxels(const VoxelBench& bench,
                    const std::function<voxel::Expression(const voxel::Names& names)>& expression,
                    VoxelSide& made);

/// Adds the cut walls, bound terms and windows of the operands to a Boolean's result, and a finding for each
/// mask that cuts nothing.
void bound_of_operands(const std::vector<std::string>& names, const BoundBench& bench, Object& made);

}  // namespace octotomy::planner
