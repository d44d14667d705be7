// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/expression.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <stdexcept>
#include <unordered_set>

#include "voxel/solid/term_walk.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

// Whether all entries of the matrix are finite and its last row is 0 0 0 1.
bool is_affine(const glm::dmat4& matrix) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(matrix[column][row]) || (row == 3 && matrix[column][3] != (column == 3 ? 1.0 : 0.0)))
        return false;
  return true;
}

// Whether the matrix is affine and preserves lengths. It is rigid if its determinant is also positive.
bool is_affine_isometry(const glm::dmat4& matrix) {
  return is_affine(matrix) && is_isometry(glm::dmat3(matrix));
}

// Whether the map has an inverse. Compares the volume of the parallelepiped of the columns with that of a box
// with the columns' lengths as edges. The determinant of a singular matrix is a sum of six products that
// cancel except for a few rounding errors, which are relative to the box's volume.
bool has_inverse(const glm::dmat3& map) {
  const double box = glm::length(map[0]) * glm::length(map[1]) * glm::length(map[2]);
  const double volume = std::abs(glm::determinant(map));
  return std::isfinite(box) && volume > 64.0 * std::numeric_limits<double>::epsilon() * box &&
         std::isfinite(1.0 / volume);
}

// Every rule of the grammar passes its result to a callback, so that one parser serves both for evaluation
// and for the list of names.
template <typename Value, typename Object, typename Moved, typename Apply, typename Complement>
class Parser {
 public:
  Parser(std::string_view text, Object object, Moved moved, Apply apply, Complement complement)
      : text_(text),
        object_(std::move(object)),
        moved_(std::move(moved)),
        apply_(std::move(apply)),
        complement_(std::move(complement)) {}

  Value parse() {
    Value value = binary(0);
    skip_space();
    if (at_ != text_.size()) fail("expected an operator & | - ^ or the end");
    return value;
  }

 private:
  static constexpr std::string_view operators = "|^&-";
  // The deepest nesting that is accepted: deeper than in any plan, and far below the depth that exhausts the
  // stack.
  static constexpr int max_nesting = 200;

  Value binary(std::size_t strength) {
    if (strength == operators.size()) return unary();
    Value value = binary(strength + 1);
    while (take(operators[strength])) value = apply_(operators[strength], value, binary(strength + 1));
    return value;
  }

  Value unary() {
    if (++nesting_ > max_nesting) fail("nested more than 200 deep");
    Value value = primary();
    --nesting_;
    return value;
  }

  Value primary() {
    if (take('~')) return complement_(unary());
    if (take('(')) {
      Value value = binary(0);
      if (!take(')')) fail("expected ')'");
      return value;
    }
    const std::size_t start = skip_space();
    const std::string_view name = identifier();
    if (name.empty()) fail("expected a name, '~', 'move(' or '('");
    if (name != "move" || !take('(')) return named(start, [&] { return object_(name); });
    Value value = binary(0);
    if (!take(',')) fail("expected ',' and the name of a motion");
    const std::size_t motion_start = skip_space();
    const std::string_view motion = identifier();
    if (motion.empty()) fail("expected the name of a motion");
    value = named(motion_start, [&] { return moved_(value, motion); });
    if (!take(')')) fail("expected ')'");
    return value;
  }

  template <typename Lookup>
  Value named(std::size_t start, const Lookup& lookup) {
    try {
      return lookup();
    } catch (const InvalidInput& refusal) {
      at_ = start;
      fail(refusal.what());
    }
  }

  std::string_view identifier() {
    const std::size_t start = skip_space();
    const auto is_part = [&](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    while (at_ < text_.size() && is_part(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }

  std::size_t skip_space() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_;
  }

  bool take(char wanted) {
    skip_space();
    if (at_ == text_.size() || text_[at_] != wanted) return false;
    ++at_;
    return true;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    // Of a long text only the part around the error is quoted.
    constexpr std::size_t most_quoted = 200;
    const bool whole = text_.size() <= most_quoted;
    const std::size_t from = whole ? 0 : std::max(at_, most_quoted / 2) - most_quoted / 2;
    const std::string quoted(text_.substr(from, most_quoted));
    throw InvalidInput("expression \"" + (whole ? quoted : "..." + quoted + "...") + "\", character " +
                       std::to_string(at_ + 1) + ": " + reason);
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int nesting_ = 0;
  Object object_;
  Moved moved_;
  Apply apply_;
  Complement complement_;
};

template <typename Value, typename... Actions>
Value parse(std::string_view text, Actions... actions) {
  return Parser<Value, Actions...>(text, std::move(actions)...).parse();
}

}  // namespace

// Destroys terms without other owners one by one, without recursion.
Expression::Term::~Term() {
  std::vector<std::shared_ptr<const Term>> open;
  const auto take = [&](std::shared_ptr<const Term>& operand) {
    if (operand.use_count() == 1) open.push_back(std::move(operand));
  };
  take(left);
  take(right);
  while (!open.empty()) {
    const std::shared_ptr<const Term> last = std::move(open.back());
    open.pop_back();
    // Removing const is allowed, because every term is created as a non-const Term and this one has no other
    // owner.
    auto& term = const_cast<Term&>(*last);
    take(term.left);
    take(term.right);
  }
}

Expression::Expression(Leaf leaf) {
  std::visit(
      [](const auto& object) {
        if constexpr (requires { check(object); }) check(object);
      },
      leaf);
  auto term = std::make_shared<Term>();
  term->leaf = std::move(leaf);
  term_ = std::move(term);
}

Expression::Expression(Kind kind, const Expression& a, const Expression& b) {
  auto term = std::make_shared<Term>();
  term->kind = kind;
  term->left = a.term_;
  term->right = b.term_;
  term_ = std::move(term);
}

Expression operator~(const Expression& a) {
  auto term = std::make_shared<Expression::Term>();
  term->kind = Expression::Kind::Not;
  term->left = a.term_;
  return Expression(std::shared_ptr<const Expression::Term>(std::move(term)));
}

Expression moved(const Expression& a, const glm::dmat4& moved_from_still) {
  if (!is_affine_isometry(moved_from_still) || glm::determinant(glm::dmat3(moved_from_still)) < 0.0)
    throw InvalidInput("a motion must be rigid: a rotation and a translation");
  return carried(a, moved_from_still);
}

Expression reflected(const Expression& a, const glm::dmat4& mirrored_from_still) {
  if (!is_affine_isometry(mirrored_from_still) || glm::determinant(glm::dmat3(mirrored_from_still)) > 0.0)
    throw InvalidInput("a reflection must preserve lengths and reverse orientation");
  return carried(a, mirrored_from_still);
}

Expression carried(const Expression& a, const glm::dmat4& carried_from_still) {
  if (!is_affine(carried_from_still) || !has_inverse(glm::dmat3(carried_from_still)))
    throw InvalidInput("a map of an object must be affine, finite and have an inverse");
  auto term = std::make_shared<Expression::Term>();
  term->kind = Expression::Kind::Moved;
  term->left = a.term_;
  term->moved_from_still = carried_from_still;
  return Expression(std::shared_ptr<const Expression::Term>(std::move(term)));
}

glm::dmat4 moved_from_still(const Motion& motion) {
  const double sum =
      motion.degrees + glm::dot(motion.translate_mm + motion.axis + motion.about_mm, glm::dvec3(1.0));
  if (!std::isfinite(sum)) throw InvalidInput("a motion's numbers must be finite");
  glm::dmat4 translated = glm::translate(glm::dmat4(1.0), motion.translate_mm);
  if (motion.degrees == 0.0) return translated;
  if (!(glm::length(motion.axis) > 0.0)) throw InvalidInput("a rotation needs an axis that is not (0, 0, 0)");
  const glm::dmat4 to_point = glm::translate(glm::dmat4(1.0), motion.about_mm);
  const glm::dmat4 from_point = glm::translate(glm::dmat4(1.0), -motion.about_mm);
  const glm::dmat4 turned =
      glm::rotate(glm::dmat4(1.0), glm::radians(motion.degrees), glm::normalize(motion.axis));
  return translated * to_point * turned * from_point;
}

Expression parse_expression(std::string_view text, const Names& names) {
  return parse<Expression>(
      text, [&](std::string_view name) { return names.object(name); },
      [&](const Expression& still, std::string_view name) {
        if (!names.motion) throw InvalidInput("no motions are defined here: leave 'move(...)' out");
        return moved(still, names.motion(name));
      },
      [](char symbol, const Expression& a, const Expression& b) {
        switch (symbol) {
          case '|':
            return a | b;
          case '^':
            return a ^ b;
          case '&':
            return a & b;
          default:
            return a - b;
        }
      },
      [](const Expression& a) { return ~a; });
}

namespace {

// How strongly a kind of term binds, as in the grammar. An operand that binds less strongly than its place
// requires gets parentheses.
int strength(Expression::Kind kind) {
  switch (kind) {
    case Expression::Kind::Or:
      return 0;
    case Expression::Kind::Xor:
      return 1;
    case Expression::Kind::And:
      return 2;
    case Expression::Kind::Minus:
      return 3;
    default:
      return 4;
  }
}

constexpr std::array<std::string_view, 4> symbols{" | ", " ^ ", " & ", " - "};

// A part still to be printed: a text, or a term with the least strength at which it needs no parentheses.
struct Unprinted {
  const Expression::Term* term = nullptr;
  int at_least = 0;
  std::string text{};
};

}  // namespace

std::string print_expression(const Expression& expression, const Labels& labels) {
  for_each_term(expression, [](const MetTerm&) {});  // throws if the expression has too many leaves
  std::string printed;
  std::vector<Unprinted> rest{{&expression.term()}};
  while (!rest.empty()) {
    const Unprinted next = std::move(rest.back());
    rest.pop_back();
    if (next.term == nullptr) {
      printed += next.text;
      continue;
    }
    const Expression::Term& term = *next.term;
    const int own = strength(term.kind);
    if (own < next.at_least) {
      printed += "(";
      rest.push_back({nullptr, 0, ")"});
    }
    switch (term.kind) {
      case Expression::Kind::Leaf:
        printed += labels.object(*term.leaf);
        break;
      case Expression::Kind::Not:
        printed += "~";
        rest.push_back({term.left.get(), own});
        break;
      case Expression::Kind::Moved:
        printed += "move(";
        rest.push_back({nullptr, 0, ", " + labels.motion(term.moved_from_still) + ")"});
        rest.push_back({term.left.get(), 0});
        break;
      default:
        // Operators group from the left, so a right operand of the same strength needs parentheses.
        rest.push_back({term.right.get(), own + 1});
        rest.push_back({nullptr, 0, std::string(symbols[static_cast<std::size_t>(own)])});
        rest.push_back({term.left.get(), own});
    }
  }
  return printed;
}

std::vector<std::string> names_in(std::string_view text) {
  struct Nothing {};
  std::vector<std::string> names;
  std::unordered_set<std::string_view> known;
  parse<Nothing>(
      text,
      [&](std::string_view name) {
        if (known.insert(name).second) names.emplace_back(name);
        return Nothing{};
      },
      [](Nothing, std::string_view) { return Nothing{}; }, [](char, Nothing, Nothing) { return Nothing{}; },
      [](Nothing) { return Nothing{}; });
  return names;
}

}  // namespace octotomy::voxel
