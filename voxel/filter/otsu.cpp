// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/otsu.h"

#include <stdexcept>
#include <string>

#include "voxel/space/error.h"

namespace octotomy::voxel {

std::vector<double> otsu_thresholds(const Histogram& histogram, int classes) {
  const std::size_t bins = histogram.counts.size();
  if (classes < 2 || classes > 8 || static_cast<std::size_t>(classes) > bins)
    throw InvalidInput("Otsu's thresholds divide samples into 2 to 8 classes, not " +
                       std::to_string(classes));
  // For each bin two sums over the bins before it: the number of samples, and the samples' numbers times
  // their bins' indices.
  std::vector<double> count(bins + 1, 0.0), total(bins + 1, 0.0);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const auto here = static_cast<double>(histogram.counts[bin]);
    count[bin + 1] = count[bin] + here;
    total[bin + 1] = total[bin] + here * static_cast<double>(bin);
  }
  // The variance within classes is least if the variance between them is largest. The latter grows with the
  // sum of total^2 / count over the classes.
  const auto between = [&](std::size_t from, std::size_t to) {
    const double n = count[to] - count[from];
    const double sum = total[to] - total[from];
    return n > 0.0 ? sum * sum / n : 0.0;
  };
  // best[end]: the largest sum for the bins before `end`, divided into the number of classes reached;
  // first[c][end]: the first bin of the last class in that division.
  std::vector<double> best(bins + 1, 0.0);
  for (std::size_t end = 1; end <= bins; ++end) best[end] = between(0, end);
  std::vector<std::vector<std::size_t>> first;
  for (std::size_t parted = 2; parted <= static_cast<std::size_t>(classes); ++parted) {
    std::vector<double> better(bins + 1, -1.0);
    std::vector<std::size_t> start(bins + 1, 0);
    for (std::size_t end = parted; end <= bins; ++end)
      for (std::size_t from = parted - 1; from < end; ++from)
        if (const double sum = best[from] + between(from, end); sum > better[end])
          better[end] = sum, start[end] = from;
    best.swap(better);
    first.push_back(std::move(start));
  }
  std::vector<double> thresholds(static_cast<std::size_t>(classes) - 1);
  std::size_t end = bins;
  for (std::size_t i = thresholds.size(); i-- > 0;) {
    end = first[i][end];
    thresholds[i] = histogram.lower_edge(end);
  }
  return thresholds;
}

}  // namespace octotomy::voxel
