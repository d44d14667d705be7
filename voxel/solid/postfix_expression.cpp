// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/postfix_expression.h"

#include <algorithm>
#include <unordered_map>

#include "voxel/solid/term_walk.h"

namespace octotomy::voxel {
namespace {

using Kind = Expression::Kind;
using Code = PostfixExpression::Code;

Code code_of(Kind kind) {
  switch (kind) {
    case Kind::Leaf:
    case Kind::Moved:
      break;
    case Kind::And:
      return Code::And;
    case Kind::Or:
      return Code::Or;
    case Kind::Minus:
      return Code::Minus;
    case Kind::Xor:
      return Code::Xor;
    case Kind::Not:
      return Code::Not;
  }
  return Code::Push;
}

}  // namespace

PostfixExpression postfix_of(const Expression& expression, const std::optional<Universe>& target) {
  PostfixExpression postfix;
  // Motions are composed before anything is sampled, so that a piece moved twice is sampled once.
  std::vector<glm::dmat4> motions{glm::dmat4(1.0)};
  int moved_depth = 0;  // motions above that do move
  std::unordered_multimap<const Expression::Leaf*, std::uint32_t> known;
  // By the universe's address, which windows on the same samples share.
  std::unordered_map<const Universe*, const Expression::Leaf*> scans;
  std::size_t depth = 0;
  const auto push = [&](const Expression::Leaf& leaf, bool is_scan) {
    const auto [first, last] = known.equal_range(&leaf);
    const auto found = std::find_if(first, last, [&](const auto& entry) {
      return postfix.operands[entry.second].moved_from_still == motions.back();
    });
    auto number = static_cast<std::uint32_t>(postfix.operands.size());
    if (found != last) {
      number = found->second;
    } else {
      postfix.operands.push_back({&leaf, motions.back(), moved_depth == 0, is_scan});
      known.emplace(&leaf, number);
    }
    postfix.steps.push_back({Code::Push, number});
    postfix.stack_size = std::max(postfix.stack_size, ++depth);
  };
  const auto push_scan_of = [&](const Window& window) {
    const GreyOctree& grey = window.grey;
    const bool aligned = moved_depth == 0 && target && grey.universe() == *target;
    if (aligned && !grey.window_meets_background(window.low, window.high)) return;
    const Expression::Leaf*& scan = scans[&grey.universe()];
    if (scan == nullptr)
      scan = postfix.scans.emplace_back(std::make_shared<const Expression::Leaf>(grey.scan())).get();
    push(*scan, true);
    postfix.steps.push_back({Code::And, 0});
    --depth;
  };
  for_each_term(expression, [&](const MetTerm& met) {
    const Expression::Term& term = met.term;
    if (term.kind == Kind::Leaf) {
      push(*term.leaf, false);
      if (const auto* window = std::get_if<Window>(&*term.leaf)) push_scan_of(*window);
      return;
    }
    if (term.kind == Kind::Moved) {
      const int moves = term.moved_from_still == glm::dmat4(1.0) ? 0 : 1;
      moved_depth += met.before ? moves : -moves;
      if (met.before)
        motions.push_back(motions.back() * term.moved_from_still);
      else
        motions.pop_back();
    } else if (!met.before) {
      postfix.steps.push_back({code_of(term.kind), 0});
      if (term.right) --depth;
    }
  });
  return postfix;
}

}  // namespace octotomy::voxel
