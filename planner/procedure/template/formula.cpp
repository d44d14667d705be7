// SPDX-License-Identifier: AGPL-3.0-or-later
// Recursive descent: sum = product {+- product}, product = factor {*/ factor}, factor = [-] (number | name |
// call | sum in parentheses). Values are sums of terms; with all names known they are constants.
#include "planner/procedure/template/formula.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "planner/operation/table/nearest_name.h"

namespace octotomy::planner {
namespace {

/// Largest depth of nested parentheses in a formula, which a person writes on one line.
constexpr int deepest = 64;

using Function = double (*)(const std::vector<double>& of);
/// The function with this name for this number of arguments; none if there is no such function.
Function function_of(const std::string& name, std::size_t argument_count) {
  using Of = const std::vector<double>&;
  if (argument_count > 1 && name == "min")
    return [](Of of) { return *std::min_element(of.begin(), of.end()); };
  if (argument_count > 1 && name == "max")
    return [](Of of) { return *std::max_element(of.begin(), of.end()); };
  if (argument_count == 2 && name == "hypot") return [](Of of) { return std::hypot(of[0], of[1]); };
  if (argument_count == 1 && name == "abs") return [](Of of) { return std::abs(of[0]); };
  if (argument_count == 1 && name == "asin_deg") return [](Of of) { return glm::degrees(std::asin(of[0])); };
  return nullptr;
}

Sum added(Sum a, const Sum& b, double factor) {
  a.constant += factor * b.constant;
  for (const auto& [name, by] : b.terms) {
    double& together = a.terms[name];
    together += factor * by;
    if (together == 0.0) a.terms.erase(name);
  }
  return a;
}

std::string text_of(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}
std::string text_of(const Sum& sum) {
  std::string text = text_of(sum.constant);
  for (const auto& [name, by] : sum.terms) text += " + " + text_of(by) + " * " + name;
  return text;
}
Sum term(const std::string& name) {
  return {{{name, 1.0}}, 0.0};
}

Sum multiplied(const Sum& a, const Sum& b) {
  if (!a.terms.empty() && !b.terms.empty()) return term("(" + text_of(a) + ") * (" + text_of(b) + ")");
  const Sum& whole = a.terms.empty() ? b : a;
  const double by = a.terms.empty() ? a.constant : b.constant;
  Sum made{{}, whole.constant * by};
  for (const auto& [name, factor] : whole.terms)
    if (factor * by != 0.0) made.terms[name] = factor * by;
  return made;
}
/// The quotient of two sums. If `by` has terms, the quotient is a single term; otherwise each term is
/// divided. `by` must not be zero.
Sum divided(const Sum& a, const Sum& by) {
  if (!by.terms.empty()) return term("(" + text_of(a) + ") / (" + text_of(by) + ")");
  Sum made{{}, a.constant / by.constant};
  for (const auto& [name, factor] : a.terms) made.terms[name] = factor / by.constant;
  return made;
}

class Parser {
 public:
  /// `names` are the values of names. If it is null, each name becomes a term of the sum.
  Parser(std::string_view text, const std::map<std::string, double>* names) : text_(text), names_(names) {}

  Sum whole() {
    Sum value = sum();
    if (at_ != text_.size()) refuse("expected an operator or the end");
    if (!std::isfinite(value.constant)) refuse("the result is not a finite number");
    return value;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error("formula '" + std::string(text_) + "', character " + std::to_string(at_ + 1) +
                             ": " + what);
  }
  void skip_blanks() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(char symbol) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != symbol) return false;
    ++at_;
    skip_blanks();
    return true;
  }
  void need(char symbol) {
    if (!take(symbol)) refuse(std::string("expected '") + symbol + "'");
  }

  Sum sum() {
    if (++depth_ > deepest) refuse("too many parentheses");
    Sum value = product();
    for (;;)
      if (take('+'))
        value = added(std::move(value), product(), 1.0);
      else if (take('-'))
        value = added(std::move(value), product(), -1.0);
      else
        break;
    --depth_;
    return value;
  }
  Sum product() {
    Sum value = factor();
    for (;;) {
      if (take('*')) {
        value = multiplied(value, factor());
      } else if (take('/')) {
        const Sum by = factor();
        if (by.terms.empty() && by.constant == 0.0) refuse("a division by zero");
        value = divided(value, by);
      } else {
        return value;
      }
    }
  }
  Sum factor() {
    bool is_negative = false;
    while (take('-')) is_negative = !is_negative;
    Sum value = operand();
    return is_negative ? multiplied(value, {{}, -1.0}) : value;
  }
  Sum operand() {
    if (take('(')) {
      Sum value = sum();
      need(')');
      return value;
    }
    skip_blanks();
    const auto symbol = at_ < text_.size() ? static_cast<unsigned char>(text_[at_]) : 0;
    if (std::isdigit(symbol)) return number();
    if (std::isalpha(symbol) || symbol == '_') return named();
    refuse("expected a number, a name or '('");
  }
  Sum number() {
    double value = 0.0;
    const char* begin = text_.data() + at_;
    const auto read = std::from_chars(begin, text_.data() + text_.size(), value);
    if (read.ec != std::errc()) refuse("expected a number");
    at_ += static_cast<std::size_t>(read.ptr - begin);
    skip_blanks();
    return {{}, value};
  }
  Sum named() {
    const std::size_t begin = at_;
    const auto is_part = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '.'; };
    while (at_ < text_.size() && is_part(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::string name(text_.substr(begin, at_ - begin));
    if (take('(')) return call(name, begin);
    if (names_ == nullptr) return term(name);
    const auto found = names_->find(name);
    if (found != names_->end()) return {{}, found->second};
    at_ = begin;
    std::vector<std::string> known;
    for (const auto& [each, unused] : *names_) known.push_back(each);
    refuse("there is no value or landmark '" + name + "'" + suggestion(name, known));
  }
  Sum call(const std::string& name, std::size_t begin) {
    std::vector<Sum> arguments{sum()};
    while (take(',')) arguments.push_back(sum());
    need(')');
    const Function function = function_of(name, arguments.size());
    if (function == nullptr) {
      at_ = begin;
      refuse("there is no function '" + name + "' of " + std::to_string(arguments.size()) +
             ": use min, max, hypot (of two), abs or asin_deg (of one)");
    }
    std::vector<double> constants;
    std::string text = name + "(";
    for (const Sum& argument : arguments) {
      text += text_of(argument) + ", ";
      if (argument.terms.empty()) constants.push_back(argument.constant);
    }
    if (constants.size() < arguments.size()) return term(text + ")");
    const double value = function(constants);
    if (name == "asin_deg" && std::isnan(value)) refuse("asin_deg needs a number from -1 to 1");
    return {{}, value};
  }

  std::string_view text_;
  const std::map<std::string, double>* names_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

double value_of(std::string_view formula, const std::map<std::string, double>& names) {
  return Parser(formula, &names).whole().constant;
}

Sum sum_of(std::string_view formula) {
  return Parser(formula, nullptr).whole();
}

}  // namespace octotomy::planner
