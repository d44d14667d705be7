// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/space/error.h"

// Walks over the terms of an expression. They do not recurse, so an expression may be nested as deep as
// memory allows.

namespace octotomy::voxel {

/// A visit to a term: before its operands or after them. A leaf is visited once, with `before` set.
struct MetTerm {
  const Expression::Term& term;
  bool before;      ///< before the operands
  bool subtracted;  ///< whether the term is the right operand of a minus
};

/// The largest number of leaves that a walk visits. A part that occurs twice is visited and counted twice.
inline constexpr std::size_t most_leaves = std::size_t{1} << 22;

/// Calls `met` for every term in reading order. Throws Error with the code Input if the expression has
/// more than most_leaves leaves.
template <typename Met>
void for_each_term(const Expression& expression, const Met& met) {
  std::vector<MetTerm> open{{expression.term(), true, false}};
  std::size_t leaf_count = 0;
  while (!open.empty()) {
    const MetTerm at = open.back();
    open.pop_back();
    met(at);
    if (!at.before) continue;
    const Expression::Term& term = at.term;
    if (term.kind == Expression::Kind::Leaf) {
      if (++leaf_count > most_leaves)
        throw Error(ErrorCode::Input, "the expression has more than " + std::to_string(most_leaves) +
                                          " operands: combine parts of it first and use their results");
      continue;
    }
    open.push_back({term, false, at.subtracted});
    if (term.right) open.push_back({*term.right, true, term.kind == Expression::Kind::Minus});
    open.push_back({*term.left, true, false});
  }
}

/// Evaluates an expression from its leaves up. `leaf(term)` returns a leaf's value, `one(term, value)` that
/// of a complement or a motion, `two(term, left, right)` that of any other term. Throws as for_each_term()
/// does.
template <typename Value, typename Leaf, typename One, typename Two>
Value evaluate_terms(const Expression& expression, const Leaf& leaf, const One& one, const Two& two) {
  std::vector<Value> values;
  for_each_term(expression, [&](const MetTerm& met) {
    if (met.term.kind == Expression::Kind::Leaf) {
      values.push_back(leaf(met.term));
    } else if (!met.before) {
      Value last = std::move(values.back());
      values.pop_back();
      if (!met.term.right) {
        values.push_back(one(met.term, std::move(last)));
        return;
      }
      Value left = std::move(values.back());
      values.pop_back();
      values.push_back(two(met.term, std::move(left), std::move(last)));
    }
  });
  return std::move(values.front());
}

}  // namespace octotomy::voxel
