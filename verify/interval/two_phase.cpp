// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Passes:
// 1 Estimate the densities of most of the scan, of the samples beside the solid, and of the core.
// 2 If the first two are equal, treat the scan as one of two densities. If they differ, or if two densities do not fit,
//   samples of a third density below the surroundings, such as air around tissue, count as surroundings if they do
//   not touch the solid. If they touch it the scan is rejected. A density between those of solid and surroundings
//   makes the result ambiguous.
// 3 Mark the samples near the solid: those that rise above noise after a blur of one sample, and all samples
//   within three samples of them.
// 4 Sum over the samples near the solid and over those away from it.
// 5 Fit volume and area to the sums (phase_size.h).
#include "verify/interval/two_phase.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "verify/interval/phase_size.h"
#include "verify/interval/sample_density.h"
#include "verify/interval/sample_grid.h"

namespace octotomy::verify {
namespace {

/// Number of samples of the largest scan: the copies of its samples take two gigabytes.
constexpr std::size_t most_samples = std::size_t{1} << 27;

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

  /// Measures the scan. Returns false if the solid and its surroundings do not have two densities.
  bool run(PhaseEvidence& found) {
    if (scan_.padding || glm::any(glm::lessThan(grid_.dims, glm::ivec3(8))) || is_sheared()) return false;
    if (grid_.size() > most_samples || !look_about()) return false;
    // Gaps between adjacent walls also have a density of their own. So where the densities beside the solid
    // and of most of the scan differ, the attempt with two densities comes last.
    const bool may_be_of_two = is_of_two_;
    const bool is_other = is_beside_ && std::abs(beside_.value - all_.value) > far();
    if (may_be_of_two && !is_other && run_in(all_, found)) return true;
    found = {};
    is_of_two_ = false;
    if (are_beside() && run_in(beside_, found)) return true;
    found = {};
    is_of_two_ = true;
    if (!may_be_of_two || !is_other || !run_in(all_, found)) return false;
    found.is_ambiguous = true;
    return true;
  }

 private:
  /// As run(), for one attempt, with `level` as the density of the surroundings.
  bool run_in(const SampleDensity& level, PhaseEvidence& found) {
    take(level);
    if (!(contrast_ > 0.0) || noise_ > 0.2 * contrast_) return false;
    std::visit([&](const auto& samples) { values_.assign(samples.begin(), samples.end()); }, scan_.samples);
    filled_.assign(values_.size(), 0);
    if (!is_of_two_) fill_lower();
    std::array<SampleValues, 4> at_blur;
    at_blur[2] = blurred(grid_, values_, added_blur[2]);
    find_least_seen(at_blur[2]);
    if (!is_of_two_ && least_seen_ > std::min(5.0 * noise_ + 0.005 * contrast_, 0.3 * contrast_))
      return false;  // the surroundings vary
    const bool has_plateau = finds_plateau(at_blur[2]);
    if (!find_near(at_blur[2])) return false;
    find_core();
    Sums sums = summed(values_, true);
    if (!is_of_two_) sums.odd += odd_in(at_blur[2]);
    // A few odd samples are noise; more of them are a third density.
    if (sums.odd > sums.away_count / 500 + 2 || sums.border > 0 || sums.away_count < 100) return false;
    const double mean = sums.away / static_cast<double>(sums.away_count);
    // A third density too faint to show in a single sample shifts the mean.
    if (!is_of_two_ &&
        std::abs(mean - background_) >
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
      // A blur of one sample reduces the variance of white noise to 1 / 44.5.
      if (i == 2) found.correlation = std::sqrt(std::max(1.0, 44.5 * away / std::max(white_, 1e-9)));
      if (i == 0) white_ = away;
      found.squares[i] = shares.near_square - static_cast<double>(shares.band_count) * away;
      found.level_mm2[i] = level_mm2(grid_, at_blur[i], half);
      if (i == 2) found.highest = static_cast<double>(shares.highest);
      if (i > 0) continue;
      found.sum = shares.near;
      found.counted_mm3 = static_cast<double>(shares.above) * sample_mm3();
      found.band = shares.band_count;
      found.tail = shares.tail;
      found.noise = contrast_ * std::sqrt(away);
    }
    found.has_third = !is_of_two_;
    found.background = background_;
    found.contrast = contrast_;
    found.least_seen = least_seen_ / contrast_;
    // Blur lowers the samples of walls that are thin everywhere. If samples over the half level are a small
    // part of the sum although some samples are hardly lowered, the rest probably has a third density. If
    // there is a core, the rest certainly has one.
    const bool is_much_more = found.highest > 0.8 && found.sum * sample_mm3() > 1.6 * found.counted_mm3;
    if (is_much_more && found.has_core) return false;
    found.is_ambiguous =
        has_plateau || is_much_more ||
        (!found.has_core && ((!is_of_two_ && !is_beside_) || has_lower_plateau(at_blur[2], found.highest)));
    return found.highest < 1.25 && found.sum > 0.0;
  }

  double sample_mm3() const { return grid_.spacing_mm.x * grid_.spacing_mm.y * grid_.spacing_mm.z; }

  /// Whether the scan's axes are not perpendicular. Blurs and areas require perpendicular axes.
  bool is_sheared() const {
    const glm::dmat3 axes(scan_.lattice.lps_from_voxel);
    const auto cosine = [&](int a, int b) {
      return std::abs(glm::dot(glm::normalize(axes[a]), glm::normalize(axes[b])));
    };
    return std::max({cosine(0, 1), cosine(1, 2), cosine(2, 0)}) > 1e-3;
  }

  void take(const SampleDensity& level) {
    background_ = level.value;
    noise_ = level.noise;
    contrast_ = 2.0 * (low_ - background_);
  }

  /// A sample that differs from the surroundings by more than this has another density.
  double far() const { return std::max(6.0 * noise_, 0.02 * contrast_); }

  /// Estimates the density of most of the scan below the bound, and that of the solid's surroundings. The
  /// latter comes from samples at a distance of three samples from the solid or, if too few samples reach the
  /// bound, is the higher of the two most frequent densities. Returns false if too few samples are below the
  /// bound.
  bool look_about() {
    std::vector<float> below, others, beside;
    std::visit(
        [&](const auto& samples) {
          const std::size_t size = grid_.size(), stride = 1 + size / 200000;
          for (std::size_t i = 0; i < size; i += stride)
            if (static_cast<double>(samples[i]) < low_) below.push_back(static_cast<float>(samples[i]));
          find_over(samples);
        },
        scan_.samples);
    if (below.size() < 100) return false;
    all_ = beside_ = refined(below, densest(below));
    take(all_);
    std::copy_if(below.begin(), below.end(), std::back_inserter(others),
                 [&](float value) { return std::abs(static_cast<double>(value) - all_.value) > far(); });
    is_of_two_ = others.size() <= below.size() / 4;
    each_beside([&](double value) { beside.push_back(static_cast<float>(value)); });
    is_beside_ = beside.size() >= 100;
    if (is_beside_) {
      // Blur widens the distribution of the samples beside the solid. If most of the scan has the same
      // density, the noise of most of the scan is used instead.
      beside_ = densest(beside);
      if (std::abs(beside_.value - all_.value) < 3.0 * beside_.noise)
        beside_.noise = std::min(beside_.noise, all_.noise);
      beside_.value = nearest_mode(below, beside_);
      beside_.noise = refined(below, beside_).noise;
    } else if (others.size() >= 100) {
      const SampleDensity other = refined(others, densest(others));
      if (other.value > all_.value) beside_ = other;
    }
    return true;
  }

  /// Collects the positions of samples over the bound that have a neighbour over it along x, y or z, because
  /// a single sample is noise. Keeps at most 200,000 of them, evenly spread.
  template <typename Samples>
  void find_over(const Samples& samples) {
    const auto is_over = [&](std::size_t i) { return static_cast<double>(samples[i]) >= low_; };
    const glm::ivec3 last = grid_.dims - 1;
    for (int z = 0; z <= last.z; ++z)
      for (int y = 0; y <= last.y; ++y)
        for (int x = 0; x <= last.x; ++x) {
          const std::size_t i = grid_.at(x, y, z);
          if (!is_over(i)) continue;
          if ((x > 0 && is_over(i - 1)) || (x < last.x && is_over(i + 1)) ||
              (y > 0 && is_over(i - grid_.stride(1))) || (y < last.y && is_over(i + grid_.stride(1))) ||
              (z > 0 && is_over(i - grid_.stride(2))) || (z < last.z && is_over(i + grid_.stride(2))))
            over_.emplace_back(x, y, z);
        }
    const std::size_t every = 1 + over_.size() / 200000;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < over_.size(); k += every) over_[kept++] = over_[k];
    over_.resize(kept);
  }

  /// Calls `visit(value)` for each sample below the bound that is three samples along an axis from a position
  /// in over_.
  template <typename Visit>
  void each_beside(const Visit& visit) const {
    std::visit(
        [&](const auto& samples) {
          for (const glm::ivec3& at : over_)
            for (int axis = 0; axis < 3; ++axis)
              for (const int by : {-3, 3}) {
                glm::ivec3 beside = at;
                beside[axis] += by;
                if (beside[axis] < 0 || beside[axis] >= grid_.dims[axis]) continue;
                const auto value = static_cast<double>(samples[grid_.at(beside.x, beside.y, beside.z)]);
                if (value < low_) visit(value);
              }
        },
        scan_.samples);
  }

  /// Whether the samples beside the solid have the density of the surroundings, except for a few that blur or
  /// adjacent walls change.
  bool are_beside() {
    take(beside_);
    std::size_t all = 0, below = 0, lower = 0, higher = 0;
    each_beside([&](double value) {
      ++all;
      below += value < background_ - 1.5 * noise_ ? 1 : 0;
      lower += value < background_ - far() ? 1 : 0;
      higher += value > background_ + 0.1 * contrast_ ? 1 : 0;
    });
    // One in fifteen normally distributed values is more than 1.5 deviations below the mean.
    return 5 * below <= all && 20 * lower <= all && 7 * higher <= 6 * all;
  }

  /// Replaces samples of a lower density than that of the surroundings, and their neighbours, by the density
  /// of the surroundings.
  void fill_lower() {
    const auto bound = static_cast<float>(background_ - far());
    for (std::size_t i = 0; i < values_.size(); ++i) filled_[i] = values_[i] < bound ? 1 : 0;
    grow(grid_, filled_, 1);
    fill();
    const SampleValues at_one = blurred(grid_, values_, added_blur[2]);
    find_least_seen(at_one);
    const auto faint = static_cast<float>(background_ - least_seen_);
    for (std::size_t i = 0; i < values_.size(); ++i) filled_[i] |= at_one[i] < faint ? 1 : 0;
    fill();
  }

  /// Whether samples between both densities are nearly equal over five samples along each axis. A third
  /// density causes this, or thin walls close together. After a blur of one sample a single wall or edge has
  /// no such plateau.
  bool finds_plateau(const SampleValues& at_one) const {
    const SampleValues lowest = extremes(grid_, at_one, 2, false), highest = extremes(grid_, at_one, 2, true);
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

  void find_least_seen(const SampleValues& at_one) {
    std::vector<float> values;
    const std::size_t stride = 1 + at_one.size() / 200000;
    for (std::size_t i = 0; i < at_one.size(); i += stride)
      if (filled_[i] == 0 && std::abs(static_cast<double>(at_one[i]) - background_) <= 3.5 * noise_ + 1.0)
        values.push_back(at_one[i]);
    // A blur of one sample reduces white noise to a seventh, and correlated noise less. The lower limit is
    // for scans without noise, because samples are rounded to whole numbers.
    least_seen_ = 0.005 * contrast_;
    if (values.size() >= 100)
      least_seen_ = std::max(5.0 * refined(values, densest(values)).noise, least_seen_);
  }

  /// Marks the samples near the solid. Returns false if no sample rises above noise, or if a third density
  /// touches the samples that do.
  bool find_near(const SampleValues& at_one) {
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
    if (!is_of_two_) {
      // Beside a third density the only samples of the surroundings may be those just beyond the solid.
      std::size_t away = 0;
      for (std::size_t i = 0; i < near_.size(); ++i) away += beyond_[i] == 0 && filled_[i] == 0 ? 1 : 0;
      if (away < 1000) beyond_ = near_;
    }
    return risen > 0 && met <= risen / 500 + 2;
  }

  /// Number of samples in the surroundings that differ from the density of the surroundings by more than
  /// noise, after a blur of one sample.
  std::size_t odd_in(const SampleValues& at_one) const {
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

  /// Whether a solid without a core is too thick for the low values of its samples. The window's bound is
  /// then not its half level. Samples above half of the highest share are compared with thin walls under a
  /// blur of up to 1.6 samples: these are at most five samples wide if the highest share is below 0.45, and
  /// seven if it is below 0.7.
  bool has_lower_plateau(const SampleValues& at_one, double highest) {
    if (highest >= 0.7) return false;
    const auto half = static_cast<float>(background_ + 0.5 * highest * contrast_);
    SampleMask thin(at_one.size());
    for (std::size_t i = 0; i < thin.size(); ++i) thin[i] = at_one[i] < half ? 1 : 0;
    grow(grid_, thin, highest < 0.45 ? 2 : 3);
    return std::count(thin.begin(), thin.end(), std::uint8_t{0}) > 4;
  }

  /// Sums over the samples: in sample units, or in shares of the contrast. In `near` a sample deep in the
  /// solid counts as one.
  Sums summed(const SampleValues& values, bool as_they_are) const {
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
      for (int y = 0; y < grid_.dims.y; ++y)
        for (int x = 0; x < grid_.dims.x; ++x) {
          const bool is_border = x == 0 || y == 0 || z == 0 || x + 1 == grid_.dims.x ||
                                 y + 1 == grid_.dims.y || z + 1 == grid_.dims.z;
          if (is_border && solid_[grid_.at(x, y, z)] != 0) ++sums.border;
        }
    });
  }

  const voxel::Scene& scan_;
  SampleGrid grid_;
  SampleValues values_;
  std::vector<glm::ivec3> over_;  ///< samples over the bound
  SampleMask solid_, near_, beyond_, deep_;
  SampleMask filled_;           ///< samples of a third density, which count as surroundings
  SampleDensity all_, beside_;  ///< density of most of the scan, and of the samples beside the solid
  bool is_of_two_ = false;      ///< treat the scan as one of two densities, without a third
  bool is_beside_ = false;      ///< whether beside_ was measured beside the solid
  double low_ = 0.0, background_ = 0.0, contrast_ = 0.0, noise_ = 0.0, least_seen_ = 0.0, white_ = 0.0;
};

}  // namespace

std::optional<TwoPhase> two_phase(const voxel::Scene& scan, double low, const voxel::Progress& progress) {
  progress.at(0.0);
  TwoPhase found;
  if (!Reading(scan, low).run(found.evidence)) return std::nullopt;
  const glm::dvec3 spacing_mm = scan.lattice.spacing_mm();
  found.volume_mm3 = phase_volume(found.evidence, spacing_mm.x * spacing_mm.y * spacing_mm.z);
  const std::optional<Interval> area_mm2 = phase_area(found.evidence, spacing_mm);
  if (!area_mm2) return std::nullopt;
  found.area_mm2 = *area_mm2;
  return found;
}

void widen_to(const Interval& ambiguous, Interval& by_surface) {
  const double far = std::max(ambiguous.value + ambiguous.half_width - by_surface.value,
                              by_surface.value - ambiguous.value + ambiguous.half_width);
  if (far <= by_surface.half_width) return;
  by_surface.sources.push_back({"faint", "the sum of samples below the bound: thin walls or a lower density",
                                far - by_surface.half_width, true});
  by_surface.half_width = far;
}

}  // namespace octotomy::verify
