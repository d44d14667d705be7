// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "tbb/parallel_for.h"

namespace tbb {

template <typename Range, typename Value, typename Body, typename Join>
Value parallel_reduce(const Range& range, const Value& identity, const Body& body, const Join& join) {
  const auto parts = plain::parts(range);
  std::vector<Value> values(parts.size(), identity);
  plain::loop(parts.size(), [&](std::size_t i) { values[i] = body(parts[i], identity); });
  Value sum = identity;
  for (const Value& value : values) sum = join(sum, value);
  return sum;
}

}  // namespace tbb
