// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "verify/question/expression_tree.h"

namespace octotomy::tests {

/// The answer of a formula where leaf i is bit i of `values`.
inline bool truth_value(const verify::ExpressionTree& tree, unsigned values) {
  if (tree.parts.empty()) return (values >> tree.leaf) & 1;
  const bool a = truth_value(tree.parts[0], values);
  if (tree.symbol == '~') return !a;
  const bool b = truth_value(tree.parts[1], values);
  switch (tree.symbol) {
    case '&':
      return a && b;
    case '|':
      return a || b;
    case '-':
      return a && !b;
    default:
      return a != b;
  }
}

}  // namespace octotomy::tests
