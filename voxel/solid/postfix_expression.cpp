// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/postfix_expression.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

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

/// Builds the steps without redundant ones. A step is redundant if its value is already part of the chain of
/// | or &, or was already subtracted in the chain. Equal values have equal numbers.
class Layout {
 public:
  explicit Layout(std::vector<PostfixExpression::Step>& steps) : steps_(steps) {}

  /// The largest stack size so far.
  std::size_t most() const { return most_; }

  void push(std::uint32_t operand) {
    stack_.push_back({steps_.size(), number_of(Code::Push, operand, 0), Code::Push, {}});
    most_ = std::max(most_, stack_.size());
    steps_.push_back({Code::Push, operand});
  }

  void complement() {
    Entry& top = stack_.back();
    top = {top.first_step, number_of(Code::Not, top.number, 0), Code::Not, {}};
    steps_.push_back({Code::Not, 0});
  }

  void join(Code code) {
    const Entry right = std::move(stack_.back());
    stack_.pop_back();
    Entry& left = stack_.back();
    if (code == Code::And || code == Code::Or || code == Code::Minus) {
      if (left.row != code) left.members.clear();
      if (left.row != code && code != Code::Minus) left.members.insert(left.number);
      if (!left.members.insert(right.number).second) {
        left.row = code;
        return steps_.resize(right.first_step);
      }
    }
    left.number = number_of(code, left.number, right.number);
    left.row = code;
    steps_.push_back({code, 0});
  }

 private:
  struct Entry {
    std::size_t first_step = 0;
    std::uint32_t number = 0;
    Code row = Code::Push;                      ///< operator of the chain whose result this value is
    std::unordered_set<std::uint32_t> members;  ///< numbers of the values joined or subtracted in the chain
  };

  std::uint32_t number_of(Code code, std::uint32_t left, std::uint32_t right) {
    const std::tuple key{code, left, right};
    return numbers_.try_emplace(key, static_cast<std::uint32_t>(numbers_.size())).first->second;
  }

  std::vector<PostfixExpression::Step>& steps_;
  std::vector<Entry> stack_;
  std::map<std::tuple<Code, std::uint32_t, std::uint32_t>, std::uint32_t> numbers_;
  std::size_t most_ = 0;
};

}  // namespace

PostfixExpression postfix_of(const Expression& expression, const std::optional<Universe>& target) {
  PostfixExpression postfix;
  // Motions are composed before anything is sampled, so that a piece moved twice is sampled once.
  std::vector<glm::dmat4> motions{glm::dmat4(1.0)};
  int moved_depth = 0;  // number of enclosing motions other than the identity
  std::unordered_multimap<const Expression::Leaf*, std::uint32_t> known;
  // Keyed by the universe's address, which windows on the same samples share.
  std::unordered_map<const Universe*, const Expression::Leaf*> scans;
  Layout layout(postfix.steps);
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
    layout.push(number);
  };
  const auto push_scan_of = [&](const Window& window) {
    const bool aligned = moved_depth == 0 && target && window.grey.universe() == *target;
    if (aligned && !window.grey.window_meets_background(window.low, window.high)) return;
    // The scan on the lattice from which the window's samples are read (SampledWindowOperand).
    const bool on_voxels =
        target && whole_voxel_offset(glm::inverse(motions.back() * window.grey.universe().lps_from_voxel) *
                                     target->lps_from_voxel);
    const GreyOctree& grey = on_voxels ? window.grey : window.grey.on_scan_lattice();
    const Expression::Leaf*& scan = scans[&grey.universe()];
    if (scan == nullptr)
      scan = postfix.scans.emplace_back(std::make_shared<const Expression::Leaf>(grey.scan())).get();
    push(*scan, true);
    layout.join(Code::And);
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
    } else if (!met.before && term.kind == Kind::Not) {
      layout.complement();
    } else if (!met.before) {
      layout.join(code_of(term.kind));
    }
  });
  postfix.stack_size = layout.most();
  return postfix;
}

}  // namespace octotomy::voxel
