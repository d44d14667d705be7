// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planner/cohort/result_rows.h"

namespace octotomy::planner {

/// One subject's number.
struct CohortValue {
  std::uint32_t subject = 0;  ///< its index in the cohort
  double value = 0.0;
  std::optional<double> half_width;
  std::optional<double> voxel, mesh;
  std::string verdict;
  bool is_doubtful = false;  ///< the audit of a scan has a FAIL
};

/// One number over a cohort: a measurement's quantity in a unit.
struct CohortColumn {
  std::string measurement, quantity, unit;
  std::vector<CohortValue> values;  ///< by subject

  std::string name() const { return measurement + "." + quantity; }
};

/// The numbers of a cohort, in the order in which rows named them. Memory: about 100 bytes per row.
class CohortTable {
 public:
  /// Rows of one subject; those without a value are left out.
  void add(std::uint32_t subject, const std::vector<ResultRow>& rows);
  const std::vector<CohortColumn>& columns() const { return columns_; }

 private:
  std::vector<CohortColumn> columns_;
  std::map<std::string, std::size_t> at_;
};

/// Statistics of numbers. All zero if there are no numbers.
struct Spread {
  std::size_t count = 0;
  double mean = 0.0, sd = 0.0;  ///< sample mean and standard deviation; sd is 0 for one number
  double least = 0.0, median = 0.0, greatest = 0.0;
  double lower_fence = 0.0, upper_fence = 0.0;  ///< numbers beyond the fences are outliers
};
/// Outliers are more than 3.5 robust standard deviations from the median: 1.4826 times the median distance
/// from it (Iglewicz, Hoaglin 1993).
Spread spread_of(std::vector<double> numbers);

/// Agreement of two methods over a cohort (Bland, Altman 1986).
struct Agreement {
  std::vector<std::pair<double, double>> points;  ///< mean of the two methods, and second minus first
  double bias = 0.0;                              ///< mean difference
  double low = 0.0, high = 0.0;                   ///< limits of agreement: bias -+ 1.96 sd
};
Agreement agreement_of(const std::vector<std::pair<double, double>>& answers);

}  // namespace octotomy::planner
