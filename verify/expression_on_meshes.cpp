// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Recursive descent over the expression's text, one function for each level of precedence, weakest first:
// union,
//   exclusive or, intersection, minus, then complement and parentheses, as in Python.
// 2 An expression that names a solid twice would corefine its surface with itself: (a ^ b) & a has a twice.
// If
//   there is a read-once expression of the same function, that is evaluated instead.
// 3 Corefinements from the leaves up; each gives a solid or the complement of one.
#include "verify/expression_on_meshes.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <stdexcept>

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

  /// What one operator joins is one tree, so that a long chain is no deep one.
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
    throw std::invalid_argument("expression '" + quoted + "', position " + std::to_string(at_ + 1) + ": " +
                                what + " expected");
  }

  /// Deeper than any plan's, and far from the end of the stack.
  static constexpr int most_nested = 200;

  std::string_view text_;
  std::vector<std::string> names_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

ExpressionTree expression_tree_of(std::string_view text, std::vector<std::string>& names) {
  Parser parser(text);
  ExpressionTree tree = parser.whole();
  names = parser.names();
  return tree;
}

SharedMesh MeshExpressions::evaluate(std::string_view text,
                                     const std::function<SharedMesh(std::string_view)>& lookup) {
  findings_.clear();
  std::vector<std::string> names;
  ExpressionTree tree = expression_tree_of(text, names);
  std::vector<SharedMesh> leaves;
  for (const std::string& name : names) leaves.push_back(lookup(name));
  // Without a repeated name the expression stays as it is, so that earlier answers serve again.
  if (tree.leaf_count() > static_cast<int>(leaves.size()))
    if (std::optional<ExpressionTree> once = read_once(tree)) tree = std::move(*once);
  const Signed answer = value(tree, leaves);
  return answer.complement ? boolean(world_, brep::Operation::Difference, answer.mesh) : answer.mesh;
}

MeshExpressions::Signed MeshExpressions::value(const ExpressionTree& tree,
                                               const std::vector<SharedMesh>& leaves) {
  const auto complement = [](Signed a) { return Signed{std::move(a.mesh), !a.complement}; };
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
  if (a.complement && b.complement) return {boolean(a.mesh, brep::Operation::Union, b.mesh), true};
  if (a.complement) return {boolean(b.mesh, brep::Operation::Difference, a.mesh), false};
  if (b.complement) return {boolean(a.mesh, brep::Operation::Difference, b.mesh), false};
  return {boolean(a.mesh, brep::Operation::Intersection, b.mesh), false};
}

SharedMesh MeshExpressions::boolean(const SharedMesh& a, brep::Operation operation, const SharedMesh& b) {
  using brep::Operation;
  // Decided without geometry; corefinement wants two distinct surfaces.
  if (a == b) return operation == Operation::Difference ? std::make_shared<brep::Mesh>() : a;
  if (a->n_faces() == 0) return operation == Operation::Union ? b : a;
  if (b->n_faces() == 0) return operation == Operation::Intersection ? b : a;

  auto& known = answers_[{a, b}];
  if (const auto found = known.find(operation); found != known.end()) return found->second;
  corefine(a, operation, b, known);
  return known.at(operation);
}

void MeshExpressions::corefine(const SharedMesh& a, brep::Operation operation, const SharedMesh& b,
                               std::map<brep::Operation, SharedMesh>& known) {
  using brep::Operation;
  const auto learn = [&](brep::Booleans& answers) {
    const auto keep = [&](Operation of, std::optional<brep::Mesh>& mesh) {
      if (mesh && !known.contains(of)) known[of] = std::make_shared<const brep::Mesh>(std::move(*mesh));
    };
    keep(Operation::Union, answers.united);
    keep(Operation::Intersection, answers.intersection);
    keep(Operation::Difference, answers.a_minus_b);
    findings_.insert(findings_.end(), answers.findings.begin(), answers.findings.end());
  };
  // A plan that takes a piece out of a skull asks for the rest next, and one that merges for the overlap.
  try {
    brep::Booleans answers = brep::booleans(*a, *b, {true, true, true, false});
    learn(answers);
    if (known.contains(operation)) return;
  } catch (const std::runtime_error&) {
    // Perhaps only an answer that nobody asked for cannot be represented. A stop ends the next call, too.
  }
  brep::Booleans answers =
      brep::booleans(*a, *b,
                     {operation == Operation::Union, operation == Operation::Intersection,
                      operation == Operation::Difference, false});
  learn(answers);
}

}  // namespace octotomy::verify
