// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/fit_trust.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

/// Smallest cosine between the normals of matching surfaces: 37 degrees, which the facets of a noisy surface
/// do not exceed.
constexpr double matching_cosine() {
  return 0.8;
}

/// A right fit matches at least `least_ratio` times as much of the surface as any other motion, and exceeds
/// it by at least `least_lead` of the surface. Neither constant is derived: they were chosen by trial fits of
/// bones and of generated bodies, of which up to 60 % was missing or belonged to another body.
constexpr double least_ratio() {
  return 2.0;
}
/// If a fit matches less than `small_share` of the surface, its match must be `least_small_ratio` times that
/// of any other motion: caps of rounded bodies reach 2.5 times by chance.
constexpr double small_share() {
  return 0.4;
}
constexpr double least_small_ratio() {
  return 2.8;
}
constexpr double least_lead() {
  return 0.12;
}
/// A match of less than this share of the surface is no evidence, even if other motions match less: bumps of
/// a rounded body match a fifth of the body by chance.
constexpr double least_share() {
  return 0.2;
}

/// If surfaces coincide except for noise, the standard deviation of the samples' distances is about the
/// noise. Then at least 68 % of the samples lie within that distance, and at most 1.46 times as many within
/// four times that distance. If samples are scattered evenly about a surface, for example where caps of two
/// bodies happen to be alike, several times as many lie within four times the distance. A small match is
/// chance if four times the distance holds more than this many times as many samples.
constexpr double most_growth() {
  return 1.5;
}

/// Motions are equal answers if each matches at least this share of the area that the best one matches.
constexpr double equal_ratio() {
  return 0.75;
}

/// Equal answers match at least this share of the surface within the third distance of trust_ladder_mm().
constexpr double equal_share() {
  return 0.35;
}

/// The fits of a symmetric shape match equally much, apart from the noise of samples. Two matches are chance,
/// as for caps of two unrelated bodies, if the smaller is below `chance_ratio` times the larger and the fit
/// matches less than `chance_share` of the surface.
constexpr double chance_ratio() {
  return 0.95;
}
constexpr double chance_share() {
  return 0.6;
}

/// Motions closer than this share of the spread count as one answer. Refinements that reach the same answer
/// with few samples end within a hundredth of the spread of each other.
constexpr double same_share() {
  return 0.1;
}

/// A residual above both `most_noises` times the noise and `most_residual_share` of the spread comes from
/// parts without a counterpart.
constexpr double most_noises() {
  return 5.0;
}
constexpr double most_residual_share() {
  return 0.02;
}

constexpr std::size_t near_rungs =
    3;  ///< the first rungs of trust_ladder_mm(); the last rung decides only between Doubtful and Failed

std::string per_cent(double share) {
  return short_text(100.0 * share) + " %";
}

/// Judges a fit that began at a given start by its matched shares `own` within the distances `ladder_mm`.
FitTrust trust_of_start(const std::vector<double>& own, const std::vector<double>& ladder_mm,
                        FitTrust trust) {
  if (own[1] >= 0.15 || own[2] >= 0.3) return trust;
  trust.verdict = own.back() < 0.1 ? FitVerdict::Failed : FitVerdict::Doubtful;
  trust.matched_share = own.back();
  trust.tolerance_mm = ladder_mm.back();
  trust.reason = "only " + per_cent(own.back()) + " of the surface lies within " +
                 short_text(ladder_mm.back()) + " mm of the other one";
  return trust;
}

}  // namespace

double own_noise_mm(const Mesh& mesh) {
  std::vector<double> distances;
  for (const auto v : mesh.vertices()) {
    if (mesh.is_boundary(v)) continue;
    Mesh::Point middle(0.0, 0.0, 0.0);
    int count = 0;
    for (const auto w : mesh.vv_range(v)) {
      middle += mesh.point(w);
      ++count;
    }
    if (count < 3) continue;
    Mesh::Point normal(0.0, 0.0, 0.0);
    for (const auto f : mesh.vf_range(v)) normal += mesh.calc_face_normal(f);
    const double length = normal.norm();
    if (!(length > 0.0)) continue;
    const double distance = (mesh.point(v) - middle / static_cast<double>(count)).dot(normal) / length;
    if (std::isfinite(distance)) distances.push_back(std::abs(distance));
  }
  if (distances.empty()) return 0.0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

double apart_mm(const Cloud& cloud, const glm::dmat4& a, const glm::dmat4& b) {
  const glm::dmat4 between = a - b;
  double squares = 0.0;
  for (const glm::dvec3& p : cloud.points_mm) {
    const glm::dvec3 step(between * glm::dvec4(p, 1.0));
    squares += glm::dot(step, step);
  }
  return std::sqrt(squares / static_cast<double>(cloud.points_mm.size()));
}

std::vector<glm::dmat4> different_motions(const Cloud& cloud, const std::vector<glm::dmat4>& motions,
                                          std::size_t most) {
  std::vector<glm::dmat4> different;
  for (const glm::dmat4& motion : motions) {
    if (different.size() == most) break;
    if (std::none_of(different.begin(), different.end(), [&](const glm::dmat4& known) {
          return apart_mm(cloud, motion, known) < same_share() * cloud.spread_mm;
        }))
      different.push_back(motion);
  }
  return different;
}

std::vector<double> matched_shares(const Cloud& cloud, const OrientedSurface& fixed, const glm::dmat4& motion,
                                   const std::vector<double>& ladder_mm) {
  std::vector<glm::dvec3> placed(cloud.points_mm.size());
  for (std::size_t i = 0; i < placed.size(); ++i)
    placed[i] = glm::dvec3(motion * glm::dvec4(cloud.points_mm[i], 1.0));
  const std::vector<SignedFoot> feet = fixed.feet(placed);
  const glm::dmat3 turn(motion);
  std::vector<std::size_t> counts(ladder_mm.size(), 0);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (feet[i].on_border || glm::dot(turn * cloud.normals[i], feet[i].normal) < matching_cosine()) continue;
    for (std::size_t rung = 0; rung < ladder_mm.size(); ++rung)
      if (std::abs(feet[i].distance_mm) <= ladder_mm[rung]) ++counts[rung];
  }
  std::vector<double> shares;
  for (const std::size_t count : counts)
    shares.push_back(static_cast<double>(count) / static_cast<double>(placed.size()));
  return shares;
}

std::vector<double> trust_ladder_mm(double spread_mm, double noise_mm) {
  const double first = std::max(0.0025 * spread_mm, std::min(0.25 * noise_mm, 0.01 * spread_mm));
  return {first, 2.0 * first, 4.0 * first, std::max(0.02 * spread_mm, 4.0 * first)};
}

namespace {

FitTrust matched_trust(const glm::dmat4& motion, const TrustedFrom& from) {
  FitTrust trust;
  trust.noise_mm = from.noise_mm;
  trust.starts = from.start_ends.size();
  const double same_mm = same_share() * from.cloud.spread_mm;
  for (const glm::dmat4& end : from.start_ends)
    if (apart_mm(from.cloud, end, motion) < same_mm) ++trust.agreeing_starts;
  const std::vector<double> ladder_mm = trust_ladder_mm(from.cloud.spread_mm, from.noise_mm);
  const std::vector<double> own = matched_shares(from.cloud, from.fixed, motion, ladder_mm);
  trust.matched_share = own[near_rungs - 1];
  trust.tolerance_mm = ladder_mm[near_rungs - 1];
  if (from.start_ends.empty()) return trust_of_start(own, ladder_mm, trust);

  std::vector<double> rival(ladder_mm.size(), 0.0);
  for (const glm::dmat4& other : from.others) {
    if (apart_mm(from.cloud, other, motion) < same_mm) continue;
    const std::vector<double> shares = matched_shares(from.cloud, from.fixed, other, ladder_mm);
    for (std::size_t rung = 0; rung < ladder_mm.size(); ++rung)
      rival[rung] = std::max(rival[rung], shares[rung]);
    if (own[near_rungs - 1] >= equal_share() && shares[near_rungs - 1] >= equal_ratio() * own[near_rungs - 1])
      trust.equals.push_back(other);
  }
  trust.rival_share = rival[near_rungs - 1];
  // Matched shares within eight and sixteen times the first distance of the ladder. That is about two and
  // four times the noise, if the noise is 1 % to 4 % of the spread.
  const std::vector<double> wide =
      matched_shares(from.cloud, from.fixed, motion, {8.0 * ladder_mm[0], 16.0 * ladder_mm[0]});
  const auto is_scattered = [&](std::size_t rung, double below_share) {
    const double within_four_times =
        rung == 0 ? own[near_rungs - 1] : wide[std::min(rung, near_rungs - 1) - 1];
    return rung < near_rungs && own[rung] < below_share && within_four_times > most_growth() * own[rung];
  };
  const auto leads = [&](std::size_t rung) {
    const double ratio = own[rung] < small_share() ? least_small_ratio() : least_ratio();
    return !is_scattered(rung, small_share()) &&
           own[rung] >= std::max({ratio * rival[rung], rival[rung] + least_lead(), least_share()});
  };
  for (std::size_t rung = 0; rung < near_rungs; ++rung)
    if (leads(rung)) {
      trust.matched_share = own[rung];
      trust.rival_share = rival[rung];
      trust.tolerance_mm = ladder_mm[rung];
      trust.equals.clear();
      return trust;
    }
  const double less = std::min(trust.rival_share, own[near_rungs - 1]),
               more = std::max(trust.rival_share, own[near_rungs - 1]);
  const bool is_chance = (less < chance_ratio() * more && own[near_rungs - 1] < chance_share()) ||
                         is_scattered(near_rungs - 1, chance_share());
  if (!trust.equals.empty() && !is_chance) return trust;
  trust.equals.clear();
  // The share of samples that coincide: those within the smaller distance, less those between the two
  // distances. Evenly scattered samples would be equally many in both ranges.
  const double coincident_share = 2.0 * wide[0] - wide[1];
  const bool is_near = leads(ladder_mm.size() - 1) || own[near_rungs - 1] >= equal_share() ||
                       coincident_share >= least_share();
  trust.verdict = is_near ? FitVerdict::Doubtful : FitVerdict::Failed;
  trust.reason = per_cent(trust.matched_share) + " of the surface lies within " +
                 short_text(trust.tolerance_mm) + " mm of the other one, and " + per_cent(trust.rival_share) +
                 " at another motion of the search";
  return trust;
}

}  // namespace

FitTrust trust_of(const glm::dmat4& motion, const TrustedFrom& from) {
  FitTrust trust = matched_trust(motion, from);
  const double most_mm =
      std::max(most_noises() * from.noise_mm, most_residual_share() * from.cloud.spread_mm);
  if (trust.verdict != FitVerdict::Right || from.residual_mm <= most_mm) return trust;
  trust.verdict = FitVerdict::Doubtful;
  trust.reason = "the residual of the kept samples is above " + short_text(most_mm) +
                 " mm, so that parts without a counterpart may have drawn the fit aside";
  return trust;
}

}  // namespace octotomy::brep
