// SPDX-License-Identifier: AGPL-3.0-or-later
// The k-th coefficient of a polygon of length L is L / (2 pi k)^2 times a sum over its corners: the change of
// direction at the corner times e^(-2 pi i k s), where s is the corner's place along the contour in turns. 1
// Spread the changes of direction over an even grid by a Gaussian; 2 transform; 3 divide by the Gaussian's
// transform, which yields the sums for all k at once; 4 do the reverse to compute the smooth contour's
// points. Source of 1-4: Greengard and Lee, "Accelerating the nonuniform fast Fourier transform", SIAM Review
// 46, 2004.
#include "brep/contour/fourier_smooth.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>
#include <utility>
#include <vector>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// A regular grid around a circle, for sums of waves, up to a number of harmonics, at positions that need not
/// be grid points. With at least four grid points per wave, and a Gaussian that is cut off at 14 grid points,
/// the cut and the higher waves cause errors of at most e^-37 of the largest value, which is below rounding.
class Circle {
 public:
  explicit Circle(std::size_t harmonics) : count_(std::bit_ceil(8 * harmonics)), grid_(count_) {
    const double grids_per_wave = static_cast<double>(count_) / (2.0 * static_cast<double>(harmonics));
    assert(grids_per_wave >= 4.0);
    sharpness_ = pi * (1.0 - 0.5 / grids_per_wave) / reach;
  }

  /// To sum value e^(-2 pi i k turn): call spread() for all values, to_waves(), then multiply wave(k) by
  /// undone(k).
  void spread(double turn, const Complex& value) {
    near(turn, [&](Complex& at, double weight) { at += weight * value; });
  }
  void to_waves() {
    std::vector<Complex> waves;
    transform().fwd(waves, grid_);
    grid_ = std::move(waves);
  }

  /// To sum wave(k) e^(2 pi i k turn): set all waves, multiplied by undone(k), call from_waves(), then
  /// gather().
  void from_waves() {
    std::vector<Complex> sums;
    transform().inv(sums, grid_);
    grid_ = std::move(sums);
  }
  Complex gather(double turn) {
    Complex sum = 0.0;
    near(turn, [&](const Complex& at, double weight) { sum += weight * at; });
    return sum;
  }

  Complex& wave(std::ptrdiff_t k) { return grid_[static_cast<std::size_t>(k) & (count_ - 1)]; }
  /// The factor that undoes the Gaussian's transform at k.
  double undone(std::ptrdiff_t k) const {
    const double angle = 2.0 * pi * static_cast<double>(k) / static_cast<double>(count_);
    return std::sqrt(sharpness_ / pi) * std::exp(angle * angle / (4.0 * sharpness_));
  }

 private:
  static constexpr int reach = 14;

  static Eigen::FFT<double> transform() { return Eigen::FFT<double>({}, Eigen::FFT<double>::Unscaled); }

  /// Calls use(grid point, weight) for the grid points near a position.
  template <typename Use>
  void near(double turn, const Use& use) {
    const double place = turn * static_cast<double>(count_), middle = std::round(place);
    for (int k = -reach; k <= reach; ++k) {
      const double away = middle + k - place;
      use(wave(static_cast<std::ptrdiff_t>(middle) + k), std::exp(-sharpness_ * away * away));
    }
  }

  std::size_t count_;
  double sharpness_;
  std::vector<Complex> grid_;
};

}  // namespace

Contour fourier_smooth(const Contour& contour, const FourierOptions& options) {
  need_closed(contour, "fourier_smooth");
  if (options.harmonics < 1) throw InvalidInput("fourier_smooth: keep at least one harmonic");
  if (options.points <= 2 * options.harmonics)
    throw InvalidInput("fourier_smooth: " + std::to_string(options.points) + " points cannot carry " +
                       std::to_string(options.harmonics) + " harmonics");
  const double length = perimeter_mm(contour);
  if (!(length > 0.0) || !std::isfinite(length))
    throw InvalidInput("fourier_smooth: the contour's length is not above 0 and finite");
  const auto& p = contour.points_mm;

  struct EdgeSpan {
    double turn;  ///< position at which the piece begins, as a share of the contour's length
    Complex direction;
  };
  std::vector<EdgeSpan> pieces;
  Complex mean = 0.0;
  double along = 0.0;
  for (std::size_t a = 0; a < p.size(); ++a) {
    const glm::dvec2 from = p[a], to = p[(a + 1) % p.size()];
    const double step = glm::distance(from, to);
    if (step == 0.0) continue;
    pieces.push_back({along / length, Complex(to.x - from.x, to.y - from.y) / step});
    mean += Complex(0.5 * (from.x + to.x), 0.5 * (from.y + to.y)) * step;
    along += step;
  }
  Circle corners(options.harmonics);
  for (std::size_t a = pieces.size() - 1, b = 0; b < pieces.size(); a = b++)
    corners.spread(pieces[b].turn, pieces[a].direction - pieces[b].direction);
  corners.to_waves();
  mean /= length;

  Circle smoothed(options.harmonics);
  const auto kept = static_cast<std::ptrdiff_t>(options.harmonics);
  for (std::ptrdiff_t k = -kept; k <= kept; ++k) {
    if (k == 0) continue;
    const double angular = 2.0 * pi * static_cast<double>(k), undone = corners.undone(k);
    smoothed.wave(k) = corners.wave(k) * undone * undone * (length / (angular * angular));
  }
  smoothed.from_waves();
  Contour smooth;
  for (std::size_t n = 0; n < options.points; ++n) {
    const Complex z = mean + smoothed.gather(static_cast<double>(n) / static_cast<double>(options.points));
    smooth.points_mm.emplace_back(z.real(), z.imag());
  }
  return smooth;
}

}  // namespace octotomy::brep
