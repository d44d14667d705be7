// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/forecast.h"

#include <algorithm>

namespace octotomy::planner {
namespace {

Growth fitted(const std::vector<SubjectRecord>& done, double SubjectRecord::*quantity) {
  double count = 0.0, bytes = 0.0, amount = 0.0, squares = 0.0, products = 0.0, most = 0.0;
  for (const SubjectRecord& record : done) {
    const auto x = static_cast<double>(record.scan_bytes);
    const double y = record.*quantity;
    count += 1.0;
    bytes += x;
    amount += y;
    squares += x * x;
    products += x * y;
    most = std::max(most, y);
  }
  const double spread = count * squares - bytes * bytes;
  if (!(spread > 1e-9 * count * squares)) return {most, 0.0};
  const double per_byte = std::max(0.0, (count * products - bytes * amount) / spread);
  return {std::max(0.0, (amount - per_byte * bytes) / count), per_byte};
}

}  // namespace

Forecast forecast_of(const std::vector<SubjectRecord>& done) {
  if (done.empty()) return {};
  return {done.size(), fitted(done, &SubjectRecord::seconds), fitted(done, &SubjectRecord::peak_mb)};
}

}  // namespace octotomy::planner
