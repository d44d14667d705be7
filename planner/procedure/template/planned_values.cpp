// SPDX-License-Identifier: AGPL-3.0-or-later
// Every formula of the procedure's file with its number in the plan is an equation. Values are read in this
// order:
//   1. from formulas with one value and nothing else, and from two formulas that differ by one value only,
//      such as a cut and the other side of its kerf; repeated with the values read so far
//   2. from formulas with landmarks, by bisection
// Each equation votes for a number, and the most frequent number is elected. The result is the number with
// the fewest decimals that rounds to the elected one.
#include "planner/procedure/template/planned_values.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "planner/operation/table/json.h"
#include "planner/procedure/template/formula.h"

namespace octotomy::planner {
namespace {

/// How far rounding may move a number of the plan from its formula's value, enlarged by a millionth for
/// rounding errors of the computation.
constexpr double rounding = 0.5 / roundings_per_unit * (1.0 + 1e-6);

struct Equation {
  std::string formula;
  Sum sum;  ///< of the formula; values that are known already are added to its constant
  double number = 0.0;
};

/// Adds an equation for each formula in a step of the file and the number in the same place of the plan's
/// step. Lists of different length are left out, because somebody has edited them.
void add_equations(const Json& own, const Json& planned, std::vector<Equation>& equations) {
  if (own.is_string() && own.get_ref<const std::string&>().starts_with('=')) {
    const std::string formula = own.get<std::string>().substr(1);
    if (!formula.starts_with('?') && planned.is_number())
      equations.push_back({formula, sum_of(formula), planned.get<double>()});
    else if (const Sum sum = sum_of(formula.substr(formula.find_first_not_of('?')));
             planned.is_boolean() && sum.terms.size() == 1 && sum.constant == 0.0)
      equations.push_back({"", sum, planned.get<bool>() ? sum.terms.begin()->second : 0.0});
  } else if (own.is_array() && planned.is_array() && own.size() == planned.size()) {
    for (std::size_t i = 0; i < own.size(); ++i) add_equations(own[i], planned[i], equations);
  } else if (own.is_object() && planned.is_object()) {
    for (const auto& [key, value] : own.items())
      if (planned.contains(key)) add_equations(value, planned[key], equations);
  }
}

/// A value that an equation yields, and how far rounding may have moved it.
struct Vote {
  double number = 0.0;
  double half_width = 0.0;
};

double with_fewest_decimals(const Vote& vote) {
  for (double scale = 1.0; scale <= 1e6; scale *= 10.0) {
    const double shorter = std::round(vote.number * scale) / scale;
    if (std::abs(shorter - vote.number) <= vote.half_width) return shorter + 0.0;
  }
  return vote.number;
}

std::optional<PlannedValue> elected(const std::vector<Vote>& votes) {
  const auto followers = [&](const Vote& vote) {
    return std::count_if(votes.begin(), votes.end(), [&](const Vote& other) {
      return std::abs(vote.number - other.number) <= vote.half_width + other.half_width;
    });
  };
  const Vote* most = nullptr;
  std::ptrdiff_t most_followers = 0;
  for (const Vote& vote : votes)
    if (const auto count = followers(vote); count > most_followers) {
      most = &vote;
      most_followers = count;
    }
  if (most == nullptr) return std::nullopt;
  return PlannedValue{with_fewest_decimals(*most), most_followers == std::ssize(votes)};
}

/// The values that equations yield without landmarks: those of equations whose only term is the value. If
/// there are none, those of pairs of equations that differ only in the value's factor.
std::vector<Vote> votes_without_landmarks(const std::vector<Equation>& equations, const std::string& name) {
  struct Side {
    double factor = 0.0, number = 0.0;
  };
  std::map<std::map<std::string, double>, std::vector<Side>> by_others;
  for (const Equation& equation : equations) {
    std::map<std::string, double> others = equation.sum.terms;
    const auto own = others.extract(name);
    by_others[others].push_back({own ? own.mapped() : 0.0, equation.number - equation.sum.constant});
  }
  std::vector<Vote> alone, paired;
  for (const auto& [others, sides] : by_others)
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (others.empty() && sides[i].factor != 0.0)
        alone.push_back({sides[i].number / sides[i].factor, rounding / std::abs(sides[i].factor)});
      for (std::size_t k = 0; k < i; ++k)
        if (const double factor = sides[i].factor - sides[k].factor; factor != 0.0)
          paired.push_back({(sides[i].number - sides[k].number) / factor, 2.0 * rounding / std::abs(factor)});
    }
  return alone.empty() ? paired : alone;
}

/// The value of a formula. None if it cannot be evaluated, for example because it uses an unknown name.
std::optional<double> value_if_any(const std::string& formula, const std::map<std::string, double>& names) {
  try {
    return value_of(formula, names);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

/// The value with which a formula yields the number in the plan. Searches the value's range and, on each side
/// of it, as far again. None if there is no such value.
std::optional<Vote> vote_by_bisection(const Equation& equation, const ProcedureValue& value,
                                      std::map<std::string, double> names) {
  const auto residual = [&](double at) {
    names[value.name] = at;
    const std::optional<double> found = value_if_any(equation.formula, names);
    return found ? std::optional(*found - equation.number) : std::nullopt;
  };
  constexpr int interval_count = 300;
  const double width = 3.0 * (value.most - value.least) / interval_count;
  double low = 2.0 * value.least - value.most;
  std::optional<double> at_low = residual(low);
  for (int i = 0; i < interval_count; ++i, low += width) {
    const std::optional<double> at_high = residual(low + width);
    const std::optional<double> from = std::exchange(at_low, at_high);
    if (!from || !at_high || *from == *at_high || *from * *at_high > 0.0) continue;
    const double half_width = rounding * width / std::abs(*at_high - *from);
    double a = low, b = low + width;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = (a + b) / 2.0;
      (residual(middle).value_or(0.0) * *from > 0.0 ? a : b) = middle;
    }
    return Vote{(a + b) / 2.0, half_width};
  }
  return std::nullopt;
}

/// Whether a sum's formula may use a name. In terms that are products or calls, the name is searched in their
/// text.
bool may_use(const Sum& sum, const std::string& name) {
  return std::any_of(sum.terms.begin(), sum.terms.end(),
                     [&](const auto& term) { return term.first.find(name) != std::string::npos; });
}

bool all_fit(const std::vector<Equation>& equations, const std::map<std::string, double>& names) {
  return std::all_of(equations.begin(), equations.end(), [&](const Equation& equation) {
    const std::optional<double> found = value_if_any(equation.formula, names);
    return !found || std::abs(*found - equation.number) <= rounding;
  });
}

}  // namespace

std::map<std::string, PlannedValue> planned_values(
    const Procedure& procedure, const Json& planned,
    const std::function<std::map<std::string, double>()>& coordinates) {
  std::vector<Equation> equations;
  for (const Json& own : procedure.steps)
    for (const Json& step : planned)
      if (step.at("id") == own.at("id") && step.at("do") == own.at("do")) add_equations(own, step, equations);

  std::map<std::string, PlannedValue> read;
  for (bool is_over = false; !is_over;) {
    is_over = true;
    for (const ProcedureValue& value : procedure.values) {
      if (read.contains(value.name)) continue;
      const std::optional<PlannedValue> found = elected(votes_without_landmarks(equations, value.name));
      if (!found) continue;
      read[value.name] = *found;
      is_over = false;
      for (Equation& equation : equations)
        if (const auto term = equation.sum.terms.extract(value.name))
          equation.sum.constant += term.mapped() * found->value;
    }
  }

  std::optional<std::map<std::string, double>> names;
  for (const ProcedureValue& value : procedure.values) {
    if (read.contains(value.name)) continue;
    std::vector<const Equation*> with;
    for (const Equation& equation : equations)
      if (may_use(equation.sum, value.name)) with.push_back(&equation);
    if (with.empty()) continue;
    if (!names) {
      names = coordinates();
      for (const auto& [name, known] : read) (*names)[name] = known.value;
    }
    std::vector<Vote> votes;
    for (const Equation* equation : with)
      if (const auto vote = vote_by_bisection(*equation, value, *names)) votes.push_back(*vote);
    const std::optional<PlannedValue> found = elected(votes);
    if (!found) continue;
    (*names)[value.name] = found->value;
    read[value.name] = {found->value, found->is_agreed && all_fit(equations, *names)};
  }
  return read;
}

}  // namespace octotomy::planner
