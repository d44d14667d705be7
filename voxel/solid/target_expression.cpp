// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/target_expression.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace octotomy::voxel {
namespace {

// The share of a cube that lies inside. If the surfaces of two solids cross the cube, their shares are
// combined as if they were independent.
struct Share {
  double share = 0.0;
  int sheets = 0;  ///< number of surfaces that cross the cube; 0: the share is exactly 0 or 1
  double off_voxels = 0.0;

  friend Share operator~(const Share& a) { return {1.0 - a.share, a.sheets, a.off_voxels}; }
  friend Share operator&(const Share& a, const Share& b) {
    if (a.sheets == 0) return a.share == 0.0 ? a : b;
    if (b.sheets == 0) return b.share == 0.0 ? b : a;
    return {a.share * b.share, a.sheets + b.sheets, a.off_voxels + b.off_voxels};
  }
  friend Share operator|(const Share& a, const Share& b) { return ~(~a & ~b); }
  friend Share operator^(const Share& a, const Share& b) { return (a & ~b) | (b & ~a); }
};

Share share_of(const Operand& operand, const Cube& cube) {
  const Meets own = meets(operand, cube);
  if (!own.in || !own.out) return {own.in ? 1.0 : 0.0};
  const Sheets within = sheets(operand, cube);
  assert(within.off_voxels >= 0.0);
  return {share_below(within.first, cube.half), std::max(within.count, 1), within.off_voxels};
}

}  // namespace

TargetExpression::TargetExpression(PostfixExpression postfix, const Universe& target,
                                   const Resampling& resampling)
    : postfix_(std::move(postfix)) {
  operands_.reserve(postfix_.operands.size());
  for (const PostfixExpression::Operand& operand : postfix_.operands)
    operands_.push_back(operand_of(operand, target, resampling));
}

// Evaluates the expression on the values that `get` returns for its operands.
template <typename Value, typename Get>
Value TargetExpression::run(const Get& get) const {
  if (postfix_.steps.size() == 1) return get(operands_.front());
  const auto value = [&](std::uint32_t i) { return get(operands_[i]); };
  std::array<Value, 4> few;
  if (postfix_.stack_size <= few.size()) return postfix_.run<Value>(value, few.data());
  std::vector<Value> many(postfix_.stack_size);
  return postfix_.run<Value>(value, many.data());
}

Meets TargetExpression::meets(const Cube& cube) const {
  return run<Meets>([&](const Operand& operand) { return voxel::meets(operand, cube); });
}

Meets TargetExpression::refined(const Cube& cube, int halvings) const {
  assert(halvings >= 0);
  const Meets all = meets(cube);
  if (all.decided()) return all;
  if (halvings == 0) return Meets::exactly(all.in, all.out);
  bool in = all.sure_in;
  bool out = all.sure_out;
  for (int number = 0; number < 8 && !(in && out); ++number) {
    const Meets part = refined(cube.octant(number), halvings - 1);
    in = in || part.in;
    out = out || part.out;
  }
  return Meets::exactly(in, out);
}

Meets TargetExpression::resolve(const Cube& cube) const {
  return refined(cube, 6);
}

bool TargetExpression::contains(const glm::dvec3& p_voxel) const {
  return run<std::uint64_t>([&](const Operand& operand) {
           return voxel::contains(operand, p_voxel) ? all_children : std::uint64_t{0};
         }) != 0;
}

double TargetExpression::share(const Cube& cube, int halvings) const {
  const Share all = run<Share>([&](const Operand& operand) { return share_of(operand, cube); });
  assert(all.share >= 0.0 && all.share <= 1.0);
  constexpr double flat_voxels = 0x1p-9;
  if (all.sheets == 0 || halvings == 0 || (all.sheets == 1 && all.off_voxels <= flat_voxels))
    return all.share;
  double sum = 0.0;
  for (int number = 0; number < 8; ++number) sum += share(cube.octant(number), halvings - 1);
  return 0.125 * sum;
}

double TargetExpression::fraction(const Cube& cube) const {
  return share(cube, 4);
}

}  // namespace octotomy::voxel
