// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Parse the text by recursive descent, with one function for each level of precedence, weakest first:
//   union, exclusive or, intersection, minus, then complement and parentheses, as in Python.
// 2 Replace an expression that names a solid twice, such as (a ^ b) & a, by a read-once expression of the
//   same function if there is one. Otherwise a surface would be corefined with itself.
// 3 Corefine from the leaves up. Each result is a solid or the complement of a solid.
#include "verify/question/expression_on_meshes.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <stdexcept>
#include <utility>

#include "brep/boolean/common_faces.h"
#include "brep/mesh/error.h"
#include "voxel/space/error.h"

namespace octotomy::verify {

namespace {

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  ExpressionTree whole() {
    ExpressionTree answer = either();
    skip_blanks();
    if (at_ < text_.size()) expected("an operator or the end");
    return answer;
  }
  /// Leaf i is names()[i].
  const std::vector<std::string>& names() const { return names_; }

 private:
  ExpressionTree either() { return chain('|', &Parser::one_of); }
  ExpressionTree one_of() { return chain('^', &Parser::both); }
  ExpressionTree both() { return chain('&', &Parser::minus); }
  ExpressionTree minus() { return chain('-', &Parser::single); }

  /// Parses operands that are joined by one operator into the parts of a single tree node, so that a long
  /// chain has little depth.
  ExpressionTree chain(char symbol, ExpressionTree (Parser::*part)()) {
    ExpressionTree first = (this->*part)();
    if (!take(symbol)) return first;
    ExpressionTree all{symbol, 0, {std::move(first)}};
    do all.parts.push_back((this->*part)());
    while (take(symbol));
    return all;
  }
  ExpressionTree single() {
    if (++depth_ > most_nested)
      expected("an expression nested at most " + std::to_string(most_nested) + " deep");
    ExpressionTree tree = nested();
    --depth_;
    return tree;
  }
  ExpressionTree nested() {
    if (take('~')) return {'~', 0, {single()}};
    if (take('(')) {
      ExpressionTree inner = either();
      if (!take(')')) expected("')'");
      return inner;
    }
    skip_blanks();
    const std::size_t first = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_'))
      ++at_;
    if (at_ == first) expected("a name, '~' or '('");
    const std::string name(text_.substr(first, at_ - first));
    const auto found = std::find(names_.begin(), names_.end(), name);
    const auto number = static_cast<int>(found - names_.begin());
    if (found == names_.end()) names_.push_back(name);
    return {0, number, {}};
  }

  void skip_blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool take(char symbol) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != symbol) return false;
    ++at_;
    return true;
  }
  [[noreturn]] void expected(const std::string& what) const {
    constexpr std::size_t most_quoted = 200;
    const std::string quoted =
        text_.size() <= most_quoted ? std::string(text_) : std::string(text_.substr(0, most_quoted)) + "...";
    throw voxel::InvalidInput("expression '" + quoted + "', position " + std::to_string(at_ + 1) + ": " +
                              what + " expected");
  }

  /// Largest depth of parentheses: deeper than in any plan, and far from a stack overflow.
  static constexpr int most_nested = 200;

  std::string_view text_;
  std::vector<std::string> names_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

/// An expression, with the names of its leaves by their numbers.
struct Named {
  ExpressionTree tree;
  std::vector<std::string> names;

  static Named of(std::string_view text) {
    Named made;
    made.tree = expression_tree_of(text, made.names);
    return made;
  }

  bool repeats() const { return tree.leaf_count() > static_cast<int>(names.size()); }
  /// Replaces the tree by a read-once tree of the same function. Returns false if there is none.
  bool read_once() {
    std::optional<ExpressionTree> once = verify::read_once(tree);
    if (once) tree = std::move(*once);
    return once.has_value();
  }
  /// Returns an expression of the same solid in which each leaf is replaced by its origin, until the leaves
  /// are solids without an origin.
  Named by_origins(const MeshExpressions::Origin& origin) const {
    Named made;
    made.tree = made.adopted(tree, names, origin);
    return made;
  }

 private:
  /// Once an expression has this many leaves, by_origins() keeps further leaves instead of replacing them by
  /// their origins, because nested origins can grow exponentially. read_once() needs far fewer leaves.
  static constexpr std::size_t most_leaves = 64;

  /// Converts a tree whose leaves are numbered by `its_names` to the numbers of this expression. Replaces
  /// leaves by their origins.
  ExpressionTree adopted(const ExpressionTree& other, const std::vector<std::string>& its_names,
                         const MeshExpressions::Origin& origin) {
    if (other.parts.empty()) {
      const std::string& name = its_names[static_cast<std::size_t>(other.leaf)];
      if (const std::string text = adopted_ < most_leaves ? origin(name) : ""; !text.empty()) {
        const Named inner = Named::of(text);
        return adopted(inner.tree, inner.names, origin);
      }
      ++adopted_;
      const auto found = std::find(names.begin(), names.end(), name);
      const auto number = static_cast<int>(found - names.begin());
      if (found == names.end()) names.push_back(name);
      return {0, number, {}};
    }
    ExpressionTree made{other.symbol, 0, {}};
    for (const ExpressionTree& part : other.parts) made.parts.push_back(adopted(part, its_names, origin));
    return made;
  }

  std::size_t adopted_ = 0;
};

}  // namespace

ExpressionTree expression_tree_of(std::string_view text, std::vector<std::string>& names) {
  Parser parser(text);
  ExpressionTree tree = parser.whole();
  names = parser.names();
  return tree;
}

brep::Solid MeshExpressions::evaluate(std::string_view text, const Lookup& lookup,
                                      const std::stop_token& stop, const Origin& origin,
                                      const Choice& choice) {
  findings_.clear();
  shift_mm_ = 0.0;
  stop_ = stop;
  Named expression = Named::of(text);
  if (origin && choice)
    if (std::optional<brep::Solid> made =
            less_parts(expression.tree, expression.names, lookup, origin, choice))
      return *made;
  // Without a repeated name the expression is not changed, so that the answers kept in `pairs_` can be used.
  if (origin) {
    Named by_origins = expression.by_origins(origin);
    if (by_origins.repeats() && by_origins.read_once()) expression = std::move(by_origins);
  }
  if (expression.repeats()) expression.read_once();
  std::vector<brep::Solid> leaves;
  for (const std::string& name : expression.names) leaves.push_back(lookup(name));
  const Signed answer = value(expression.tree, leaves);
  return answer.complement ? boolean(world_, brep::Operation::Difference, answer.solid) : answer.solid;
}

std::optional<brep::Solid> MeshExpressions::less_parts(const ExpressionTree& tree,
                                                       const std::vector<std::string>& names,
                                                       const Lookup& lookup, const Origin& origin,
                                                       const Choice& choice) {
  const bool is_less = tree.symbol == '-' && tree.parts.size() == 2 && names.size() == 2 &&
                       tree.parts[0].parts.empty() && tree.parts[1].parts.empty();
  if (!is_less) return std::nullopt;
  const std::string &whole = names[0], &part = names[1];
  const std::optional<PartsOf> parts = choice(part);
  if (!parts) return std::nullopt;
  // The solid from which the parts were chosen must be an intersection of `whole` with another solid.
  const std::string text = origin(parts->whole);
  if (text.empty()) return std::nullopt;
  const Named cut = Named::of(text);
  const bool is_within =
      cut.tree.symbol == '&' &&
      std::any_of(cut.tree.parts.begin(), cut.tree.parts.end(), [&](const ExpressionTree& operand) {
        return operand.parts.empty() && cut.names[static_cast<std::size_t>(operand.leaf)] == whole;
      });
  if (!is_within) return std::nullopt;
  brep::Solid rest = evaluate(whole + " - " + parts->whole, lookup, stop_, origin);
  if (parts->others.empty()) return rest;
  return brep::united_at_common_faces(rest, parts->others);
}

MeshExpressions::Signed MeshExpressions::value(const ExpressionTree& tree,
                                               const std::vector<brep::Solid>& leaves) {
  const auto complement = [](Signed a) { return Signed{std::move(a.solid), !a.complement}; };
  if (tree.parts.empty()) return {leaves[static_cast<std::size_t>(tree.leaf)], false};
  Signed a = value(tree.parts[0], leaves);
  if (tree.symbol == '~') return complement(a);
  for (std::size_t i = 1; i < tree.parts.size(); ++i) {
    const Signed b = value(tree.parts[i], leaves);
    const auto any = [&] { return complement(intersection(complement(a), complement(b))); };
    switch (tree.symbol) {
      case '&':
        a = intersection(a, b);
        break;
      case '|':
        a = any();
        break;
      case '-':
        a = intersection(a, complement(b));
        break;
      default:
        a = intersection(any(), complement(intersection(a, b)));
    }
  }
  return a;
}

MeshExpressions::Signed MeshExpressions::intersection(const Signed& a, const Signed& b) {
  if (a.complement && b.complement) return {boolean(a.solid, brep::Operation::Union, b.solid), true};
  if (a.complement) return {boolean(b.solid, brep::Operation::Difference, a.solid), false};
  if (b.complement) return {boolean(a.solid, brep::Operation::Difference, b.solid), false};
  return {boolean(a.solid, brep::Operation::Intersection, b.solid), false};
}

brep::Solid MeshExpressions::boolean(const brep::Solid& a, brep::Operation operation, const brep::Solid& b) {
  using brep::Operation;
  // These cases need no corefinement, which requires two distinct and non-empty surfaces.
  if (a.is_same(b)) return operation == Operation::Difference ? brep::Solid() : a;
  if (a.empty()) return operation == Operation::Union ? b : a;
  if (b.empty()) return operation == Operation::Intersection ? b : a;

  Pair& pair = pairs_.try_emplace({&a.linked(), &b.linked()}, Pair{a, b, {}}).first->second;
  if (!pair.answers.contains(operation)) corefine(operation, pair);
  shift_mm_ += pair.shift_mm;
  return pair.answers.at(operation);
}

void MeshExpressions::corefine(brep::Operation operation, Pair& pair) {
  using brep::Operation;
  const auto learn = [&](const brep::Booleans& answers) {
    const auto keep = [&](Operation of, const std::optional<brep::Solid>& solid) {
      if (solid) pair.answers.try_emplace(of, *solid);
    };
    pair.shift_mm = std::max(pair.shift_mm, answers.shift_mm);
    keep(Operation::Union, answers.united);
    keep(Operation::Intersection, answers.intersection);
    keep(Operation::Difference, answers.a_minus_b);
    findings_.insert(findings_.end(), answers.findings.begin(), answers.findings.end());
  };
  // All three answers are computed at once: a plan that cuts a piece out of a skull usually needs the rest
  // next, and a plan that merges solids needs the overlap.
  try {
    learn(brep::booleans(pair.a, pair.b, {true, true, true, false}, stop_));
    if (pair.answers.contains(operation)) return;
  } catch (const brep::Error& error) {
    // The error may concern only one of the other two answers, so the required answer is now computed alone.
    if (error.code() == brep::ErrorCode::Cancelled) throw;
  }
  learn(brep::booleans(pair.a, pair.b,
                       {operation == Operation::Union, operation == Operation::Intersection,
                        operation == Operation::Difference, false},
                       stop_));
}

}  // namespace octotomy::verify
