// SPDX-License-Identifier: AGPL-3.0-or-later
// Recursive descent: sum = product {+- product}, product = factor {*/ factor}, factor = [-] (number | name |
// call | sum in parentheses).
#include "planner/procedure/template/formula.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <stdexcept>
#include <vector>

#include "planner/operation/table/nearest_name.h"

namespace octotomy::planner {
namespace {

/// Largest depth of nested parentheses; formulas are single lines written by people.
constexpr int deepest = 64;

class Parser {
 public:
  Parser(std::string_view text, const std::map<std::string, double>& names) : text_(text), names_(names) {}

  double whole() {
    const double value = sum();
    if (at_ != text_.size()) refuse("expected an operator or the end");
    if (!std::isfinite(value)) refuse("is no finite number");
    return value;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error("formula '" + std::string(text_) + "', at " + std::to_string(at_ + 1) + ": " +
                             what);
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

  double sum() {
    if (++depth_ > deepest) refuse("too many parentheses");
    double value = product();
    for (;;)
      if (take('+'))
        value += product();
      else if (take('-'))
        value -= product();
      else
        break;
    --depth_;
    return value;
  }
  double product() {
    double value = factor();
    for (;;) {
      if (take('*')) {
        value *= factor();
      } else if (take('/')) {
        const double by = factor();
        if (by == 0.0) refuse("divides by zero");
        value /= by;
      } else {
        return value;
      }
    }
  }
  double factor() {
    bool is_negative = false;
    while (take('-')) is_negative = !is_negative;
    const double value = operand();
    return is_negative ? -value : value;
  }
  double operand() {
    if (take('(')) {
      const double value = sum();
      need(')');
      return value;
    }
    skip_blanks();
    const auto symbol = at_ < text_.size() ? static_cast<unsigned char>(text_[at_]) : 0;
    if (std::isdigit(symbol)) return number();
    if (std::isalpha(symbol) || symbol == '_') return named();
    refuse("expected a number, a name or '('");
  }
  double number() {
    double value = 0.0;
    const char* begin = text_.data() + at_;
    const auto read = std::from_chars(begin, text_.data() + text_.size(), value);
    if (read.ec != std::errc()) refuse("is no number");
    at_ += static_cast<std::size_t>(read.ptr - begin);
    skip_blanks();
    return value;
  }
  double named() {
    const std::size_t begin = at_;
    const auto is_part = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '.'; };
    while (at_ < text_.size() && is_part(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::string name(text_.substr(begin, at_ - begin));
    if (take('(')) return call(name, begin);
    const auto found = names_.find(name);
    if (found != names_.end()) return found->second;
    at_ = begin;
    std::vector<std::string> known;
    for (const auto& [each, unused] : names_) known.push_back(each);
    refuse("nothing is called '" + name + "'" + suggestion(name, known));
  }
  double call(const std::string& name, std::size_t begin) {
    std::vector<double> of{sum()};
    while (take(',')) of.push_back(sum());
    need(')');
    if (of.size() > 1 && name == "min") return *std::min_element(of.begin(), of.end());
    if (of.size() > 1 && name == "max") return *std::max_element(of.begin(), of.end());
    if (of.size() == 2 && name == "hypot") return std::hypot(of[0], of[1]);
    if (of.size() == 1 && name == "abs") return std::abs(of[0]);
    if (of.size() == 1 && name == "asin_deg") {
      if (std::abs(of[0]) > 1.0) refuse("asin_deg needs a number from -1 to 1");
      return glm::degrees(std::asin(of[0]));
    }
    at_ = begin;
    refuse("there is no function '" + name + "' of " + std::to_string(of.size()) +
           ": use min, max, hypot (of two), abs or asin_deg (of one)");
  }

  std::string_view text_;
  const std::map<std::string, double>& names_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

double value_of(std::string_view formula, const std::map<std::string, double>& names) {
  return Parser(formula, names).whole();
}

}  // namespace octotomy::planner
