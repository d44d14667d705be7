// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "voxel/solid/expression.h"

namespace octotomy::voxel {

/// Three-valued status of 64 children at once: those of `full` are Full, those outside `some` are Empty, the
/// others undecided. Precondition: full is a subset of some. Operators follow Kleene's three-valued logic,
/// bit by bit. They are exact for children that are decided on both sides.
struct Cover {
  std::uint64_t full = 0;
  std::uint64_t some = 0;

  std::uint64_t undecided() const { return some & ~full; }
  friend Cover operator&(Cover a, Cover b) { return {a.full & b.full, a.some & b.some}; }
  friend Cover operator|(Cover a, Cover b) { return {a.full | b.full, a.some | b.some}; }
  friend Cover operator~(Cover a) { return {~a.some, ~a.full}; }
  friend Cover operator-(Cover a, Cover b) { return a & ~b; }
  friend Cover operator^(Cover a, Cover b) {
    return {(a.full & ~b.some) | (~a.some & b.full), (a.some | b.some) & ~(a.full & b.full)};
  }
};

/// An expression arranged for a walk: its leaves, each with the product of the motions above it, and its
/// operators in postfix order.
struct PostfixExpression {
  struct Operand {
    const Expression::Leaf* leaf = nullptr;  ///< owned by the expression
    glm::dmat4 moved_from_still{1.0};        ///< LPS to LPS
    bool still = true;                       ///< whether all motions above it are the identity
    /// Whether it is the scan of a window, which is pushed right after the window.
    bool is_scan = false;
  };
  enum class Code : std::uint8_t { Push, And, Or, Minus, Xor, Not };
  struct Step {
    Code code = Code::Push;
    std::uint32_t operand = 0;  ///< Push only
  };
  std::vector<Operand> operands;
  std::vector<std::shared_ptr<const Expression::Leaf>> scans;  ///< the leaves of operands with `is_scan`
  std::vector<Step> steps;
  std::size_t stack_size = 0;  ///< largest number of values on run()'s stack

  /// Evaluates the expression over any type that has the operators. `value(i)` returns operand i.
  /// Precondition: `stack` has room for stack_size values.
  template <typename Value, typename Get>
  Value run(const Get& value, Value* stack) const {
    Value* top = stack;
    for (const Step& step : steps) {
      switch (step.code) {
        case Code::Push:
          *top++ = value(step.operand);
          continue;
        case Code::Not:
          top[-1] = ~top[-1];
          continue;
        case Code::And:
          top[-2] = top[-2] & top[-1];
          break;
        case Code::Or:
          top[-2] = top[-2] | top[-1];
          break;
        case Code::Minus:
          top[-2] = top[-2] & ~top[-1];
          break;
        case Code::Xor:
          top[-2] = top[-2] ^ top[-1];
          break;
      }
      --top;
    }
    return *stack;
  }
};

/// Converts an expression to postfix form. The result refers to the expression's leaves, so the expression
/// must outlive it. A leaf that occurs repeatedly under the same motion becomes one operand. A repeated leaf
/// adds no step to a chain of | or & that already contains it, or from which it was already subtracted. A
/// window becomes an intersection with its scan. Exception: a window at rest on the lattice of `target` that
/// excludes the background contains no voxel beyond the scan anyway. Throws as for_each_term() does.
PostfixExpression postfix_of(const Expression& expression, const std::optional<Universe>& target = {});

}  // namespace octotomy::voxel
