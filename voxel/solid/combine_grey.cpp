// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/combine_grey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "voxel/solid/combine.h"
#include "voxel/solid/operand_frame.h"
#include "voxel/solid/term_walk.h"
#include "voxel/tree/octree_node.h"

// Passes: 1 compute the expression's voxels as an octree; 2 collect its leaves by brick; 3 fill the bricks'
// samples, testing the windows in their order for each voxel, each within the operands that must own the
// voxel.

namespace octotomy::voxel {
namespace {

using TermPointer = std::shared_ptr<const Expression::Term>;

// An operand's voxels in the target: a source within the operand gives samples there only, or beyond them
// only if the operand is under an odd number of complements.
struct Owner {
  Octree voxels;
  bool inside = true;
};

// A window as a source of samples.
struct Source {
  const Window* window = nullptr;
  glm::dmat4 source_from_target{1.0};
  std::optional<glm::ivec3> offset;  ///< if source_from_target is a translation by whole voxels
  bool positive = true;              ///< under an even number of complements
  std::vector<std::shared_ptr<const Owner>> owners;
};

// Whether a voxel may be in a term because of one operand alone. A complement exchanges And and Or (De
// Morgan).
bool is_alternative(Expression::Kind kind, bool positive) {
  using Kind = Expression::Kind;
  if (positive) return kind == Kind::Or || kind == Kind::Xor;
  return kind == Kind::And || kind == Kind::Minus;
}

// Whether the term's windows are tested by their own samples or by operands of their own, so that the term's
// voxels add nothing.
bool owns_itself(const Expression::Term& term, bool positive) {
  using Kind = Expression::Kind;
  const Expression::Term* at = &term;
  while (at->kind == Kind::Moved) at = at->left.get();
  return at->kind == Kind::Leaf || at->kind == (positive ? Kind::Or : Kind::And);
}

// A part of an expression under the motions that stand around it, outermost first.
Expression placed(TermPointer part, const std::vector<glm::dmat4>& around) {
  Expression expression{std::move(part)};
  for (auto motion = around.rbegin(); motion != around.rend(); ++motion)
    expression = glm::determinant(glm::dmat3(*motion)) > 0.0 ? moved(expression, *motion)
                                                             : reflected(expression, *motion);
  return expression;
}

// The windows of an expression in reading order, each with its position in the target, its sign and the
// operands that must own a voxel for its sample to count.
class SourceWalk {
 public:
  SourceWalk(const Universe& target, const Resampling& resampling)
      : target_(target), resampling_(resampling) {}

  std::vector<Source> operator()(const Expression& expression) {
    for_each_term(expression, [&](const MetTerm& met) {
      const bool turns = met.subtracted != (met.term.kind == Kind::Not);
      if (met.before) {
        enter(met, turns);
      } else {
        if (met.term.kind == Kind::Moved) {
          motions_.pop_back();
          around_.pop_back();
        }
        leave();
      }
      // A leaf is visited once, the other terms before and after their operands.
      if (turns && (!met.before || met.term.kind == Kind::Leaf)) positive_ = !positive_;
    });
    return std::move(found_);
  }

 private:
  using Kind = Expression::Kind;
  // A term between its two visits.
  struct Open {
    TermPointer alternative;  // none if its voxels decide nothing
    bool positive = true;
    std::size_t first_source = 0;
  };

  void enter(const MetTerm& met, bool turns) {
    const Expression::Term& term = met.term;
    TermPointer alternative = std::move(next_.back());
    next_.pop_back();
    const bool positive = positive_ != met.subtracted;
    if (turns) positive_ = !positive_;
    if (term.kind == Kind::Leaf) {
      add(term);
      return;
    }
    if (alternative && owns_itself(term, positive)) alternative = nullptr;
    open_.push_back({std::move(alternative), positive, found_.size()});
    if (term.kind == Kind::Moved) {
      motions_.push_back(motions_.back() * term.moved_from_still);
      around_.push_back(term.moved_from_still);
    }
    const bool alternatives = is_alternative(term.kind, positive_);
    if (term.right) next_.push_back(alternatives ? term.right : nullptr);
    next_.push_back(alternatives ? term.left : nullptr);
  }

  void add(const Expression::Term& term) {
    const auto* window = std::get_if<Window>(&*term.leaf);
    if (window == nullptr) return;
    const glm::dmat4 source_from_target = glm::inverse(window->grey.universe().lps_from_voxel) *
                                          glm::inverse(motions_.back()) * target_.lps_from_voxel;
    found_.push_back({window, source_from_target, whole_voxel_offset(source_from_target), positive_, {}});
  }

  void leave() {
    const Open open = std::move(open_.back());
    open_.pop_back();
    if (!open.alternative || open.first_source == found_.size()) return;
    const auto owner = std::make_shared<const Owner>(
        Owner{combine(target_, placed(open.alternative, around_), resampling_), open.positive});
    for (std::size_t i = open.first_source; i < found_.size(); ++i) found_[i].owners.push_back(owner);
  }

  const Universe& target_;
  const Resampling& resampling_;
  std::vector<Source> found_;
  std::vector<glm::dmat4> motions_{glm::dmat4(1.0)};  // products, from outermost
  std::vector<glm::dmat4> around_;                    // the factors
  std::vector<TermPointer> next_{nullptr};  // for each term not yet visited, as for_each_term() has them
  std::vector<Open> open_;
  bool positive_ = true;
};

std::int16_t rounded(double value) {
  constexpr double low = std::numeric_limits<std::int16_t>::min();
  constexpr double high = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::clamp(std::floor(value + 0.5), low, high));
}

class Sampler {
 public:
  // `filled`: sample of the voxels that no source fills, in steps.
  Sampler(std::vector<Source> sources, const GreyResult& options, std::int16_t filled)
      : sources_(std::move(sources)), options_(options), filled_(filled) {}

  // Returns the sample of a voxel that the expression contains.
  std::int16_t operator()(const glm::ivec3& voxel) const {
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    double complement = nothing;
    for (const Source& source : sources_) {
      const bool owned = std::all_of(source.owners.begin(), source.owners.end(), [&](const auto& owner) {
        return owner->voxels.contains(voxel) == owner->inside;
      });
      if (!owned) continue;
      const auto [value, scanned] = value_at(source, voxel);
      const bool holds = scanned && value >= source.window->low && value <= source.window->high;
      if (source.positive && holds) return rounded(value);
      if (!source.positive && !holds && std::isnan(complement)) complement = value;
    }
    return std::isnan(complement) ? filled_ : rounded(complement);
  }

 private:
  struct Value {
    double value = 0.0;
    bool scanned = false;  ///< the nearest sample belongs to the scan
  };
  Value value_at(const Source& source, const glm::ivec3& voxel) const {
    const GreyOctree& grey = source.window->grey;
    if (source.offset) {
      const glm::ivec3 at = voxel + *source.offset;
      return {static_cast<double>(grey.sample(at)), grey.scan().contains(at)};
    }
    const glm::dvec3 p(source.source_from_target * glm::dvec4(glm::dvec3(voxel), 1.0));
    const Interpolation how = options_.resampling.samples;
    return {how == Interpolation::Linear ? interpolate_scan(grey, p) : interpolate(grey, p, how),
            grey.scan().contains(glm::ivec3(glm::floor(p + 0.5)))};
  }

  std::vector<Source> sources_;
  const GreyResult& options_;
  std::int16_t filled_;
};

// Leaf words of one block of height 2.
struct BlockWords {
  glm::ivec3 block{0};
  BlockRef words;
};

void collect(BlockRef block, int height, const glm::ivec3& at, int limit, std::vector<BlockWords>& into) {
  if (block.is_empty() || glm::any(glm::greaterThanEqual(at, glm::ivec3(limit)))) return;
  if (height == 2) {
    into.push_back({at, block});
    return;
  }
  const int side = 1 << (2 * (height - 3));  // of a child, in blocks
  for (int child = 0; child < 64; ++child)
    collect(block.child(child), height - 1, at + side * child_place(child), limit, into);
}

}  // namespace

GreyOctree combine_grey(const Universe& universe, const Expression& expression, const GreyResult& options) {
  const Octree voxels = combine(universe, expression, options.resampling);
  std::vector<BlockWords> held;
  collect(voxels.root(), voxels.root_height(), glm::ivec3(0), (universe.side() + 15) / 16, held);
  std::vector<glm::ivec3> blocks;
  blocks.reserve(held.size());
  for (const BlockWords& block : held) blocks.push_back(block.block);

  std::vector<Source> sources = SourceWalk(universe, options.resampling)(expression);
  const double step = sources.empty() ? 1.0 : sources.front().window->grey.step();
  for (const Source& source : sources)
    if (source.window->grey.step() != step)
      throw std::invalid_argument("grey octrees whose samples count in steps of " + std::to_string(step) +
                                  " and " + std::to_string(source.window->grey.step()) +
                                  " cannot be one: make both of whole numbers");
  const std::int16_t background = rounded(options.background / step);
  const Sampler sample(std::move(sources), options, rounded(options.filled / step));
  const auto fill = [&](std::size_t i, GreyBrick& brick) {
    for (int leaf = 0; leaf < 64; ++leaf) {
      const glm::ivec3 origin = 16 * held[i].block + 4 * child_place(leaf);
      const std::uint64_t word = held[i].words.word(leaf);
      for (int bit = 0; bit < 64; ++bit)
        brick.samples[static_cast<std::size_t>(leaf)][static_cast<std::size_t>(bit)] =
            (word >> bit) & 1 ? sample(origin + child_place(bit)) : background;
    }
  };
  return grey_octree_of_bricks(universe, background, blocks, fill, voxels, step);
}

}  // namespace octotomy::voxel
