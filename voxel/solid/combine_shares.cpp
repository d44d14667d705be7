// For each operation:
// 1 combine() computes the voxels wholly inside and the voxels touched.
// 2 For voxels that are touched but not wholly inside, the bounds are computed from those of both operands.
// Source: Frechet, "Généralisation du théorème des probabilités totales", 1935: a voxel corresponds to the
// probability space, and a share to a probability.
#include "voxel/solid/combine_shares.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <stdexcept>
#include <unordered_map>

#include "voxel/solid/combine.h"
#include "voxel/solid/term_walk.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

constexpr int whole = PartialOctree::whole;

struct Bounds {
  int low = 0;
  int high = 0;
};

/// Returns a bracket's bounds at a voxel.
class Shares {
 public:
  explicit Shares(const ShareBracket& bracket) : bracket_(bracket) {
    entries_.reserve(bracket.low.size());
    std::size_t next = 0;
    for_each_boundary_voxel({bracket.inside, bracket.touching, bracket.low},
                            [&](const glm::ivec3& voxel, std::uint16_t low) {
                              entries_.push_back({key(voxel), {low, bracket.high[next++]}});
                            });
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.key < b.key; });
  }
  Bounds operator()(const glm::ivec3& voxel) const {
    const std::uint64_t wanted = key(voxel);
    const auto found = std::lower_bound(entries_.begin(), entries_.end(), wanted,
                                        [](const Entry& entry, std::uint64_t k) { return entry.key < k; });
    if (found != entries_.end() && found->key == wanted) return found->bounds;
    return bracket_.inside.contains(voxel) ? Bounds{whole, whole} : Bounds{0, 0};
  }

 private:
  struct Entry {
    std::uint64_t key = 0;
    Bounds bounds;
  };
  static std::uint64_t key(const glm::ivec3& voxel) {
    return (static_cast<std::uint64_t>(voxel.z) << 40) | (static_cast<std::uint64_t>(voxel.y) << 20) |
           static_cast<std::uint64_t>(voxel.x);
  }
  const ShareBracket& bracket_;
  std::vector<Entry> entries_;
};

Bounds complement(const Bounds& a) {
  assert(0 <= a.low && a.low <= a.high && a.high <= whole);
  return {whole - a.high, whole - a.low};
}
Bounds both(const Bounds& a, const Bounds& b) {
  return {std::max(0, a.low + b.low - whole), std::min(a.high, b.high)};
}
Bounds either(const Bounds& a, const Bounds& b) {
  return {std::max(a.low, b.low), std::min(whole, a.high + b.high)};
}
Bounds one_of(const Bounds& a, const Bounds& b) {
  return {std::max({0, a.low - b.high, b.low - a.high}),
          std::min({whole, a.high + b.high, 2 * whole - a.low - b.low})};
}

using Kind = Expression::Kind;

Bounds combined(Kind kind, const Bounds& a, const Bounds& b) {
  switch (kind) {
    case Kind::And:
      return both(a, b);
    case Kind::Or:
      return either(a, b);
    case Kind::Minus:
      return both(a, complement(b));
    default:
      return one_of(a, b);
  }
}

ShareBracket combined(Kind kind, const ShareBracket& a, const ShareBracket& b) {
  const Universe& universe = a.inside.universe();
  if (!(universe == b.inside.universe()))
    throw InvalidInput(
        "shares can only be combined in one universe: digitise the operands in the same voxels");
  using E = Expression;
  const E ia(a.inside), ta(a.touching), ib(b.inside), tb(b.touching);
  const auto make = [&](const E& inside, const E& touching) {
    return ShareBracket{combine(universe, inside), combine(universe, touching), {}, {}};
  };
  ShareBracket result = kind == Kind::And     ? make(ia & ib, ta & tb)
                        : kind == Kind::Or    ? make(ia | ib, ta | tb)
                        : kind == Kind::Minus ? make(ia - tb, ta - ib)
                                              : make((ia - tb) | (ib - ta), (ta | tb) - (ia & ib));
  const std::size_t count = result.touching.voxel_count() - result.inside.voxel_count();
  result.low.reserve(count);
  result.high.reserve(count);
  const Shares of_a(a), of_b(b);
  for_each_boundary_voxel({result.inside, result.touching, std::vector<std::uint16_t>(count)},
                          [&](const glm::ivec3& voxel, std::uint16_t) {
                            const Bounds bounds = combined(kind, of_a(voxel), of_b(voxel));
                            result.low.push_back(static_cast<std::uint16_t>(bounds.low));
                            result.high.push_back(static_cast<std::uint16_t>(bounds.high));
                          });
  return result;
}

ShareBracket complement(const ShareBracket& a) {
  const Octree all = Octree::full(a.inside.universe());
  ShareBracket result{combine(a.inside.universe(), Expression(all) - Expression(a.touching)),
                      combine(a.inside.universe(), Expression(all) - Expression(a.inside)), a.high, a.low};
  for (std::vector<std::uint16_t>* bounds : {&result.low, &result.high})
    for (std::uint16_t& bound : *bounds) bound = static_cast<std::uint16_t>(whole - bound);
  return result;
}

}  // namespace

ShareBracket bracket_of(const PartialOctree& partial) {
  check(partial);
  return {partial.inside, partial.touching, partial.fractions, partial.fractions};
}

ShareBracket combine_shares(const Expression& expression, const std::vector<ShareOperand>& operands) {
  // Copies of an expression share the same term, so a term's address identifies a symbol.
  std::unordered_map<const Expression::Term*, const ShareBracket*> shares;
  for (const ShareOperand& operand : operands) shares.emplace(&operand.symbol.term(), &operand.shares);
  using Term = Expression::Term;
  return evaluate_terms<ShareBracket>(
      expression,
      [&](const Term& term) {
        if (const auto found = shares.find(&term); found != shares.end()) return *found->second;
        throw InvalidInput("a part of the expression has no shares: digitise every operand as partial");
      },
      [](const Term& term, const ShareBracket& part) {
        if (term.kind == Kind::Moved)
          throw InvalidInput("shares cannot be moved: move the solid, then digitise it as partial");
        return complement(part);
      },
      [](const Term& term, const ShareBracket& left, const ShareBracket& right) {
        return combined(term.kind, left, right);
      });
}

VolumeBracket volume_mm3(const ShareBracket& bracket) {
  return {volume_mm3(PartialOctree{bracket.inside, bracket.touching, bracket.low}),
          volume_mm3(PartialOctree{bracket.inside, bracket.touching, bracket.high})};
}

PartialOctree middle(const ShareBracket& bracket) {
  PartialOctree result{bracket.inside, bracket.touching, {}};
  result.fractions.reserve(bracket.low.size());
  for (std::size_t i = 0; i < bracket.low.size(); ++i)
    result.fractions.push_back(static_cast<std::uint16_t>((bracket.low[i] + bracket.high[i] + 1) / 2));
  return result;
}

}  // namespace octotomy::voxel
