// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A threshold's surface loses what is thinner than the blur (Prevrhal, Engelke and Kalender 1999, Accuracy
// limits for the determination of cortical width and density; Dougherty and Newman 1999; Treece et al. 2010,
// High resolution cortical bone thickness measurement from clinical CT data). Treece fits each wall's profile
// with the density held; here the same model, one density and a blur, is summed over the whole solid.
//
// u      a sample less the background, as a share of the contrast.
// volume The sum of u near the solid. Blur, voxel means and the spacing of slices keep it: its error is
//        noise, that of the background, and what is too faint to be found.
// area   1 The sum of u - u^2, over the blur's deviation s, is the area over sqrt(pi) on a surface that is
//          flat over the blur. Of thinner solids the sum of u^2 over that of u is the mean of the solid's
//          covariogram (Porod 1951; Debye, Anderson and Brumberger 1957) under a Gaussian of variance 2 s^2.
//          Sheets, rods and balls have closed or tabulated covariograms. Each is fitted, with its s, to the
//          sums at four added blurs; the fits are weighed by how well they do.
//        2 The half level's area after two added blurs, continued to no blur: what curvature and edges lose
//          goes nearly as the variance.
//        The value is between both; how far they differ and how far the fits differ is doubt.
//
// passes 1 Levels of the surroundings and of the core. 2 Samples of a third density below the surroundings,
// as of air about tissue: where they keep away from the solid they are taken for surroundings; where they
// meet it, and where there is a density between both, the scan is not of two. 3 Samples near the solid: those
// that rise above noise after a blur of one sample, and three samples about them. 4 Sums. 5 Fits.
#include "verify/two_phase.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <tbb/parallel_for.h>
#include <vector>

namespace octotomy::verify {
namespace {

using Values = std::vector<float>;
using Mask = std::vector<std::uint8_t>;
constexpr std::array<double, 4> added_blur{0.0, 0.6, 1.0, 1.6};
/// Two gigabytes of copies.
constexpr std::size_t most_samples = std::size_t{1} << 27;

struct Grid {
  glm::ivec3 dims{0};
  glm::dvec3 spacing_mm{1.0};
  std::size_t size() const {
    return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
           static_cast<std::size_t>(dims.z);
  }
  std::size_t stride(int axis) const {
    return axis == 0   ? 1
           : axis == 1 ? static_cast<std::size_t>(dims.x)
                       : static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y);
  }
  std::size_t at(int x, int y, int z) const {
    return static_cast<std::size_t>(x) + stride(1) * static_cast<std::size_t>(y) +
           stride(2) * static_cast<std::size_t>(z);
  }
};

/// Sums in a fixed order whatever the threads: by planes of z, then over the planes.
template <typename Sum, typename PerPlane>
Sum by_planes(const Grid& grid, const PerPlane& per_plane) {
  std::vector<Sum> planes(static_cast<std::size_t>(grid.dims.z));
  tbb::parallel_for(0, grid.dims.z, [&](int z) { per_plane(z, planes[static_cast<std::size_t>(z)]); });
  Sum whole{};
  for (const Sum& plane : planes) whole += plane;
  return whole;
}

/// Rows along an axis: runs `along(first, stride, length)` for each, in parallel.
template <typename Along>
void each_row(const Grid& grid, int axis, const Along& along) {
  const int outer = axis == 2 ? grid.dims.y : grid.dims.z, inner = axis == 0 ? grid.dims.y : grid.dims.x;
  tbb::parallel_for(0, outer, [&](int i) {
    for (int j = 0; j < inner; ++j) {
      const std::size_t first = axis == 0   ? grid.at(0, j, i)
                                : axis == 1 ? grid.at(j, 0, i)
                                            : grid.at(j, i, 0);
      along(first, grid.stride(axis), static_cast<std::size_t>(grid.dims[axis]));
    }
  });
}

/// A Gaussian of so many samples along each axis; border samples go on outwards.
Values blurred(const Grid& grid, Values values, double deviation) {
  const auto reach = static_cast<std::size_t>(std::ceil(3.5 * deviation));
  std::vector<float> weights(2 * reach + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double off = static_cast<double>(i) - static_cast<double>(reach);
    sum += weights[i] = static_cast<float>(std::exp(-0.5 * off * off / (deviation * deviation)));
  }
  for (float& weight : weights) weight = static_cast<float>(weight / sum);
  for (int axis = 0; axis < 3; ++axis)
    each_row(grid, axis, [&](std::size_t first, std::size_t stride, std::size_t length) {
      thread_local std::vector<float> line;
      line.resize(length + 2 * reach);
      for (std::size_t i = 0; i < length; ++i) line[i + reach] = values[first + i * stride];
      std::fill_n(line.begin(), reach, line[reach]);
      std::fill_n(line.end() - static_cast<std::ptrdiff_t>(reach), reach, line[length + reach - 1]);
      for (std::size_t i = 0; i < length; ++i) {
        float value = 0.0F;
        for (std::size_t k = 0; k < weights.size(); ++k) value += weights[k] * line[i + k];
        values[first + i * stride] = value;
      }
    });
  return values;
}

/// Sets all within so many samples along each axis of one that is set.
void grow(const Grid& grid, Mask& mask, std::size_t reach) {
  for (int axis = 0; axis < 3; ++axis)
    each_row(grid, axis, [&](std::size_t first, std::size_t stride, std::size_t length) {
      thread_local Mask line;
      line.assign(length, 0);
      std::size_t until = 0;  // one beyond what the last set sample reaches
      for (std::size_t i = 0; i < length; ++i)
        if (mask[first + i * stride] != 0) {
          for (std::size_t k = std::max(until, i > reach ? i - reach : 0);
               k < std::min(length, i + reach + 1); ++k)
            line[k] = 1;
          until = i + reach + 1;
        }
      for (std::size_t i = 0; i < length; ++i) mask[first + i * stride] = line[i];
    });
}

/// The lowest, or highest, of the samples within so many along each axis.
Values extremes(const Grid& grid, Values values, std::size_t reach, bool highest) {
  for (int axis = 0; axis < 3; ++axis)
    each_row(grid, axis, [&](std::size_t first, std::size_t stride, std::size_t length) {
      thread_local std::vector<float> line;
      line.resize(length);
      for (std::size_t i = 0; i < length; ++i) line[i] = values[first + i * stride];
      for (std::size_t i = 0; i < length; ++i) {
        const auto from = line.begin() + static_cast<std::ptrdiff_t>(i - std::min(i, reach));
        const auto end = line.begin() + static_cast<std::ptrdiff_t>(std::min(length, i + reach + 1));
        values[first + i * stride] = highest ? *std::max_element(from, end) : *std::min_element(from, end);
      }
    });
  return values;
}

double median_of(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// A density and its noise, in sample units.
struct Level {
  double value = 0.0, noise = 0.0;
};

/// The density that most of the values lie close to: the middle of the narrowest quarter of them, and the
/// spread of those. Precondition: eight values or more. Sorts them.
Level densest(std::vector<float>& values) {
  std::sort(values.begin(), values.end());
  const std::size_t quarter = values.size() / 4;
  std::size_t narrowest = 0;
  for (std::size_t i = 0; i + quarter < values.size(); ++i)
    if (values[i + quarter] - values[i] < values[narrowest + quarter] - values[narrowest]) narrowest = i;
  // A quarter of normal values lies within 0.319 deviations of their mean, and the narrowest of many within
  // less.
  return {static_cast<double>(values[narrowest + quarter / 2]),
          1.5 / 0.637 * static_cast<double>(values[narrowest + quarter] - values[narrowest])};
}

/// The same density from all values close to it; its noise only falls, so that the next density stays out.
Level refined(const std::vector<float>& values, Level level) {
  for (int round = 0; round < 4; ++round) {
    const double within = std::max(3.5 * level.noise, 1.0);
    std::vector<float> about, off;
    for (const float value : values)
      if (std::abs(static_cast<double>(value) - level.value) <= within) about.push_back(value);
    if (about.empty()) return level;
    level.value = median_of(about);
    for (const float value : about) off.push_back(std::abs(value - static_cast<float>(level.value)));
    level.noise = std::min(level.noise, 1.4826 * median_of(off));
  }
  return level;
}

/// The middle of the values about the density that is nearest to this one.
double nearest_mode(const std::vector<float>& values, Level level) {
  for (int round = 0; round < 8; ++round) {
    std::vector<float> about;
    for (const float value : values)
      if (std::abs(static_cast<double>(value) - level.value) <= std::max(1.5 * level.noise, 1.0))
        about.push_back(value);
    if (about.empty()) break;
    level.value = median_of(about);
  }
  return level.value;
}

/// Half level's area of samples, in cells parted into six tetrahedra about a diagonal.
double level_mm2(const Grid& grid, const Values& values, float level) {
  constexpr int tets[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                              {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  Grid cells = grid;
  --cells.dims.z;
  return by_planes<double>(cells, [&](int z, double& area) {
    for (int y = 0; y + 1 < grid.dims.y; ++y)
      for (int x = 0; x + 1 < grid.dims.x; ++x) {
        std::array<double, 8> f;
        int inside = 0;
        for (int i = 0; i < 8; ++i) {
          const float value = values[grid.at(x + (i & 1), y + ((i >> 1) & 1), z + (i >> 2))];
          f[static_cast<std::size_t>(i)] = static_cast<double>(value - level);
          inside += value >= level ? 1 : 0;
        }
        if (inside == 0 || inside == 8) continue;
        for (const auto& tet : tets) {
          std::array<int, 4> in{}, out{};
          std::size_t in_count = 0, out_count = 0;
          for (const int k : tet)
            if (f[static_cast<std::size_t>(k)] >= 0.0)
              in[in_count++] = k;
            else
              out[out_count++] = k;
          if (in_count == 0 || out_count == 0) continue;
          const auto crossing = [&](int i, int o) {
            const double fi = f[static_cast<std::size_t>(i)], fo = f[static_cast<std::size_t>(o)];
            const auto place = [&](int k) {
              return glm::dvec3(k & 1, (k >> 1) & 1, k >> 2) * grid.spacing_mm;
            };
            return glm::mix(place(i), place(o), fi / (fi - fo));
          };
          const auto triangle = [&](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
            area += 0.5 * glm::length(glm::cross(q - p, r - p));
          };
          if (in_count == 1)
            triangle(crossing(in[0], out[0]), crossing(in[0], out[1]), crossing(in[0], out[2]));
          else if (out_count == 1)
            triangle(crossing(in[0], out[0]), crossing(in[1], out[0]), crossing(in[2], out[0]));
          else {
            const glm::dvec3 p = crossing(in[0], out[0]), r = crossing(in[1], out[1]);
            triangle(p, crossing(in[0], out[1]), r);
            triangle(p, r, crossing(in[1], out[0]));
          }
        }
      }
  });
}

/// Sums over the samples near the solid and those away from it.
struct Sums {
  double near = 0.0, near_square = 0.0, away = 0.0, away_square = 0.0, tail = 0.0;
  std::size_t band_count = 0, deep_count = 0, away_count = 0, tail_count = 0, border = 0, odd = 0, above = 0;
  double deep = 0.0;
  float highest = 0.0F;
  Sums& operator+=(const Sums& by) {
    near += by.near;
    near_square += by.near_square;
    away += by.away;
    away_square += by.away_square;
    tail += by.tail;
    band_count += by.band_count;
    deep_count += by.deep_count;
    away_count += by.away_count;
    tail_count += by.tail_count;
    border += by.border;
    odd += by.odd;
    above += by.above;
    deep += by.deep;
    highest = std::max(highest, by.highest);
    return *this;
  }
};

class Reading {
 public:
  Reading(const voxel::Scene& scan, double low) : scan_(scan), low_(low) {
    grid_.dims = scan.lattice.dims;
    grid_.spacing_mm = scan.lattice.spacing_mm();
  }

  /// False: the solid and what is about it are not of two densities.
  bool run(PhaseEvidence& found) {
    if (scan_.padding || glm::any(glm::lessThan(grid_.dims, glm::ivec3(8)))) return false;
    if (grid_.size() > most_samples) return false;
    const std::optional<Level> level = surroundings();
    if (!level) return false;
    background_ = level->value;
    noise_ = level->noise;
    contrast_ = 2.0 * (low_ - background_);
    if (!(contrast_ > 0.0) || noise_ > 0.2 * contrast_ || !are_beside()) return false;
    std::visit([&](const auto& samples) { values_.assign(samples.begin(), samples.end()); }, scan_.samples);
    filled_.assign(values_.size(), 0);
    if (is_beside_ || has_others_) fill_lower();
    std::array<Values, 4> at_blur;
    at_blur[2] = blurred(grid_, values_, added_blur[2]);
    find_least_seen(at_blur[2]);
    if (least_seen_ > std::min(5.0 * noise_ + 0.005 * contrast_, 0.3 * contrast_)) return false;  // they vary
    const bool has_plateau = finds_plateau(at_blur[2]);
    if ((is_beside_ && has_plateau) || !find_near(at_blur[2])) return false;
    find_core();
    Sums sums = summed(values_, true);
    sums.odd += odd_in(at_blur[2]);
    // Samples that lie alone are noise; elsewhere they are a third density.
    if (sums.odd > sums.away_count / 500 + 2 || sums.border > 0 || sums.away_count < 100) return false;
    const double mean = sums.away / static_cast<double>(sums.away_count);
    // A third density that no one sample shows moves the mean.
    if (std::abs(mean - background_) >
        0.005 * contrast_ + 0.1 * noise_ + 4.0 * noise_ / std::sqrt(static_cast<double>(sums.away_count)))
      return false;
    background_ = mean;
    contrast_ = 2.0 * (low_ - background_);
    if (sums.deep_count >= 30) {
      const double core = sums.deep / static_cast<double>(sums.deep_count) - background_;
      const double rounding = 4.0 * noise_ / std::sqrt(static_cast<double>(sums.deep_count));
      if (std::abs(core - contrast_) > 0.06 * contrast_ + rounding) return false;
      found.has_core = true;
      contrast_ = core;
    }
    at_blur[1] = blurred(grid_, values_, added_blur[1]);
    at_blur[3] = blurred(grid_, at_blur[2], std::sqrt(1.6 * 1.6 - 1.0));
    at_blur[0] = std::move(values_);
    const auto half = static_cast<float>(background_ + 0.5 * contrast_);
    for (std::size_t i = 0; i < 4; ++i) {
      const Sums shares = summed(at_blur[i], false);
      const double away = shares.away_square / static_cast<double>(shares.away_count);
      // White noise keeps one part in 44.5 of its variance after a blur of one sample.
      if (i == 2) found.correlation = std::sqrt(std::max(1.0, 44.5 * away / std::max(white_, 1e-9)));
      if (i == 0) white_ = away;
      found.squares[i] = shares.near_square - static_cast<double>(shares.band_count) * away;
      found.level_mm2[i] = level_mm2(grid_, at_blur[i], half);
      if (i == 2) found.highest = static_cast<double>(shares.highest);
      if (i > 0) continue;
      found.sum = shares.near;
      const glm::dvec3& spacing_mm = grid_.spacing_mm;
      found.counted_mm3 = static_cast<double>(shares.above) * spacing_mm.x * spacing_mm.y * spacing_mm.z;
      found.band = shares.band_count;
      found.tail = shares.tail;
      found.noise = contrast_ * std::sqrt(away);
    }
    const auto filled = std::count(filled_.begin(), filled_.end(), std::uint8_t{1});
    found.has_third = static_cast<std::size_t>(filled) > filled_.size() / 500;  // fewer are noise
    found.background = background_;
    found.contrast = contrast_;
    found.least_seen = least_seen_ / contrast_;
    found.is_ambiguous = !found.has_core && (has_others_ || (!is_beside_ && has_plateau) ||
                                             has_lower_plateau(at_blur[2], found.highest));
    return found.highest < 1.25 && found.sum > 0.0;
  }

 private:
  /// How far below or above the surroundings a sample is of another density.
  double far() const { return std::max(6.0 * noise_, 0.02 * contrast_); }

  /// The density that the solid lies in: that of samples three samples from it. Where too few samples reach
  /// the bound, that of most of the scan; of two common ones the higher.
  std::optional<Level> surroundings() {
    std::vector<float> beside, below;
    std::visit(
        [&](const auto& samples) {
          const std::size_t size = grid_.size(), stride = 1 + size / 200000;
          for (std::size_t i = 0; i < size; i += stride)
            if (static_cast<double>(samples[i]) < low_) below.push_back(static_cast<float>(samples[i]));
          find_reaches(samples);
        },
        scan_.samples);
    each_beside([&](double value) { beside.push_back(static_cast<float>(value)); });
    is_beside_ = beside.size() >= 100;
    if (below.size() < 100) return std::nullopt;
    Level level = refined(below, densest(below));
    if (is_beside_) {
      // Blur widens what is beside the solid: noise is that of most of the scan, if that is of this density.
      Level near = densest(beside);
      if (std::abs(near.value - level.value) < 3.0 * near.noise)
        near.noise = std::min(near.noise, level.noise);
      level.value = nearest_mode(below, near);
      level.noise = refined(below, {level.value, near.noise}).noise;
      return level;
    }
    const double off = std::max(6.0 * level.noise, 0.04 * (low_ - level.value));
    std::vector<float> others;
    std::copy_if(below.begin(), below.end(), std::back_inserter(others),
                 [&](float value) { return std::abs(static_cast<double>(value) - level.value) > off; });
    has_others_ = others.size() > below.size() / 4;
    if (!has_others_) return level;
    const Level other = refined(others, densest(others));
    return other.value > level.value ? other : level;
  }

  /// Samples over the bound that have another beside them along x, y or z: one alone is noise.
  template <typename Samples>
  void find_reaches(const Samples& samples) {
    reaches_.assign(samples.size(), 0);
    const auto is_over = [&](std::size_t i) { return static_cast<double>(samples[i]) >= low_; };
    for (int axis = 0; axis < 3; ++axis)
      each_row(grid_, axis, [&](std::size_t first, std::size_t stride, std::size_t length) {
        for (std::size_t i = 0; i + 1 < length; ++i)
          if (is_over(first + i * stride) && is_over(first + (i + 1) * stride))
            reaches_[first + i * stride] = reaches_[first + (i + 1) * stride] = 1;
      });
  }

  /// Runs `visit(value)` for samples below the bound that lie three samples along an axis from one that
  /// reaches it: of 200,000 such at most.
  template <typename Visit>
  void each_beside(const Visit& visit) const {
    std::vector<std::size_t> over;
    for (std::size_t i = 0; i < reaches_.size(); ++i)
      if (reaches_[i] != 0) over.push_back(i);
    const std::size_t every = 1 + over.size() / 200000;
    std::visit(
        [&](const auto& samples) {
          for (std::size_t k = 0; k < over.size(); k += every)
            for (int axis = 0; axis < 3; ++axis) {
              const std::size_t away = 3 * grid_.stride(axis);
              const int place =
                  static_cast<int>(over[k] / grid_.stride(axis) % static_cast<std::size_t>(grid_.dims[axis]));
              const auto look = [&](std::size_t at) {
                if (static_cast<double>(samples[at]) < low_) visit(static_cast<double>(samples[at]));
              };
              if (place >= 3) look(over[k] - away);
              if (place + 3 < grid_.dims[axis]) look(over[k] + away);
            }
        },
        scan_.samples);
  }

  /// Whether samples beside the solid are of these surroundings, but for what blur and near walls add.
  bool are_beside() const {
    std::size_t all = 0, below = 0, lower = 0, higher = 0;
    each_beside([&](double value) {
      ++all;
      below += value < background_ - 1.5 * noise_ ? 1 : 0;
      lower += value < background_ - far() ? 1 : 0;
      higher += value > background_ + 0.1 * contrast_ ? 1 : 0;
    });
    // One in fifteen normal values is 1.5 deviations below their mean.
    return 5 * below <= all && 20 * lower <= all && 7 * higher <= 6 * all;
  }

  /// Takes samples below the surroundings, and those beside them, for surroundings.
  void fill_lower() {
    const auto bound = static_cast<float>(background_ - far());
    for (std::size_t i = 0; i < values_.size(); ++i) filled_[i] = values_[i] < bound ? 1 : 0;
    grow(grid_, filled_, 1);
    fill();
    const Values at_one = blurred(grid_, values_, added_blur[2]);
    find_least_seen(at_one);
    const auto faint = static_cast<float>(background_ - least_seen_);
    for (std::size_t i = 0; i < values_.size(); ++i) filled_[i] |= at_one[i] < faint ? 1 : 0;
    fill();
  }

  /// Whether samples between both densities are alike over five along each axis: those of a third density, or
  /// of thin walls close together. No wall and no edge alone is, after a blur of one sample.
  bool finds_plateau(const Values& at_one) const {
    const Values lowest = extremes(grid_, at_one, 2, false), highest = extremes(grid_, at_one, 2, true);
    const auto zero = static_cast<float>(background_), unit = static_cast<float>(contrast_);
    const auto least = static_cast<float>(std::max(least_seen_ / contrast_, 0.03));
    for (std::size_t i = 0; i < at_one.size(); ++i) {
      const float low = (lowest[i] - zero) / unit, high = (highest[i] - zero) / unit;
      if (low >= least && high < 0.7F && low >= 0.6F * high) return true;
    }
    return false;
  }

  void fill() {
    for (std::size_t i = 0; i < values_.size(); ++i)
      if (filled_[i] != 0) values_[i] = static_cast<float>(background_);
  }

  void find_least_seen(const Values& at_one) {
    std::vector<float> values;
    const std::size_t stride = 1 + at_one.size() / 200000;
    for (std::size_t i = 0; i < at_one.size(); i += stride)
      if (filled_[i] == 0 && std::abs(static_cast<double>(at_one[i]) - background_) <= 3.5 * noise_ + 1.0)
        values.push_back(at_one[i]);
    // A blur of one sample leaves a seventh of white noise, and more of one that hangs together. Samples are
    // whole numbers: where nothing varies, half a unit does.
    least_seen_ = 0.005 * contrast_;
    if (values.size() >= 100)
      least_seen_ = std::max(5.0 * refined(values, densest(values)).noise, least_seen_);
  }

  /// False: nothing rises above noise, or a third density meets what does.
  bool find_near(const Values& at_one) {
    near_.resize(at_one.size());
    solid_.resize(at_one.size());
    const auto level = static_cast<float>(background_ + least_seen_);
    const auto quarter = static_cast<float>(background_ + 0.25 * contrast_);
    std::size_t risen = 0;
    for (std::size_t i = 0; i < near_.size(); ++i) {
      risen += near_[i] = at_one[i] >= level ? 1 : 0;
      solid_[i] = at_one[i] >= std::max(level, quarter) ? 1 : 0;
    }
    beyond_ = near_;
    grow(grid_, beyond_, 1);
    std::size_t met = 0;
    for (std::size_t i = 0; i < near_.size(); ++i) met += beyond_[i] != 0 && filled_[i] != 0 ? 1 : 0;
    grow(grid_, near_, 3);
    beyond_ = near_;
    grow(grid_, beyond_, 2);
    // A third density may leave no more surroundings than those just beyond.
    std::size_t away = 0;
    for (std::size_t i = 0; i < near_.size(); ++i) away += beyond_[i] == 0 && filled_[i] == 0 ? 1 : 0;
    if (away < 1000) beyond_ = near_;
    return risen > 0 && met <= risen / 500 + 2;
  }

  /// Samples of the surroundings that differ from them by more than noise after a blur of one sample.
  std::size_t odd_in(const Values& at_one) const {
    std::size_t odd = 0;
    for (std::size_t i = 0; i < at_one.size(); ++i)
      odd += near_[i] == 0 && filled_[i] == 0 &&
                     std::abs(static_cast<double>(at_one[i]) - background_) > least_seen_
                 ? 1
                 : 0;
    return odd;
  }

  void find_core() {
    deep_.resize(values_.size());
    for (std::size_t i = 0; i < deep_.size(); ++i) deep_[i] = static_cast<double>(values_[i]) < low_ ? 1 : 0;
    grow(grid_, deep_, 3);
    for (std::uint8_t& one : deep_) one = one == 0 ? 1 : 0;
  }

  /// Whether a solid without a core is too thick for its low samples: over half of the highest share, thin
  /// walls blurred by up to 1.6 samples are five samples wide at most below a share of 0.45, and seven below
  /// 0.7. The window's bound is not the half level then.
  bool has_lower_plateau(const Values& at_one, double highest) {
    if (highest >= 0.7) return false;
    const auto half = static_cast<float>(background_ + 0.5 * highest * contrast_);
    Mask thin(at_one.size());
    for (std::size_t i = 0; i < thin.size(); ++i) thin[i] = at_one[i] < half ? 1 : 0;
    grow(grid_, thin, highest < 0.45 ? 2 : 3);
    return std::count(thin.begin(), thin.end(), std::uint8_t{0}) > 4;
  }

  /// In sample units, or as shares of the contrast; a sample deep in the solid counts as one.
  Sums summed(const Values& values, bool as_they_are) const {
    const double unit = as_they_are ? 1.0 : contrast_, zero = as_they_are ? 0.0 : background_;
    return by_planes<Sums>(grid_, [&](int z, Sums& sums) {
      for (std::size_t i = grid_.at(0, 0, z), end = i + grid_.stride(2); i < end; ++i) {
        const double u = (static_cast<double>(values[i]) - zero) / unit;
        sums.highest = std::max(sums.highest, static_cast<float>(u));
        sums.above += u >= 0.5 ? 1 : 0;
        if (deep_[i] != 0) {
          ++sums.deep_count;
          sums.deep += u;
          sums.near += 1.0;
          sums.near_square += 1.0;
        } else if (near_[i] != 0) {
          ++sums.band_count;
          sums.near += u;
          sums.near_square += u * u;
        } else if (filled_[i] != 0) {
          continue;
        } else if (beyond_[i] != 0) {
          ++sums.tail_count;
          sums.tail += u;
        } else {
          ++sums.away_count;
          sums.away += u;
          sums.away_square += u * u;
          if (as_they_are && std::abs(u - background_) > far()) ++sums.odd;
        }
      }
      // The scan's outermost samples.
      for (int y = 0; y < grid_.dims.y; ++y)
        for (int x = 0; x < grid_.dims.x; ++x) {
          const bool is_border = x == 0 || y == 0 || z == 0 || x + 1 == grid_.dims.x ||
                                 y + 1 == grid_.dims.y || z + 1 == grid_.dims.z;
          if (is_border && solid_[grid_.at(x, y, z)] != 0) ++sums.border;
        }
    });
  }

  const voxel::Scene& scan_;
  Grid grid_;
  Values values_;
  Mask reaches_, solid_, near_, beyond_, deep_;
  Mask filled_;              ///< of a third density, taken for surroundings
  bool has_others_ = false;  ///< no sample reaches the bound, and the scan has two densities below it
  bool is_beside_ = false;   ///< the surroundings are those of samples over the bound
  double low_ = 0.0, background_ = 0.0, contrast_ = 0.0, noise_ = 0.0, least_seen_ = 0.0, white_ = 0.0;
};

/// What is left of the sum of squares of a solid whose area is `ratio` times its volume under a blur of this
/// deviation, both in samples: the mean covariogram.
double sheet_left(double ratio, double deviation) {
  const double thickness = 2.0 / ratio, q = std::numbers::sqrt2 * deviation;
  const double z = thickness / (q * std::numbers::sqrt2);
  return std::erf(z) - (1.0 - std::exp(-z * z)) / (z * std::sqrt(std::numbers::pi));
}
double rod_left(double ratio, double deviation) {
  const double x = 2.0 / (ratio * ratio * deviation * deviation);
  if (x > 500.0) return 1.0 - std::sqrt(2.0 / (std::numbers::pi * x));
  return 1.0 - std::exp(-x) * (std::cyl_bessel_i(0.0, x) + std::cyl_bessel_i(1.0, x));
}
double ball_left(double ratio, double deviation) {
  const double radius = 3.0 / ratio, q = std::numbers::sqrt2 * deviation, l = 2.0 * radius / q;
  const double e = std::exp(-0.5 * l * l), c = std::sqrt(2.0 / std::numbers::pi);
  const double zeroth = std::erf(l / std::numbers::sqrt2) - c * l * e;
  const double first = q * c * (2.0 - (2.0 + l * l) * e);
  const double third = q * q * q * c * (8.0 - (8.0 + 4.0 * l * l + l * l * l * l) * e);
  return zeroth - 0.75 / radius * first + third / (16.0 * radius * radius * radius);
}

/// Area per volume and the blur's deviation, in samples, by fits of sheets, rods and balls.
struct Fitted {
  double log_ratio = 0.0, spread = 0.0, deviation = 0.0;
  double misfit = 0.0;  ///< squared logarithms that the best fit leaves
};
Fitted fitted(const PhaseEvidence& found) {
  constexpr int deviations = 49, ratios = 241;
  constexpr std::array<double (*)(double, double), 3> shapes{sheet_left, rod_left, ball_left};
  std::array<double, 3> weights, log_ratios, blurs;
  Fitted mean;
  mean.misfit = std::numeric_limits<double>::infinity();
  for (std::size_t shape = 0; shape < 3; ++shape) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < deviations; ++i)
      for (int j = 0; j < ratios; ++j) {
        const double deviation = 0.3 + 1.2 * i / (deviations - 1.0);
        const double log_ratio = std::log(0.02) + std::log(400.0) * j / (ratios - 1.0);
        double off = 0.0;
        for (std::size_t k = 0; k < 4 && off < least; ++k) {
          const double left = shapes[shape](std::exp(log_ratio), std::hypot(deviation, added_blur[k]));
          const double miss = std::log(std::max(left, 1e-12) / std::max(found.squares[k] / found.sum, 1e-6));
          off += miss * miss;
        }
        if (off >= least) continue;
        least = off;
        log_ratios[shape] = log_ratio;
        blurs[shape] = deviation;
      }
    mean.misfit = std::min(mean.misfit, least);
    // Even the right shape misses by about one per cent at each blur.
    weights[shape] = 1.0 / ((least + 2e-4) * (least + 2e-4));
  }
  const double all = weights[0] + weights[1] + weights[2];
  for (std::size_t i = 0; i < 3; ++i) {
    mean.log_ratio += weights[i] / all * log_ratios[i];
    mean.deviation += weights[i] / all * blurs[i];
  }
  for (std::size_t i = 0; i < 3; ++i)
    mean.spread += weights[i] / all * (log_ratios[i] - mean.log_ratio) * (log_ratios[i] - mean.log_ratio);
  mean.spread = std::sqrt(mean.spread);
  return mean;
}

/// Logarithms of an area's bounds.
struct LogRange {
  double low = 0.0, high = 0.0;
};

Interval from_logs(double middle, double half, const std::string& name, const std::string& formula) {
  const double value = std::exp(middle) * std::cosh(half), half_width = std::exp(middle) * std::sinh(half);
  return {value, half_width, {{name, formula, half_width}}};
}

/// The likeliest value with the farther of both bounds.
Interval from_best(double best, const LogRange& range, const std::string& name, const std::string& formula) {
  const double value = std::exp(best);
  const double half_width = std::max(std::exp(range.high) - value, value - std::exp(range.low));
  return {value, half_width, {{name, formula, half_width}}};
}

/// 99 of 100 normal errors are within so many deviations, and some room for noise's own doubt.
constexpr double confidence = 2.8;

Interval volume_of(const PhaseEvidence& found, double sample_mm3) {
  const double value = found.sum * sample_mm3;
  const double noise = confidence * found.noise / found.contrast *
                       std::sqrt(static_cast<double>(found.band)) * found.correlation * sample_mm3;
  const double unseen = 0.3 * found.least_seen / std::max(found.highest, found.least_seen) * value;
  const double levels = 0.003 * value;
  const double tail = 0.6 * std::abs(found.tail) * sample_mm3;
  const double third =
      found.has_third ? 0.2 * found.least_seen * static_cast<double>(found.band) * sample_mm3 : 0.0;
  return {value,
          std::hypot(noise, tail) + levels + unseen + third,
          {{"noise", "2.8 sigma sqrt(samples near) of the contrast", noise},
           {"tail", "0.6 of the sum just beyond", tail},
           {"levels", "0.003 V", levels},
           {"unseen", "0.3 V least seen / highest", unseen},
           {"third density", "0.2 least seen, of all samples near", third}}};
}

/// The half level's area at two added blurs, continued to none by the variance or by the deviation; none
/// where the two do not follow from one another.
std::optional<LogRange> by_edges(const PhaseEvidence& found, const Fitted& fit) {
  const auto& level = found.level_mm2;
  if (!(level[2] > 0.0) || level[1] <= level[2] * 0.99 || level[1] >= 1.42 * level[2]) return std::nullopt;
  const double near = std::hypot(fit.deviation, added_blur[1]),
               far = std::hypot(fit.deviation, added_blur[2]);
  const double step = std::max(std::log(level[1] / level[2]), 0.0);
  const double least = near * near / (far * far - near * near) * step, most = near / (far - near) * step;
  const double apart = std::min(most - least, 0.6), middle = std::log(level[1]) + least + 0.3 * apart;
  return LogRange{middle - apart - 0.02, middle + apart + 0.02};
}

Interval area_of(const PhaseEvidence& found, const Fitted& fit, const glm::dvec3& spacing_mm) {
  const double sample_mm3 = spacing_mm.x * spacing_mm.y * spacing_mm.z;
  const std::optional<LogRange> edges = by_edges(found, fit);
  // A half level that loses over half of its area to the next blur is about to vanish and follows no power of
  // the blur.
  if (edges && found.level_mm2[3] >= 0.5 * found.level_mm2[2])
    return from_logs(
        0.5 * (edges->low + edges->high), 0.5 * (edges->high - edges->low), "edges",
        "the half level's area at two blurs, continued to none by the variance or the deviation");
  const double middle = std::log(found.sum * sample_mm3 / std::cbrt(sample_mm3)) + fit.log_ratio + 0.05;
  const double half = 0.4 + fit.spread + 0.06 / std::max(found.highest, 0.03);
  LogRange range{middle - half, middle + half};
  if (edges) range = {std::min(range.low, edges->low), std::max(range.high, edges->high)};
  return from_best(
      middle, range, "shape",
      "sheets, rods and balls that leave these sums of squares, and the half level while it lasts");
}

}  // namespace

std::optional<TwoPhase> two_phase(const voxel::Scene& scan, double low, const voxel::Progress& progress) {
  progress.at(0.0);
  TwoPhase found;
  if (!Reading(scan, low).run(found.evidence)) return std::nullopt;
  const glm::dvec3 spacing_mm = scan.lattice.spacing_mm();
  found.volume_mm3 = volume_of(found.evidence, spacing_mm.x * spacing_mm.y * spacing_mm.z);
  const Fitted fit = fitted(found.evidence);
  // Blurred solids of one density miss by less; samples of a third one do not fit.
  constexpr double most_misfit = 0.1;
  if (!(fit.misfit < most_misfit)) return std::nullopt;
  found.area_mm2 = area_of(found.evidence, fit, spacing_mm);
  return found;
}

void widen_to(const Interval& ambiguous, Interval& by_surface) {
  const double far = std::max(ambiguous.value + ambiguous.half_width - by_surface.value,
                              by_surface.value - ambiguous.value + ambiguous.half_width);
  if (far <= by_surface.half_width) return;
  by_surface.sources.push_back({"faint",
                                "what samples below the bound add up to: thin walls or a lower density",
                                far - by_surface.half_width, true});
  by_surface.half_width = far;
}

}  // namespace octotomy::verify
