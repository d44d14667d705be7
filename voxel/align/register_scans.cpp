// SPDX-License-Identifier: AGPL-3.0-or-later
// Rigid registration by the samples of two scans (thesis 9.2.3.1, the volume approach).
//
// Source: Maes, Collignon, Vandermeulen, Marchal, Suetens, Multimodality image registration by maximization of mutual
// information, 1997; the search is Hooke and Jeeves, "Direct search" solution of numerical and statistical problems,
// 1961. Departures: several starts, and a verdict. The thesis's own proposal, the first Fourier coefficients of the
// two objects, determines no rotation.
//
//   1 All starts are searched at 8 mm with long steps, then the best of them with short steps.
//   2 Searches that end at the same motion count as one. The best motion and its best rival are compared.
//   3 The best motion is refined to the finest resolution. Each resolution begins with steps of its own size.
//   4 Motions slightly away from the answer show whether it is a peak of the likeness.
#include "voxel/align/register_scans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>

#include "voxel/align/scan_pair.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"

namespace octotomy::voxel {
namespace {

constexpr double coarsest_mm = 8.0;
constexpr std::size_t coarse_points = 12000, fine_points = 100000;
constexpr double turned_deg = 30.0;
constexpr std::size_t most_refined = 6;
/// Likenesses that the search reaches even for scans of unrelated people, because all heads are roundish. An
/// answer with a lower likeness is meaningless.
constexpr double least_correlation = 0.4, least_entropy = 0.05;
/// If another motion reaches more than this share of the best likeness, it could be the true one.
constexpr double rival_share = 0.95;

/// A motion from the fixed to the moving scan: a rotation vector in radians about the fixed scan's middle,
/// then a translation in mm.
using Parameters = std::array<double, 6>;

class Search {
 public:
  Search(const Scene& moving, const Scene& fixed, const ScanFitOptions& options)
      : moving_(moving), fixed_(fixed), options_(options) {
    const Lattice& lattice = fixed.lattice;
    middle_mm_ = lattice.lps_mm(0.5 * glm::dvec3(lattice.dims - 1));
    for (int corner = 0; corner < 8; ++corner)
      corners_mm_[static_cast<std::size_t>(corner)] = lattice.lps_mm(
          glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2) * glm::dvec3(lattice.dims - 1));
    radius_mm_ = std::max(1.0, 0.5 * glm::distance(corners_mm_[0], middle_mm_));
  }

  ScanFit run() {
    ScanFit fit;
    std::vector<Found> found = from_all_starts(fit);
    const Found best = found.front();
    for (const Found& other : found) {
      const bool agrees = apart_mm(best.at, other.at) <= coarsest_mm;
      if (agrees) ++fit.agreeing;
      if (!agrees && (!fit.rival || other.likeness > *fit.rival)) fit.rival = other.likeness;
    }
    fit.likeness_there = best.likeness;
    fit.rival_mm = coarsest_mm;
    Parameters at = best.at;
    show(best);
    for (double resolution_mm = coarsest_mm / 2.0;; resolution_mm /= 2.0) {
      resolution_mm = std::max(resolution_mm, options_.finest_mm);
      const ScanPair pair(moving_, fixed_, resolution_mm, fine_points, options_.by);
      options_.progress.at(0.5 + 0.4 * options_.finest_mm / resolution_mm);
      const bool is_last = resolution_mm <= options_.finest_mm;
      const Found finer = improved(pair, resolution_mm, at, resolution_mm,
                                   is_last ? resolution_mm / 64.0 : resolution_mm / 8.0);
      show(finer);
      at = finer.at;
      if (!is_last) continue;
      const Likeness answer = pair.likeness(motion(at));
      fit.likeness = answer.value;
      fit.overlap = answer.overlap;
      fit.least_drop = least_drop(pair, at, answer.value, fit.probe_mm);
      break;
    }
    fit.fixed_from_moving = fixed_from_moving(at);
    fit.motions = motions_;
    judge(fit);
    options_.progress.at(1.0);
    return fit;
  }

 private:
  struct Found {
    Parameters at{};
    double likeness = 0.0;
    std::vector<ScanFitStep> trail = {};  ///< all steps since the start; recorded only if `watch` is set
  };

  glm::dmat4 motion(const Parameters& at) const {
    const glm::dvec3 turn(at[0], at[1], at[2]), shift(at[3], at[4], at[5]);
    glm::dmat4 moved = glm::translate(glm::dmat4(1.0), middle_mm_ + shift);
    const double angle = glm::length(turn);
    if (angle > 0.0) moved = glm::rotate(moved, angle, turn / angle);
    return glm::translate(moved, -middle_mm_);
  }

  /// The largest distance by which two motions separate a corner of the fixed scan.
  double apart_mm(const Parameters& a, const Parameters& b) const {
    double apart = 0.0;
    for (const glm::dvec3& corner : corners_mm_)
      apart = std::max(apart, glm::distance(glm::dvec3(motion(a) * glm::dvec4(corner, 1.0)),
                                            glm::dvec3(motion(b) * glm::dvec4(corner, 1.0))));
    return apart;
  }

  double value(const ScanPair& pair, const Parameters& at) {
    ++motions_;
    const Likeness likeness = pair.likeness(motion(at));
    // Too little overlap: the value is below every likeness and rises with the overlap, which leads the
    // search back to motions with enough overlap.
    if (likeness.overlap < options_.least_overlap) return likeness.overlap - 3.0;
    return likeness.value;
  }

  /// The step of parameter k, in radians or mm, that moves points by `step_mm`. For a rotation these points
  /// lie half the scan's diagonal from its middle.
  double step_of(std::size_t k, double step_mm) const { return k < 3 ? step_mm / radius_mm_ : step_mm; }

  Found improved(const ScanPair& pair, double resolution_mm, const Parameters& from, double first_mm,
                 double last_mm) {
    Found best{from, value(pair, from)};
    keep_step(best, resolution_mm);
    for (double step_mm = first_mm; step_mm >= last_mm;) {
      if (options_.progress.stop.stop_requested()) options_.progress.at(0.0);
      Parameters at = best.at;
      double reached = best.likeness;
      for (std::size_t k = 0; k < 6; ++k)
        for (const double sign : {1.0, -1.0}) {
          Parameters trial = at;
          trial[k] += sign * step_of(k, step_mm);
          const double likeness = value(pair, trial);
          if (!(likeness > reached)) continue;
          at = trial;
          reached = likeness;
          break;
        }
      if (!(reached > best.likeness)) {
        step_mm *= 0.5;
        continue;
      }
      Parameters further;
      for (std::size_t k = 0; k < 6; ++k) further[k] = 2.0 * at[k] - best.at[k];
      best.at = at;
      best.likeness = reached;
      if (const double likeness = value(pair, further); likeness > reached) {
        best.at = further;
        best.likeness = likeness;
      }
      keep_step(best, resolution_mm);
    }
    return best;
  }

  /// Replaces -0 by 0. Products of matrices may contain -0.
  glm::dmat4 fixed_from_moving(const Parameters& at) const {
    glm::dmat4 matrix = glm::inverse(motion(at));
    for (int column = 0; column < 4; ++column) matrix[column] += 0.0;
    return matrix;
  }

  void keep_step(Found& found, double resolution_mm) const {
    if (options_.watch) found.trail.push_back({resolution_mm, fixed_from_moving(found.at), found.likeness});
  }
  void show(const Found& found) const {
    for (const ScanFitStep& step : found.trail) options_.watch(step);
  }

  /// The best starts after refinement at the coarsest resolution, in descending order of likeness.
  std::vector<Found> from_all_starts(ScanFit& fit) {
    const ScanPair pair(moving_, fixed_, coarsest_mm, coarse_points, options_.by);
    for (const CoarseScan* scan : {&pair.moving(), &pair.fixed()})
      if (!(scan->high > scan->low))
        throw InvalidInput(
            std::string("the scan that ") + (scan == &pair.moving() ? "moves" : "stays") +
            " has nothing to compare: all but a few samples have one value; choose a scan with contrast");
    const Lattice& lattice = moving_.lattice;
    const std::array<glm::dvec3, 3> shifts{
        glm::dvec3(0.0), lattice.lps_mm(0.5 * glm::dvec3(lattice.dims - 1)) - middle_mm_,
        centre_of_mass_mm(pair.moving()) - centre_of_mass_mm(pair.fixed())};
    std::vector<Found> found;
    for (const glm::dvec3& shift : shifts)
      for (int turn = 0; turn < 7; ++turn) {
        Parameters start{0, 0, 0, shift.x, shift.y, shift.z};
        if (turn > 0)
          start[static_cast<std::size_t>((turn - 1) / 2)] = glm::radians(turn % 2 ? turned_deg : -turned_deg);
        found.push_back(improved(pair, coarsest_mm, start, 2.0 * coarsest_mm, 0.5 * coarsest_mm));
        options_.progress.at(0.35 * static_cast<double>(found.size()) / 21.0);
      }
    fit.starts = found.size();
    const auto by_likeness = [](const Found& a, const Found& b) { return a.likeness > b.likeness; };
    std::stable_sort(found.begin(), found.end(), by_likeness);
    found.resize(std::min(found.size(), most_refined));
    fit.refined = found.size();
    for (Found& each : found) {
      Found refined = improved(pair, coarsest_mm, each.at, 0.5 * coarsest_mm, coarsest_mm / 16.0);
      refined.trail.insert(refined.trail.begin(), each.trail.begin(), each.trail.end());
      each = std::move(refined);
      options_.progress.at(0.5);
    }
    std::stable_sort(found.begin(), found.end(), by_likeness);
    return found;
  }

  double least_drop(const ScanPair& pair, const Parameters& at, double likeness, double probe_mm) {
    double least = 2.0;
    for (std::size_t k = 0; k < 6; ++k)
      for (const double sign : {1.0, -1.0}) {
        Parameters aside = at;
        aside[k] += sign * step_of(k, probe_mm);
        least = std::min(least, likeness - value(pair, aside));
      }
    return least;
  }

  void judge(ScanFit& fit) const {
    const auto find = [&](Verdict verdict, const std::string& why) {
      fit.verdict = std::max(fit.verdict, verdict);
      fit.findings.push_back((verdict == Verdict::Fail ? "FAIL " : "WARN ") + why);
    };
    const bool is_correlation = options_.by == ScanLikeness::Correlation;
    const double least = is_correlation ? least_correlation : least_entropy;
    if (fit.overlap < options_.least_overlap)
      find(Verdict::Fail, "the scans overlap in only " + rounded(100.0 * fit.overlap) +
                              " % of the smaller one; align them by landmarks first, or allow a "
                              "smaller least overlap");
    else if (fit.likeness < least)
      find(Verdict::Fail,
           std::string("the scans match at no motion: the best ") +
               (is_correlation ? "correlation" : "mutual information") + " is " + rounded(fit.likeness) +
               ", but unrelated scans reach " + rounded(least) +
               (is_correlation ? "; compare scans of different contrast by mutual information" : ""));
    if (fit.rival && *fit.rival > rival_share * fit.likeness_there)
      find(Verdict::Warn, "another motion is nearly as good: likeness " + rounded(*fit.rival) + " beside " +
                              rounded(fit.likeness_there) + " at " + rounded(fit.rival_mm) +
                              " mm resolution; align the scans by landmarks first");
    if (fit.agreeing < 2)
      find(Verdict::Warn, "only one of " + std::to_string(fit.refined) + " searches ended at this motion");
    if (!(fit.least_drop > 0.0))
      find(Verdict::Warn, "a further motion of " + rounded(fit.probe_mm) +
                              " mm loses no likeness: the scans do not determine the motion");
  }

  const Scene& moving_;
  const Scene& fixed_;
  const ScanFitOptions& options_;
  glm::dvec3 middle_mm_{0.0};
  std::array<glm::dvec3, 8> corners_mm_;
  double radius_mm_ = 1.0;
  std::size_t motions_ = 0;
};

}  // namespace

ScanFit register_scans(const Scene& moving, const Scene& fixed, const ScanFitOptions& options) {
  check(moving);
  check(fixed);
  if (!(options.least_overlap > 0.0 && options.least_overlap <= 1.0))
    throw InvalidInput("the least overlap must be above 0 and at most 1");
  if (!(options.finest_mm > 0.0 && options.finest_mm <= coarsest_mm))
    throw InvalidInput("the finest resolution must be above 0 and at most 8 mm");
  return Search(moving, fixed, options).run();
}

}  // namespace octotomy::voxel
