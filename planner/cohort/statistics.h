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
  std::uint32_t subject = 0;  ///< index of the subject in the cohort
  double value = 0.0;
  std::optional<double> half_width;
  std::optional<double> voxel, mesh;
  std::string verdict;
  bool is_doubtful = false;  ///< the audit of one of the subject's scans has a FAIL
};

/// One number over a cohort: a quantity of a measurement. All values have the same unit.
struct CohortColumn {
  std::string measurement, quantity, unit;
  std::vector<CohortValue> values;  ///< by subject

  std::string name() const { return measurement + "." + quantity; }
};

/// The numbers of a cohort, in the order in which the rows first name them. Memory: about 100 bytes per row.
class CohortTable {
 public:
  /// Adds the rows of one subject. Rows without a value are left out.
  void add(std::uint32_t subject, const std::vector<ResultRow>& rows);
  const std::vector<CohortColumn>& columns() const { return columns_; }

 private:
  std::vector<CohortColumn> columns_;
  std::map<std::string, std::size_t> at_;
};

/// Statistics of a set of numbers; all are zero for an empty set.
struct Spread {
  std::size_t count = 0;
  double mean = 0.0, sd = 0.0;  ///< mean, and standard deviation of a sample; sd is 0 for a single number
  double least = 0.0, median = 0.0, greatest = 0.0;
  double lower_fence = 0.0, upper_fence = 0.0;  ///< numbers beyond the fences are outliers
};
/// Computes the statistics of numbers. The fences lie 3.5 robust standard deviations from the median. A
/// robust standard deviation is 1.4826 times the median distance from the median (Iglewicz, Hoaglin 1993).
Spread spread_of(std::vector<double> numbers);

/// Agreement of two methods that measured the same number of a cohort (Bland, Altman 1986).
struct Agreement {
  std::vector<std::pair<double, double>> points;  ///< by subject: mean of both, and second minus first
  double bias = 0.0;                              ///< mean difference
  double low = 0.0, high = 0.0;                   ///< limits of agreement: bias -+ 1.96 sd
};
Agreement agreement_of(const std::vector<std::pair<double, double>>& answers);

}  // namespace octotomy::planner
