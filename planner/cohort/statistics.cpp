// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/statistics.h"

#include <algorithm>
#include <cmath>

namespace octotomy::planner {
namespace {

double median_of(std::vector<double>& numbers) {
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  if (numbers.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(numbers.begin(), middle));
}

std::pair<double, double> mean_and_sd(const std::vector<double>& numbers) {
  double sum = 0.0, squares = 0.0;
  for (const double number : numbers) sum += number;
  const double mean = sum / static_cast<double>(numbers.size());
  for (const double number : numbers) squares += (number - mean) * (number - mean);
  return {mean, numbers.size() < 2 ? 0.0 : std::sqrt(squares / static_cast<double>(numbers.size() - 1))};
}

}  // namespace

void CohortTable::add(std::uint32_t subject, const std::vector<ResultRow>& rows) {
  for (const ResultRow& row : rows) {
    if (!row.value) continue;
    const auto [at, is_new] =
        at_.emplace(row.measurement + "." + row.quantity + " " + row.unit, columns_.size());
    if (is_new) columns_.push_back({row.measurement, row.quantity, row.unit, {}});
    columns_[at->second].values.push_back(
        {subject, *row.value, row.half_width, row.voxel, row.mesh, row.verdict, row.scan_audit == "FAIL"});
  }
}

Spread spread_of(std::vector<double> numbers) {
  Spread spread;
  spread.count = numbers.size();
  if (numbers.empty()) return spread;
  std::tie(spread.mean, spread.sd) = mean_and_sd(numbers);
  const auto [least, greatest] = std::minmax_element(numbers.begin(), numbers.end());
  spread.least = *least;
  spread.greatest = *greatest;
  spread.median = median_of(numbers);
  for (double& number : numbers) number = std::abs(number - spread.median);
  const double reach = 3.5 * 1.4826 * median_of(numbers);
  spread.lower_fence = spread.median - reach;
  spread.upper_fence = spread.median + reach;
  return spread;
}

Agreement agreement_of(const std::vector<std::pair<double, double>>& answers) {
  Agreement agreement;
  std::vector<double> differences;
  for (const auto& [first, second] : answers) {
    agreement.points.emplace_back(0.5 * (first + second), second - first);
    differences.push_back(second - first);
  }
  if (answers.empty()) return agreement;
  const auto [bias, sd] = mean_and_sd(differences);
  agreement.bias = bias;
  agreement.low = bias - 1.96 * sd;
  agreement.high = bias + 1.96 * sd;
  return agreement;
}

}  // namespace octotomy::planner
