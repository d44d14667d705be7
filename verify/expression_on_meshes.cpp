// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 A recursive descent over the expression's text: one function a level of precedence, weakest first: union,
//   exclusive or, intersection, minus, and last complement and parentheses, as Python has them.
// 2 An expression that names a solid twice would let its surface meet itself: (a ^ b) & a has all of what
//   remains of it twice. It is written anew with each name once, where that can be done.
// 3 Corefinements, from the leaves up, each answer a solid or the complement of one.
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

  Tree whole() {
    Tree answer = either();
    skip_blanks();
    if (at_ < text_.size()) expected("an operator or the end");
    return answer;
  }
  /// Leaf i is names()[i].
  const std::vector<std::string>& names() const { return names_; }

 private:
  Tree either() {
    Tree left = one_of();
    while (take('|')) left = {'|', 0, {left, one_of()}};
    return left;
  }
  Tree one_of() {
    Tree left = both();
    while (take('^')) left = {'^', 0, {left, both()}};
    return left;
  }
  Tree both() {
    Tree left = minus();
    while (take('&')) left = {'&', 0, {left, minus()}};
    return left;
  }
  Tree minus() {
    Tree left = single();
    while (take('-')) left = {'-', 0, {left, single()}};
    return left;
  }
  Tree single() {
    if (take('~')) return {'~', 0, {single()}};
    if (take('(')) {
      Tree inner = either();
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
    throw std::invalid_argument("expression '" + std::string(text_) + "', position " +
                                std::to_string(at_ + 1) + ": " + what + " expected");
  }

  std::string_view text_;
  std::vector<std::string> names_;
  std::size_t at_ = 0;
};

}  // namespace

SharedMesh MeshExpressions::evaluate(std::string_view text,
                                     const std::function<SharedMesh(std::string_view)>& lookup) {
  findings_.clear();
  Parser parser(text);
  Tree tree = parser.whole();
  std::vector<SharedMesh> leaves;
  for (const std::string& name : parser.names()) leaves.push_back(lookup(name));
  // As it stands where no name repeats: earlier answers are used again.
  if (tree.leaf_count() > static_cast<int>(leaves.size()))
    if (std::optional<Tree> once = mentioned_once(tree)) tree = std::move(*once);
  const Signed answer = value(tree, leaves);
  return answer.complement ? boolean(world_, brep::Operation::Difference, answer.mesh) : answer.mesh;
}

MeshExpressions::Signed MeshExpressions::value(const Tree& tree, const std::vector<SharedMesh>& leaves) {
  const auto complement = [](Signed a) { return Signed{std::move(a.mesh), !a.complement}; };
  if (tree.parts.empty()) return {leaves[static_cast<std::size_t>(tree.leaf)], false};
  const Signed a = value(tree.parts[0], leaves);
  if (tree.symbol == '~') return complement(a);
  const Signed b = value(tree.parts[1], leaves);
  const auto any = [&] { return complement(intersection(complement(a), complement(b))); };
  switch (tree.symbol) {
    case '&':
      return intersection(a, b);
    case '|':
      return any();
    case '-':
      return intersection(a, complement(b));
    default:
      return intersection(any(), complement(intersection(a, b)));
  }
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
    // One that nobody asked for may be what cannot be represented.
  }
  brep::Booleans answers =
      brep::booleans(*a, *b,
                     {operation == Operation::Union, operation == Operation::Intersection,
                      operation == Operation::Difference, false});
  learn(answers);
}

}  // namespace octotomy::verify
