// SPDX-License-Identifier: AGPL-3.0-or-later
// Witnesses of the results of operations: intersections, motions, expressions.
#include "verify/witness/witness.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "verify/question/expression_on_meshes.h"
#include "verify/witness/affine.h"
#include "verify/witness/joined_reading.h"

namespace octotomy::verify {
namespace {

/// Cost of reading a witness. Cheap operands are read first, because one that decides makes the others
/// unnecessary.
double cost_of(const Witness& witness) {
  constexpr double of_a_window = 100.0;
  return witness.lines() ? witness.lines().cost : of_a_window;
}

/// Whether no further operand of an intersection can change the needed parts of the reading.
bool decides(const Reading& a, ReadingNeeds asked) {
  return !needs_surfaces(asked) && a.mesh == certainly_out &&
         (!needs_voxels(asked) || a.voxel == certainly_out);
}

/// An operand of an intersection, or its complement.
struct Operand {
  Witness witness;
  bool is_complement = false;
};
Witness intersection(Operand a, Operand b) {
  if (!a.witness || !b.witness) return {};
  if (cost_of(b.witness) < cost_of(a.witness)) std::swap(a, b);
  return [a = std::move(a), b = std::move(b)](const glm::dvec3& p_mm, double slack_mm,
                                              ReadingNeeds asked) -> Reading {
    const auto read = [&](const Operand& operand) {
      const Reading reading = operand.witness(p_mm, slack_mm, asked);
      return operand.is_complement ? negated(reading) : reading;
    };
    const Reading first = read(a);
    return decides(first, asked) ? first : conjunction(first, read(b));
  };
}

/// The factor by which a map may lengthen a distance: 1 for a motion or a reflection. For other maps an upper
/// bound, the Frobenius norm, which is at most the root of 3 times the largest singular value.
double stretch_of(const glm::dmat4& map) {
  constexpr double rounding = 1e-5;  // matrices in plans are written with six decimals
  const glm::dmat3 off = glm::transpose(glm::dmat3(map)) * glm::dmat3(map) - glm::dmat3(1.0);
  double squares = 0.0, worst = 0.0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      worst = std::max(worst, std::abs(off[column][row]));
      squares += map[column][row] * map[column][row];
    }
  return worst <= rounding ? 1.0 : std::sqrt(squares);
}

/// The choices of all operands, without duplicates.
std::vector<PartChoice> choices_of(const std::vector<Witness>& operands) {
  std::vector<PartChoice> all;
  for (const Witness& operand : operands)
    for (const PartChoice& choice : operand.choices())
      if (std::none_of(all.begin(), all.end(), [&](const PartChoice& known) {
            return known.necks == choice.necks && known.chosen_from_made == choice.chosen_from_made;
          }))
        all.push_back(choice);
  return all;
}

/// Reads an expression. Operand i is leaf i of the tree.
class ReadExpression {
 public:
  ReadExpression(const ExpressionTree& tree, std::vector<Witness> leaves)
      : leaves_(std::move(leaves)),
        is_read_once_(static_cast<std::size_t>(tree.leaf_count()) == leaves_.size()),
        whole_(joint_of(tree)) {}

  Reading operator()(const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked) const {
    if (is_read_once_)
      return read(
          whole_, [&](std::size_t leaf) { return leaves_[leaf](p_mm, slack_mm, asked); }, asked);
    std::vector<std::optional<Reading>> known(leaves_.size());
    const auto once = [&](std::size_t leaf) {
      if (!known[leaf]) known[leaf] = leaves_[leaf](p_mm, slack_mm, asked);
      return *known[leaf];
    };
    return read(whole_, once, asked);
  }

 private:
  /// A leaf, or an intersection or exclusive or of parts. The result is complemented if `is_complement`.
  struct Joint {
    bool is_complement = false, is_exclusive = false;
    std::size_t leaf = 0;
    double cost = 0.0;
    std::vector<Joint> parts = {};
  };

  Joint joint_of(const ExpressionTree& tree) const {
    Joint made;
    if (tree.parts.empty()) {
      made.leaf = static_cast<std::size_t>(tree.leaf);
      made.cost = cost_of(leaves_[made.leaf]);
      return made;
    }
    for (const ExpressionTree& part : tree.parts) {
      made.parts.push_back(joint_of(part));
      made.cost += made.parts.back().cost;
    }
    const auto complement = [](Joint& part) { part.is_complement = !part.is_complement; };
    made.is_exclusive = tree.symbol == '^';
    if (tree.symbol == '~') made.is_complement = true;
    if (tree.symbol == '-') std::for_each(made.parts.begin() + 1, made.parts.end(), complement);
    if (tree.symbol == '|') {
      made.is_complement = true;
      std::for_each(made.parts.begin(), made.parts.end(), complement);
    }
    std::stable_sort(made.parts.begin(), made.parts.end(),
                     [](const Joint& a, const Joint& b) { return a.cost < b.cost; });
    return made;
  }

  /// The recursion is as deep as the text's parentheses. Operands in a row do not deepen it.
  template <typename ReadLeaf>
  static Reading read(const Joint& joint, const ReadLeaf& leaf, ReadingNeeds asked) {
    if (joint.parts.empty()) return joint.is_complement ? negated(leaf(joint.leaf)) : leaf(joint.leaf);
    Reading made = read(joint.parts.front(), leaf, asked);
    for (std::size_t i = 1; i < joint.parts.size() && (joint.is_exclusive || !decides(made, asked)); ++i) {
      const Reading next = read(joint.parts[i], leaf, asked);
      made = joint.is_exclusive ? exclusive(made, next) : conjunction(made, next);
    }
    return joint.is_complement ? negated(made) : made;
  }

  std::vector<Witness> leaves_;
  bool is_read_once_;  ///< no leaf occurs twice
  Joint whole_;
};

}  // namespace

Witness both(Witness a, Witness b) {
  LineReading lines = lines_in_both(a.lines(), b.lines());
  std::vector<PartChoice> choices = choices_of({a, b});
  return intersection({std::move(a)}, {std::move(b)})
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

Witness without(Witness a, Witness b) {
  LineReading lines = lines_without(a.lines(), b.lines());
  std::vector<PartChoice> choices = choices_of({a, b});
  return intersection({std::move(a)}, {std::move(b), true})
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

Witness carried(Witness still, const glm::dmat4& moved_from_still) {
  if (!still) return {};
  LineReading lines = lines_moved(still.lines(), moved_from_still);
  const glm::dmat4 still_from_moved = glm::inverse(moved_from_still);
  const double longest = stretch_of(still_from_moved);
  std::vector<PartChoice> choices = still.choices();
  for (PartChoice& choice : choices) choice.chosen_from_made = choice.chosen_from_made * still_from_moved;
  return Witness([still = std::move(still), back = Affine(still_from_moved), longest](
                     const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked) {
           return still(back(p_mm), slack_mm * longest, asked);
         })
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

Witness loosened(Witness tight, double by_mm) {
  if (!tight) return {};
  LineReading lines = tight.lines();
  std::vector<PartChoice> choices = tight.choices();
  return Witness(
             [tight = std::move(tight), by_mm](const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked) {
               return tight(p_mm, slack_mm + by_mm, asked);
             })
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

Witness with_voxels_within(Witness tight, double by_mm) {
  if (!tight) return {};
  LineReading lines = tight.lines();
  std::vector<PartChoice> choices = tight.choices();
  return Witness(
             [tight = std::move(tight), by_mm](const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked) {
               Reading reading = tight(p_mm, slack_mm, asked);
               if (needs_voxels(asked) && !reading.voxel.near)
                 reading.voxel = tight(p_mm, slack_mm + by_mm, ReadingNeeds::BothSides).voxel;
               return reading;
             })
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

Witness witness_of_expression(std::string_view text,
                              const std::function<Witness(const std::string&)>& lookup) {
  std::vector<std::string> names;
  const ExpressionTree tree = expression_tree_of(text, names);
  std::vector<Witness> leaves;
  for (const std::string& name : names) {
    leaves.push_back(lookup(name));
    if (!leaves.back()) return {};
  }
  LineReading lines =
      lines_in_expression(text, [&](const std::string& name) { return lookup(name).lines(); });
  std::vector<PartChoice> choices = choices_of(leaves);
  const auto read = std::make_shared<const ReadExpression>(tree, std::move(leaves));
  return Witness([read](const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked) {
           return (*read)(p_mm, slack_mm, asked);
         })
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

}  // namespace octotomy::verify
