// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/grey_owner.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "voxel/solid/combine.h"
#include "voxel/solid/operand_frame.h"
#include "voxel/solid/term_walk.h"

// Source: thesis 7.2 for grey operands. A walk collects the windows in reading order, with their motions,
// their signs and the operands of unions that must contain every voxel owned by the window. at() tests the
// windows in this order.

namespace octotomy::voxel {
namespace {

using TermPointer = std::shared_ptr<const Expression::Term>;

// An operand's voxels in the target. A source within the operand supplies samples only in these voxels or, if
// the operand is under an odd number of complements, only outside them.
struct Owner {
  Octree voxels;
  bool inside = true;
};

// A window as a source of samples.
struct Source {
  const Window* window = nullptr;
  glm::dmat4 source_from_target{1.0};
  std::optional<glm::ivec3> offset;  ///< set if source_from_target is a translation by whole voxels
  bool positive = true;              ///< whether it is under an even number of complements
  std::vector<std::shared_ptr<const Owner>> owners;
};

// Whether a voxel may be in a term because it is in only one operand. A complement exchanges And and Or (De
// Morgan).
bool is_alternative(Expression::Kind kind, bool positive) {
  using Kind = Expression::Kind;
  if (positive) return kind == Kind::Or || kind == Kind::Xor;
  return kind == Kind::And || kind == Kind::Minus;
}

// Whether the term is a leaf or a union or, under an odd number of complements, an intersection. Voxels need
// not be tested for such a term: windows are tested by their samples, and a union's operands by their own
// voxels.
bool owns_itself(const Expression::Term& term, bool positive) {
  using Kind = Expression::Kind;
  const Expression::Term* at = &term;
  while (at->kind == Kind::Moved) at = at->left.get();
  return at->kind == Kind::Leaf || at->kind == (positive ? Kind::Or : Kind::And);
}

// A part of an expression after the motions that enclose it, which are given outermost first.
Expression placed(TermPointer part, const std::vector<glm::dmat4>& around) {
  Expression expression{std::move(part)};
  for (auto motion = around.rbegin(); motion != around.rend(); ++motion)
    expression = carried(expression, *motion);
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
      // A leaf is visited once, other terms are visited before and after their operands.
      if (turns && (!met.before || met.term.kind == Kind::Leaf)) positive_ = !positive_;
    });
    return std::move(found_);
  }

 private:
  using Kind = Expression::Kind;
  // The state of a term between its two visits.
  struct Open {
    TermPointer alternative;  // null if the term's voxels need not be tested
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
  // Open::alternative of each term not yet visited, in the order of for_each_term()'s stack.
  std::vector<TermPointer> next_{nullptr};
  std::vector<Open> open_;
  bool positive_ = true;
};

// Whether both are the same terms in memory, or the same window under the same motions.
bool same_terms(const Expression::Term& one, const Expression::Term& other) {
  const Expression::Term *a = &one, *b = &other;
  while (a != b && a->kind == Expression::Kind::Moved && b->kind == Expression::Kind::Moved &&
         a->moved_from_still == b->moved_from_still) {
    a = a->left.get();
    b = b->left.get();
  }
  if (a == b) return true;
  if (a->kind != Expression::Kind::Leaf || b->kind != Expression::Kind::Leaf) return false;
  const auto* window = std::get_if<Window>(&*a->leaf);
  const auto* against = std::get_if<Window>(&*b->leaf);
  // Grey octrees are immutable and shared, so the address of the universe identifies the samples.
  return window != nullptr && against != nullptr && window->low == against->low &&
         window->high == against->high && &window->grey.universe() == &against->grey.universe();
}

}  // namespace

Expression all_samples(const GreyOctree& grey, const glm::dmat4& moved_from_still) {
  constexpr double low = std::numeric_limits<std::int16_t>::min();
  constexpr double high = std::numeric_limits<std::int16_t>::max();
  const Expression samples(Window{grey, low, high});
  return moved_from_still == glm::dmat4(1.0) ? samples : carried(samples, moved_from_still);
}

// The right side of the & contains all of space, so the intersection has exactly the voxels of `voxels`. In
// reading order the window of `samples` comes after the windows of `voxels`; it is tested by its own samples.
Expression with_samples(const Expression& voxels, const Expression& samples) {
  return voxels & (samples | ~Expression(Octree::empty({})));
}

const Expression::Term& before_samples(const Expression::Term& term) {
  using Kind = Expression::Kind;
  if (term.kind != Kind::And || term.right->kind != Kind::Or || term.right->right->kind != Kind::Not)
    return term;
  const Expression::Term& none = *term.right->right->left;
  const auto* octree = none.kind == Kind::Leaf ? std::get_if<Octree>(&*none.leaf) : nullptr;
  return octree != nullptr && octree->is_empty() ? *term.left : term;
}

std::vector<Window> positive_windows(const Expression& expression) {
  using Kind = Expression::Kind;
  std::vector<Window> found;
  bool positive = true;
  for_each_term(expression, [&](const MetTerm& met) {
    if (met.term.kind != Kind::Leaf) {
      // A walk visits a complement before its operand and again after it, so the second visit restores the
      // sign.
      if (met.subtracted != (met.term.kind == Kind::Not)) positive = !positive;
    } else if (const auto* window = std::get_if<Window>(&*met.term.leaf)) {
      if (positive != met.subtracted) found.push_back(*window);
    }
  });
  return found;
}

struct GreyOwners::Storage {
  Universe universe;
  std::vector<SampleSource> given;
  Interpolation samples;
  std::vector<Source> sources;

  struct Value {
    double value = 0.0;
    bool scanned = false;  ///< the nearest sample belongs to the scan
  };
  Value at_voxel(const Source& source, const glm::ivec3& voxel) const {
    if (!source.offset) return at_place(source, glm::dvec3(voxel));
    const GreyOctree& grey = source.window->grey;
    const glm::ivec3 at = voxel + *source.offset;
    return {static_cast<double>(grey.sample(at)), grey.scan().contains(at)};
  }
  Value at_place(const Source& source, const glm::dvec3& p_voxel) const {
    const GreyOctree& grey = source.window->grey;
    const glm::dvec3 p(source.source_from_target * glm::dvec4(p_voxel, 1.0));
    return {samples == Interpolation::Linear ? interpolate_scan(grey, p) : interpolate(grey, p, samples),
            grey.scan().contains(glm::ivec3(glm::floor(p + 0.5)))};
  }
  OwnedSample sample(const Source& source, const glm::ivec3& voxel, const glm::dvec3& p_voxel,
                     const Value& of_voxel) const {
    const double step = source.window->grey.step();
    if (p_voxel == glm::dvec3(voxel)) return {of_voxel.value, step};
    const Value here = at_place(source, p_voxel);
    return {here.scanned ? here.value : of_voxel.value, step};
  }
};

GreyOwners::GreyOwners(const Universe& universe, const std::vector<SampleSource>& sources,
                       const Resampling& resampling) {
  auto storage = std::make_shared<Storage>(Storage{universe, sources, resampling.samples, {}});
  for (const SampleSource& given : storage->given) {
    std::shared_ptr<const Owner> limit;
    if (given.voxels) limit = std::make_shared<const Owner>(Owner{*given.voxels, true});
    for (Source& source : SourceWalk(universe, resampling)(given.expression)) {
      if (given.step && source.window->grey.step() != *given.step) continue;
      if (limit) source.owners.push_back(limit);
      storage->sources.push_back(std::move(source));
    }
  }
  storage_ = std::move(storage);
}

std::optional<OwnedSample> GreyOwners::at(const glm::ivec3& voxel, const glm::dvec3& p_voxel) const {
  std::optional<OwnedSample> complement;
  for (const Source& source : storage_->sources) {
    const bool owned = std::all_of(source.owners.begin(), source.owners.end(), [&](const auto& owner) {
      return owner->voxels.contains(voxel) == owner->inside;
    });
    if (!owned) continue;
    const auto value = storage_->at_voxel(source, voxel);
    const bool holds =
        value.scanned && value.value >= source.window->low && value.value <= source.window->high;
    if (source.positive && holds) return storage_->sample(source, voxel, p_voxel, value);
    if (!source.positive && !holds && !complement)
      complement = storage_->sample(source, voxel, p_voxel, value);
  }
  return complement;
}

const Universe& GreyOwners::universe() const {
  return storage_->universe;
}

std::vector<Window> GreyOwners::windows() const {
  std::vector<Window> found;
  for (const Source& source : storage_->sources) found.push_back(*source.window);
  return found;
}

bool GreyOwners::is_same(const GreyOwners& other) const {
  return storage_ == other.storage_ ||
         (universe() == other.universe() &&
          std::equal(storage_->given.begin(), storage_->given.end(), other.storage_->given.begin(),
                     other.storage_->given.end(), [](const SampleSource& a, const SampleSource& b) {
                       return same_terms(a.expression.term(), b.expression.term()) && a.voxels == b.voxels &&
                              a.step == b.step;
                     }));
}

}  // namespace octotomy::voxel
