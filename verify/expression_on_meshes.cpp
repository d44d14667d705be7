// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A recursive descent over the expression's text that answers each rule with a solid or the complement of
// one. One function a level of precedence, weakest first: union, exclusive or, intersection, minus, and last
// complement and parentheses, as Python has them.
#include "verify/expression_on_meshes.h"

#include <cctype>
#include <optional>
#include <stdexcept>

namespace octotomy::verify {

class MeshExpressions::Parser {
 public:
  using Names = std::function<SharedMesh(std::string_view)>;
  Parser(MeshExpressions& owner, std::string_view text, const Names& names)
      : owner_(owner), text_(text), names_(names) {}

  Signed whole() {
    Signed answer = either();
    skip_blanks();
    if (at_ < text_.size()) expected("an operator or the end");
    return answer;
  }

 private:
  Signed either() {
    Signed left = one_of();
    while (take('|')) left = any(left, one_of());
    return left;
  }
  Signed one_of() {
    Signed left = both();
    while (take('^')) {
      const Signed right = both();
      left = owner_.intersection(any(left, right), complement(owner_.intersection(left, right)));
    }
    return left;
  }
  Signed both() {
    Signed left = minus();
    while (take('&')) left = owner_.intersection(left, minus());
    return left;
  }
  Signed minus() {
    Signed left = single();
    while (take('-')) left = owner_.intersection(left, complement(single()));
    return left;
  }
  Signed single() {
    if (take('~')) return complement(single());
    if (take('(')) {
      Signed inner = either();
      if (!take(')')) expected("')'");
      return inner;
    }
    skip_blanks();
    const std::size_t first = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_'))
      ++at_;
    if (at_ == first) expected("a name, '~' or '('");
    return {names_(text_.substr(first, at_ - first)), false};
  }

  Signed any(const Signed& a, const Signed& b) {
    return complement(owner_.intersection(complement(a), complement(b)));
  }
  static Signed complement(Signed a) { return {std::move(a.mesh), !a.complement}; }
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

  MeshExpressions& owner_;
  std::string_view text_;
  const Names& names_;
  std::size_t at_ = 0;
};

SharedMesh MeshExpressions::evaluate(std::string_view text,
                                     const std::function<SharedMesh(std::string_view)>& lookup) {
  findings_.clear();
  const Signed answer = Parser(*this, text, lookup).whole();
  return answer.complement ? boolean(world_, brep::Operation::Difference, answer.mesh) : answer.mesh;
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
