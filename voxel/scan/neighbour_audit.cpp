// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Compares slices with their neighbours:
//   1 reduce every slice to a small image of means
//   2 correlate neighbours unchanged, mirrored along rows or columns, and turned by 180 degrees
//   3 report single slices that are mirrored or agree with no neighbour, then blocks of mirrored slices
// Decides by ratios of disagreement (1 - correlation), not by correlation: thick slices agree less than thin
// ones, but this affects correct and wrong slices of a stack alike.
#include "voxel/scan/neighbour_audit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tbb/parallel_for.h>
#include <type_traits>

#include "voxel/space/printed.h"
#include "voxel/space/vector_clones.h"

namespace octotomy::voxel {

namespace {

constexpr int largest_side = 64;
/// Images with fewer pixels along a side have too little detail to be compared.
constexpr int smallest_side = 8;

/// Flips are sets of bits: 1 mirrors along rows, 2 mirrors along columns. The exclusive-or of two flips is
/// their combination.
constexpr int flip_count = 4;
constexpr std::array<const char*, flip_count> flip_words = {
    "", "mirrored along its rows", "mirrored along its columns", "turned by 180 degrees"};

/// An image after subtraction of its mean, and the Euclidean norm of its values.
struct Thumbnail {
  std::vector<float> values;
  int width = 0, height = 0;
  double length = 0.0;
};

/// Adds a row's pixels, at least `floor` each, to the sums of their columns. A block has fewer than 2^15
/// rows, so that 32 bits hold its sums.
OCTOTOMY_VECTOR_CLONES void add_row(const std::int16_t* __restrict row, std::size_t count, std::int16_t floor,
                                    std::int32_t* __restrict sums) {
  for (std::size_t i = 0; i < count; ++i) sums[i] += std::max(row[i], floor);
}
void add_row(const float* row, std::size_t count, float floor, double* sums) {
  for (std::size_t i = 0; i < count; ++i) sums[i] += static_cast<double>(std::max(row[i], floor));
}

template <typename Sample>
Thumbnail thumbnail_of(const Sample* pixels, const glm::ivec2& size_px, double floor) {
  const int block = (std::max(size_px.x, size_px.y) + largest_side - 1) / largest_side;
  Thumbnail small;
  small.width = size_px.x / block;
  small.height = size_px.y / block;
  // Pixels that do not fill a whole block are left out at both sides equally, so that a flipped image has the
  // same blocks.
  const glm::ivec2 start = (size_px - block * glm::ivec2(small.width, small.height)) / 2;
  double mean = 0.0;
  const auto width = static_cast<std::size_t>(size_px.x);
  using Sum = std::conditional_t<std::is_same_v<Sample, std::int16_t>, std::int32_t, double>;
  std::vector<Sum> columns(width);
  for (int y = 0; y < small.height; ++y) {
    std::fill(columns.begin(), columns.end(), Sum{0});
    for (int j = 0; j < block; ++j)
      add_row(pixels + static_cast<std::size_t>(start.y + y * block + j) * width, width,
              static_cast<Sample>(floor), columns.data());
    for (int x = 0; x < small.width; ++x) {
      const auto first = columns.begin() + start.x + x * block;
      const double sum = std::accumulate(first, first + block, 0.0);
      small.values.push_back(static_cast<float>(sum / (block * block)));
      mean += sum / (block * block);
    }
  }
  mean /= static_cast<double>(small.values.size());
  double square = 0.0;
  for (float& value : small.values) {
    value = static_cast<float>(value - mean);
    square += static_cast<double>(value) * static_cast<double>(value);
  }
  small.length = std::sqrt(square);
  return small;
}

/// The correlation of image `a` with the flipped image `b`; 0 if one of the images is blank.
double correlation(const Thumbnail& a, const Thumbnail& b, int flip) {
  if (!(a.length > 0.0 && b.length > 0.0)) return 0.0;
  double product = 0.0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const int column = (flip & 1) != 0 ? a.width - 1 - x : x;
      const int row = (flip & 2) != 0 ? a.height - 1 - y : y;
      product += static_cast<double>(a.values[static_cast<std::size_t>(y * a.width + x)]) *
                 static_cast<double>(b.values[static_cast<std::size_t>(row * a.width + column)]);
    }
  return product / (a.length * b.length);
}

/// Accepts a flip if the disagreement without the flip is more than a third larger than with it, and if the
/// flipped images agree in shape, not only in noise. Correct scans of heads, necks and phantoms, in CT and
/// MR, reach a ratio of 1.01 at a correlation of 0.7.
bool is_better(double as_is, double flipped) {
  return flipped > 0.7 && 1.0 - as_is > 1.35 * (1.0 - flipped);
}

class NeighbourAudit {
 public:
  NeighbourAudit(std::vector<Thumbnail> slices, const std::vector<std::string>& names,
                 std::vector<Finding>& audit)
      : slices_(std::move(slices)), names_(names), audit_(audit), flips_(slices_.size(), 0) {}

  void run() {
    const std::size_t count = slices_.size();
    pairs_.resize(count - 1);
    across_.resize(count - 2);
    tbb::parallel_for(std::size_t{0}, count - 1, [&](std::size_t i) {
      for (int flip = 0; flip < flip_count; ++flip)
        pairs_[i][static_cast<std::size_t>(flip)] = correlation(slices_[i], slices_[i + 1], flip);
      if (i + 2 < count) across_[i] = correlation(slices_[i], slices_[i + 2], 0);
    });
    std::vector<double> disagreements;
    for (const auto& pair : pairs_) disagreements.push_back(1.0 - pair[0]);
    std::nth_element(disagreements.begin(),
                     disagreements.begin() + static_cast<std::ptrdiff_t>(count / 2 - 1), disagreements.end());
    usual_disagreement_ = disagreements[count / 2 - 1];
    find_single();
    find_blocks();
    report();
  }

 private:
  using Pair = std::array<double, flip_count>;

  /// The pairs of neighbouring slices to which a slice belongs.
  std::vector<std::size_t> pairs_of(std::size_t slice) const {
    std::vector<std::size_t> pairs;
    if (slice > 0) pairs.push_back(slice - 1);
    if (slice < pairs_.size()) pairs.push_back(slice);
    return pairs;
  }

  /// A reference for a slice's agreement with its neighbours: the agreement of the two slices beside it. For
  /// a slice at an end it is the agreement of the next pair.
  double reference_of(std::size_t slice) const {
    if (slice == 0) return pairs_[1][0];
    if (slice == pairs_.size()) return pairs_[pairs_.size() - 2][0];
    return across_[slice - 1];
  }

  /// The flip of a slice that improves the agreement of all its pairs; 0: none does.
  int flip_of(std::size_t slice) const {
    int best = 0;
    double most = 0.0;
    for (int flip = 1; flip < flip_count; ++flip) {
      double as_is = 0.0, flipped = 0.0;
      const std::vector<std::size_t> pairs = pairs_of(slice);
      for (const std::size_t pair : pairs) {
        as_is += pairs_[pair][0] / static_cast<double>(pairs.size());
        flipped += pairs_[pair][static_cast<std::size_t>(flip)] / static_cast<double>(pairs.size());
      }
      // The lower bound is needed for noiseless slices of one shape: they differ only by rounding errors,
      // whose ratio is meaningless.
      const bool is_unusual = 1.0 - as_is > std::max(1e-3, 1.2 * usual_disagreement_);
      if (is_better(as_is, flipped) && is_unusual && flipped > most) {
        most = flipped;
        best = flip;
      }
    }
    return best;
  }

  /// Whether a slice agrees with none of its neighbours, although it has about their contrast and they agree
  /// with each other.
  bool is_unlike(std::size_t slice) const {
    double most = -1.0, contrast = 0.0;
    for (const std::size_t pair : pairs_of(slice)) {
      most = std::max(most, pairs_[pair][0]);
      contrast = std::max(contrast, slices_[pair == slice ? slice + 1 : slice - 1].length);
    }
    const bool is_end = slice == 0 || slice == pairs_.size();
    const double reference = reference_of(slice);
    // A slice at an end may lie beyond the head. It then shows only air, with little contrast.
    return most < (is_end ? 0.3 : 0.5) && 1.0 - most > 4.0 * (1.0 - reference) &&
           slices_[slice].length > (is_end ? 0.5 : 0.25) * contrast;
  }

  void find_single() {
    // Starts with the worst slice, because a wrong slice also lowers the agreement of its neighbours.
    std::vector<std::size_t> order(slices_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto agreement = [&](std::size_t slice) {
      double sum = 0.0;
      const std::vector<std::size_t> pairs = pairs_of(slice);
      for (const std::size_t pair : pairs) sum += pairs_[pair][0];
      return sum / static_cast<double>(pairs.size());
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return agreement(a) < agreement(b); });
    std::vector<char> is_judged(slices_.size(), 0);
    for (const std::size_t slice : order) {
      const bool is_beside = (slice > 0 && is_judged[slice - 1] != 0) ||
                             (slice + 1 < slices_.size() && is_judged[slice + 1] != 0);
      if (is_beside) continue;
      const int flip = flip_of(slice);
      if (flip == 0 && !is_unlike(slice)) continue;
      is_judged[slice] = 1;
      if (flip != 0)
        flips_[slice] = flip;
      else
        unlike_.push_back(names_[slice]);
    }
    is_judged_ = std::move(is_judged);
    std::sort(unlike_.begin(), unlike_.end());
  }

  /// If neither of two neighbours was reported as a single slice, a flip between them starts or ends a block.
  void find_blocks() {
    std::vector<int> states(slices_.size(), 0);
    std::array<std::size_t, flip_count> sizes{};
    std::size_t turns = 0;
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (i > 0)
        states[i] = states[i - 1] ^ (is_judged_[i] != 0 || is_judged_[i - 1] != 0 ? 0 : turn_at(i - 1));
      turns += i > 0 && states[i] != states[i - 1];
      ++sizes[static_cast<std::size_t>(states[i])];
    }
    if (turns == 0 || turns * 4 > slices_.size()) return;
    const auto commonest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    for (std::size_t i = 0; i < states.size(); ++i)
      if (is_judged_[i] == 0) flips_[i] = states[i] ^ commonest;
  }

  int turn_at(std::size_t pair) const {
    int best = 0;
    for (int flip = 1; flip < flip_count; ++flip) {
      const double flipped = pairs_[pair][static_cast<std::size_t>(flip)];
      if (is_better(pairs_[pair][0], flipped) &&
          1.0 - pairs_[pair][0] > std::max(1e-3, 2.0 * usual_disagreement_) &&
          flipped > pairs_[pair][static_cast<std::size_t>(best)])
        best = flip;
    }
    return best;
  }

  void report() {
    std::vector<std::string> mirrored;
    std::array<std::size_t, flip_count> counts{};
    for (std::size_t i = 0; i < flips_.size(); ++i) {
      if (flips_[i] == 0) continue;
      mirrored.push_back(names_[i]);
      ++counts[static_cast<std::size_t>(flips_[i])];
    }
    if (!mirrored.empty()) {
      std::string how;
      for (int flip = 1; flip < flip_count; ++flip)
        if (const std::size_t count = counts[static_cast<std::size_t>(flip)]; count > 0)
          how += (how.empty() ? "" : ", ") + std::to_string(count) + " " +
                 flip_words[static_cast<std::size_t>(flip)];
      audit_.push_back({"mirrored_slices", Verdict::Fail,
                        slices(mirrored.size()) + " would agree better with the neighbours if (" + how +
                            "): left and right may be exchanged there; export the series again, or leave "
                            "them out by --slices: " +
                            listed(mirrored),
                        mirrored});
    }
    if (!unlike_.empty())
      audit_.push_back({"unlike_slices", Verdict::Fail,
                        slices(unlike_.size()) +
                            " unlike the neighbours, which are like each other: noise, or "
                            "slices of another scan: " +
                            listed(unlike_),
                        unlike_});
  }

  std::vector<Thumbnail> slices_;
  const std::vector<std::string>& names_;
  std::vector<Finding>& audit_;
  std::vector<int> flips_;
  std::vector<char> is_judged_;
  std::vector<std::string> unlike_;
  /// Entry i: correlations of slices i and i + 1, one for each flip of the latter.
  std::vector<Pair> pairs_;
  std::vector<double> across_;  ///< entry i: correlation of slices i and i + 2
  double usual_disagreement_ = 0.0;
};

/// The mean absolute difference of samples `stride` apart in memory, over at most sixteen slices.
template <typename Samples>
double difference_at(const Samples& samples, std::size_t area, std::size_t stride, double floor) {
  const std::size_t count = samples.size() / area, step = std::max<std::size_t>(1, count / 16);
  double sum = 0.0, pairs = 0.0;
  for (std::size_t k = 0; k < count; k += step)
    for (std::size_t i = 0; i + stride < area; ++i) {
      const double a = std::max(static_cast<double>(samples[k * area + i]), floor);
      const double b = std::max(static_cast<double>(samples[k * area + i + stride]), floor);
      sum += std::abs(a - b);
      pairs += 1.0;
    }
  return pairs > 0.0 ? sum / pairs : 0.0;
}

template <typename Samples>
void audit_rows(const Samples& samples, const glm::ivec2& size_px, double floor,
                std::vector<Finding>& audit) {
  if (size_px.x == size_px.y || std::min(size_px.x, size_px.y) < smallest_side) return;
  const std::size_t area = static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
  const double declared = difference_at(samples, area, static_cast<std::size_t>(size_px.x), floor);
  const double exchanged = difference_at(samples, area, static_cast<std::size_t>(size_px.y), floor);
  const double along_row = difference_at(samples, area, 1, floor);
  // If the row length is correct, neighbouring rows differ about as much as neighbouring columns.
  if (declared > 2.0 * exchanged && declared > 2.0 * along_row)
    audit.push_back(
        {"rows_columns", Verdict::Fail,
         print("neighbouring rows differ by %.3g on average, and by %.3g if Rows (%d) and Columns "
               "(%d) are exchanged: the header seems to exchange them; correct it",
               declared, exchanged, size_px.y, size_px.x)});
}

}  // namespace

void audit_neighbours(const decltype(Scene::samples)& samples, const glm::ivec2& size_px,
                      const std::vector<std::string>& names, double floor, std::vector<Finding>& audit) {
  std::visit([&](const auto& held) { audit_rows(held, size_px, floor, audit); }, samples);
  if (names.size() < 4 || std::min(size_px.x, size_px.y) < smallest_side) return;
  const std::size_t area = static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
  std::vector<Thumbnail> slices(names.size());
  std::visit(
      [&](const auto& held) {
        tbb::parallel_for(std::size_t{0}, names.size(), [&](std::size_t k) {
          slices[k] = thumbnail_of(held.data() + k * area, size_px, floor);
        });
      },
      samples);
  NeighbourAudit(std::move(slices), names, audit).run();
}

}  // namespace octotomy::voxel
