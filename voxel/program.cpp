// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/program.h"

#include <algorithm>

namespace octotomy::voxel {
namespace {

class Compiler {
 public:
  Program compile(const Expression& expression) {
    visit(expression.term(), glm::dmat4(1.0), true);
    return std::move(program_);
  }

 private:
  void visit(const Expression::Term& term, const glm::dmat4& moved_from_still, bool still) {
    using Kind = Expression::Kind;
    switch (term.kind) {
      case Kind::Leaf:
        return push(term, moved_from_still, still);
      case Kind::Moved: {
        const bool at_rest = term.moved_from_still == glm::dmat4(1.0);
        // Composed before anything is sampled, so that a piece moved twice is sampled once.
        return visit(*term.left, moved_from_still * term.moved_from_still, still && at_rest);
      }
      case Kind::Not:
        visit(*term.left, moved_from_still, still);
        program_.steps.push_back({Program::Code::Not, 0});
        return;
      case Kind::And:
        return apply(term, moved_from_still, still, Program::Code::And);
      case Kind::Or:
        return apply(term, moved_from_still, still, Program::Code::Or);
      case Kind::Minus:
        return apply(term, moved_from_still, still, Program::Code::Minus);
      case Kind::Xor:
        return apply(term, moved_from_still, still, Program::Code::Xor);
    }
  }

  void apply(const Expression::Term& term, const glm::dmat4& moved_from_still, bool still,
             Program::Code code) {
    visit(*term.left, moved_from_still, still);
    visit(*term.right, moved_from_still, still);
    program_.steps.push_back({code, 0});
    --depth_;
  }

  void push(const Expression::Term& term, const glm::dmat4& moved_from_still, bool still) {
    const auto same = [&](const Program::Operand& operand) {
      return operand.leaf == &*term.leaf && operand.moved_from_still == moved_from_still;
    };
    auto& operands = program_.operands;
    auto found = std::find_if(operands.begin(), operands.end(), same);
    if (found == operands.end()) found = operands.insert(found, {&*term.leaf, moved_from_still, still});
    program_.steps.push_back({Program::Code::Push, static_cast<std::uint32_t>(found - operands.begin())});
    program_.stack_size = std::max(program_.stack_size, ++depth_);
  }

  Program program_;
  std::size_t depth_ = 0;
};

}  // namespace

Program program_of(const Expression& expression) {
  return Compiler().compile(expression);
}

}  // namespace octotomy::voxel
