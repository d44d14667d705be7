// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The surface of a threshold loses walls thinner than the blur (Prevrhal, Engelke and Kalender 1999, Accuracy
// limits for the determination of cortical width and density; Dougherty and Newman 1999; Treece et al. 2010,
// High resolution cortical bone thickness measurement from clinical CT data). Treece fits each wall's profile
// with a fixed density. Here the same model, one density and a blur, is summed over the whole solid.
//
// u      A sample minus the background, as a share of the contrast.
// volume The sum of u near the solid. Blur, voxel means and the spacing of slices do not change it. Its error
//        comes from noise, from the background, and from parts too faint to be found.
// area   1 The sum of u - u^2, over the blur's deviation s, is the area over sqrt(pi) on a surface that is
//          flat over the blur. Of thinner solids the sum of u^2 over that of u is the mean of the solid's
//          covariogram (Porod 1951; Debye, Anderson and Brumberger 1957) under a Gaussian of variance 2 s^2.
//          Sheets, rods and balls have closed or tabulated covariograms. Each is fitted, with its s, to the
//          sums at four added blurs. The fits are weighted by their misfit.
//        2 The half level's area after two added blurs, extrapolated to no blur. The loss at curvature and
//          edges is nearly proportional to the variance of the blur.
//        The value lies between both. Their difference and that of the fits are sources of doubt.
#include "verify/interval/phase_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace octotomy::verify {
namespace {

/// The share of a sheet's sum of squares that remains under a blur of this deviation, in samples: the mean
/// covariogram. The sheet's area is `ratio` times its volume. rod_left() and ball_left() return the same for
/// rods and balls.
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

/// The area per volume (as a logarithm, with its spread) and the deviation of the blur, in samples. Means of
/// three fits, of sheets, rods and balls, weighted by their misfit.
struct Fitted {
  double log_ratio = 0.0, spread = 0.0, deviation = 0.0;
  double misfit = 0.0;  ///< residual of the best fit, in squared logarithms
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
    // Even for the right shape the model has an error of about one per cent at each blur.
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

/// Logarithms of an area's most likely value and of its bounds.
struct LogRange {
  double best = 0.0, low = 0.0, high = 0.0;
};

/// Converts a range to an interval. The half-width is the distance of the most likely value from the farther
/// bound.
Interval interval_of(const LogRange& range, const std::string& name, const std::string& formula) {
  const double value = std::exp(range.best);
  const double half_width = std::max(std::exp(range.high) - value, value - std::exp(range.low));
  return {value, half_width, {{name, formula, half_width}}};
}

/// Half-width of the noise's interval, in standard deviations. 99 of 100 normal errors are within 2.6
/// deviations; the rest allows for an error of the deviation.
constexpr double confidence = 2.8;

/// The half level's area at two added blurs, extrapolated to no blur by the variance and by the deviation.
/// None if the two areas are not consistent.
std::optional<LogRange> by_edges(const PhaseEvidence& found, const Fitted& fit) {
  const auto& level = found.level_mm2;
  if (!(level[2] > 0.0) || level[1] <= level[2] * 0.99 || level[1] >= 1.42 * level[2]) return std::nullopt;
  const double near = std::hypot(fit.deviation, added_blur[1]),
               far = std::hypot(fit.deviation, added_blur[2]);
  const double step = std::max(std::log(level[1] / level[2]), 0.0);
  const double least = near * near / (far * far - near * near) * step, most = near / (far - near) * step;
  const double apart = std::min(most - least, 0.6), middle = std::log(level[1]) + least + 0.3 * apart;
  // If the solid is thin everywhere, projections and grooves as narrow as the blur may not reach the half
  // level.
  const double lost = found.has_core ? 0.0 : 0.12;
  return LogRange{middle, middle - apart - 0.02, middle + apart + 0.02 + lost};
}

}  // namespace

Interval phase_volume(const PhaseEvidence& found, double sample_mm3) {
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

std::optional<Interval> phase_area(const PhaseEvidence& found, const glm::dvec3& spacing_mm) {
  const Fitted fit = fitted(found);
  // Blurred solids of one density have a smaller misfit, samples of a third density a larger one.
  constexpr double most_misfit = 0.1;
  if (!(fit.misfit < most_misfit)) return std::nullopt;
  const double sample_mm3 = spacing_mm.x * spacing_mm.y * spacing_mm.z;
  const std::optional<LogRange> edges = by_edges(found, fit);
  // A half level that loses more than half of its area with the next blur is about to vanish. Its area
  // follows no power of the blur.
  if (edges && found.level_mm2[3] >= 0.5 * found.level_mm2[2])
    return interval_of(
        *edges, "edges",
        "the half level's area at two blurs, extrapolated to no blur by the variance or the deviation");
  const double middle = std::log(found.sum * sample_mm3 / std::cbrt(sample_mm3)) + fit.log_ratio + 0.05;
  // Thin walls close together keep a larger share of the sums than a single wall, so the fit underestimates
  // their area.
  const double least_half = found.is_ambiguous ? 0.75 : 0.4;
  const double half = least_half + fit.spread + 0.06 / std::max(found.highest, 0.03);
  LogRange range{middle, middle - half, middle + half};
  if (edges) range = {middle, std::min(range.low, edges->low), std::max(range.high, edges->high)};
  return interval_of(
      range, "shape",
      "sheets, rods and balls fitted to the sums of squares, and the half level while it exists");
}

}  // namespace octotomy::verify
