// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 spread samples over the moving surface; 2 without a start, refine each of a set of rotations briefly with
// few samples and keep the best; 3 refine with all samples: find their nearest points, drop samples without a
// counterpart, trim the furthest, solve for the linearised motion that moves the rest onto the tangent
// planes, until nothing moves; 4 refine again with all samples within the noise of those kept. Step 4 departs
// from trimming, to use the whole overlap. Sums run in the order of the samples.
#include "brep/align/register_surfaces.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "brep/align/cloud_fit.h"
#include "brep/align/fit_trust.h"
#include "brep/mesh/error.h"
#include "brep/mesh/move.h"
#include "brep/mesh/oriented_surface.h"
#include "brep/mesh/sample_surface.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t search_samples = 500;
constexpr int search_rounds = 12;
constexpr std::size_t finalists = 6;
constexpr int finalist_rounds = 30;
constexpr std::size_t narrowed_ends = 12;
constexpr double least_narrowed =
    0.3;  ///< the overlap is halved while it is above this share of the requested one

/// Normals with a smaller cosine between them belong to different sheets of a surface, for example of a thin
/// bone.
constexpr double least_normal_cosine() {
  return 0.5;
}

/// If no length is given, a fit is at rest when a round moves the samples by less than this share of their
/// spread: 0.1 um on a head of 100 mm. That is below what samples of a scan can determine and far above
/// rounding.
constexpr double rest_share() {
  return 1e-6;
}

/// A fit that hardly improves for this many rounds counts as at rest: samples at the trimming limit are then
/// kept and dropped in turn, and all these choices are equally good.
constexpr int cycle_rounds = 12;

/// A fit hardly improves if its rms falls by less than this share in cycle_rounds rounds.
constexpr double settled_share() {
  return 1e-4;
}

/// Modes with less than this share of the largest stiffness are left out of the step: their component would
/// be rounding divided by nearly zero. Eigenvalues of sums of about 1e4 terms are accurate to 1e-12 of the
/// largest.
constexpr double softest_share() {
  return 1e-9;
}

/// The largest distance that counts as noise, from the median distance: three standard deviations. The median
/// of normally distributed noise is 0.6745 standard deviations.
double noise_limit_mm(double median_mm) {
  return 3.0 / 0.6745 * median_mm;
}

/// Surfaces with a lower stiffness count as sliding. Below it, a millimetre of the least determined motion
/// changes distances less than a twentieth as much as a millimetre of the best determined one, so noise of
/// 0.1 mm leaves an uncertainty of 2 mm per sample. A sphere of about a thousand triangles reaches 0.02, a
/// person's face 0.35.
constexpr double sliding_stiffness() {
  return 0.05;
}

glm::dvec3 through(const glm::dmat4& motion, const glm::dvec3& p) {
  return glm::dvec3(motion * glm::dvec4(p, 1.0));
}

/// The motion that makes both clouds' centres coincide and lays the moving cloud's axes, rotated by `turn`,
/// on the fixed cloud's.
glm::dmat4 laid_on(const Cloud& moving, const Cloud& fixed, const glm::dmat3& turn) {
  const glm::dmat3 rotation = fixed.axes * turn * glm::transpose(moving.axes);
  glm::dmat4 motion(rotation);
  motion[3] = glm::dvec4(fixed.centre_mm - rotation * moving.centre_mm, 1.0);
  return motion;
}

/// The 60 rotations of an icosahedron; neighbours differ by at most 72 degrees. Multiplies a fifth of a turn
/// about a vertex and half a turn about the middle of an adjacent edge until no new rotations appear.
std::vector<glm::dmat3> icosahedral_turns() {
  const double phi = std::numbers::phi;
  const glm::dmat3 fifth(
      glm::rotate(glm::dmat4(1.0), 0.4 * std::numbers::pi, glm::normalize(glm::dvec3(0.0, 1.0, phi))));
  const glm::dmat3 half(glm::rotate(glm::dmat4(1.0), std::numbers::pi, glm::dvec3(0.0, 0.0, 1.0)));
  std::vector<glm::dmat3> turns = {glm::dmat3(1.0)};
  const auto known = [&](const glm::dmat3& turn) {
    return std::any_of(turns.begin(), turns.end(), [&](const glm::dmat3& other) {
      // These three products add up to the trace of the rotation between both: 3 if they are equal, else at
      // most 1.62, because the group's smallest rotation is 72 degrees.
      return glm::dot(turn[0], other[0]) + glm::dot(turn[1], other[1]) + glm::dot(turn[2], other[2]) > 2.5;
    });
  };
  for (std::size_t i = 0; i < turns.size(); ++i)
    for (const glm::dmat3& step : {fifth, half}) {
      const glm::dmat3 turn = step * turns[i];
      if (!known(turn)) turns.push_back(turn);
    }
  return turns;
}

/// One state of the refinement.
struct Fit {
  glm::dmat4 motion{1.0};
  double rms_mm = 0.0;                                        ///< of the samples kept
  double limit_mm = std::numeric_limits<double>::infinity();  ///< samples further away are dropped
  double score_mm = 0.0;  ///< rms of the nearest samples, a share `overlap` of all, with or without
                          ///< counterpart
  std::size_t kept = 0;
  double stiffness = 0.0;
  MotionDoubt doubt;
  int rounds = 0;
  bool converged = false;
  double last_step_mm = 0.0;  ///< root mean square displacement of the samples in the last round
  double best_mm = std::numeric_limits<double>::infinity();  ///< least rms so far of the samples kept
  glm::dmat4 best_motion{1.0};
  int since_best = 0;  ///< rounds since best_mm fell noticeably
};

/// Refines a motion, point to plane, and evaluates it: the counterparts of the samples, and which samples are
/// kept.
class Refinement {
 public:
  Refinement(const Cloud& moving, const OrientedSurface& fixed, const SurfaceFitOptions& options)
      : moving_(moving),
        fixed_(fixed),
        overlap_(options.overlap),
        rest_mm_(options.rest_mm.value_or(rest_share() * moving.spread_mm)),
        stop_(options.stop) {}

  Fit run(const glm::dmat4& start, int rounds) const {
    Fit fit;
    fit.motion = start;
    refine(fit, rounds);
    judge(fit);
    return fit;
  }

  /// Refines further with all samples within the noise of the kept ones, without a limit on their share.
  Fit widened(Fit fit, int rounds) const {
    const std::vector<Meeting> meetings = meet(fit.motion);
    std::vector<double> distances;
    for (const std::size_t i : kept(meetings, fit))
      distances.push_back(std::abs(meetings[i].foot.distance_mm));
    if (distances.empty()) return fit;
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    fit.limit_mm = std::max(noise_limit_mm(*middle), rest_share() * moving_.spread_mm);
    fit.converged = false;
    fit.best_mm = std::numeric_limits<double>::infinity();
    refine(fit, rounds);
    judge(fit);
    return fit;
  }

 private:
  void refine(Fit& fit, int rounds) const {
    for (int round = 0; round < rounds && !fit.converged; ++round, ++fit.rounds) {
      if (stop_.stop_requested()) throw Stopped("register: stopped");
      if (!step(fit)) break;
    }
  }

  struct Meeting {
    glm::dvec3 p_mm{0.0};
    SignedFoot foot;
    bool counterpart = false;
  };

  std::vector<Meeting> meet(const glm::dmat4& motion) const {
    std::vector<glm::dvec3> placed(moving_.points_mm.size());
    for (std::size_t i = 0; i < placed.size(); ++i) placed[i] = through(motion, moving_.points_mm[i]);
    const std::vector<SignedFoot> feet = fixed_.feet(placed);
    std::vector<Meeting> meetings(placed.size());
    const glm::dmat3 turn(motion);
    for (std::size_t i = 0; i < placed.size(); ++i)
      meetings[i] = {
          placed[i], feet[i],
          !feet[i].on_border && glm::dot(turn * moving_.normals[i], feet[i].normal) >= least_normal_cosine()};
    return meetings;
  }

  std::size_t wanted() const {
    return static_cast<std::size_t>(std::ceil(overlap_ * static_cast<double>(moving_.points_mm.size())));
  }

  /// The samples with a counterpart, in their order. While no distance limit is set, the farthest beyond the
  /// share `overlap` are left out.
  std::vector<std::size_t> kept(const std::vector<Meeting>& meetings, const Fit& fit) const {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < meetings.size(); ++i)
      if (meetings[i].counterpart && std::abs(meetings[i].foot.distance_mm) <= fit.limit_mm)
        order.push_back(i);
    if (fit.limit_mm == std::numeric_limits<double>::infinity() && order.size() > wanted()) {
      const auto nearer = [&](std::size_t i, std::size_t j) {
        const double a = std::abs(meetings[i].foot.distance_mm), b = std::abs(meetings[j].foot.distance_mm);
        return a != b ? a < b : i < j;
      };
      std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(wanted()), order.end(),
                       nearer);
      order.resize(wanted());
      std::sort(order.begin(), order.end());
    }
    return order;
  }

  /// Moves the fit by one linearised motion; false if too few samples have a counterpart to determine it.
  bool step(Fit& fit) const {
    const std::vector<Meeting> meetings = meet(fit.motion);
    const std::vector<std::size_t> chosen = kept(meetings, fit);
    if (chosen.size() < 6) return false;
    if (is_cycling(fit, meetings, chosen)) {
      fit.motion = fit.best_motion;
      fit.converged = true;
      return true;
    }
    const glm::dvec3 centre = through(fit.motion, moving_.centre_mm);
    Matrix6 normal = Matrix6::Zero();
    Vector6 pull = Vector6::Zero();
    for (const std::size_t i : chosen) {
      const Meeting& m = meetings[i];
      const Vector6 row = row_of(m, centre);
      normal += row * row.transpose();
      pull -= row * glm::dot(m.foot.normal, m.p_mm - m.foot.p_mm);
    }
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(normal);
    const Vector6& values = solver.eigenvalues();
    fit.stiffness = values[5] > 0.0 ? std::sqrt(std::max(0.0, values[0]) / values[5]) : 0.0;
    Vector6 motion = Vector6::Zero();
    for (int k = 0; k < 6; ++k)
      if (values[k] > softest_share() * values[5])
        motion += solver.eigenvectors().col(k) * (solver.eigenvectors().col(k).dot(pull) / values[k]);

    const glm::dvec3 turn = glm::dvec3(motion[0], motion[1], motion[2]) / moving_.spread_mm;
    const double angle = glm::length(turn);
    glm::dmat4 change = glm::translate(glm::dmat4(1.0), centre + glm::dvec3(motion[3], motion[4], motion[5]));
    if (angle > 0.0) change = glm::rotate(change, angle, turn / angle);
    fit.motion = rigid(glm::translate(change, -centre) * fit.motion);
    fit.last_step_mm = motion.norm();
    fit.converged = fit.last_step_mm <= rest_mm_;
    return true;
  }

  /// The derivative of a sample's distance by rotations about the centre (times the spread) and by shifts.
  Vector6 row_of(const Meeting& m, const glm::dvec3& centre) const {
    const glm::dvec3 lever = glm::cross(m.p_mm - centre, m.foot.normal) / moving_.spread_mm;
    Vector6 row;
    row << lever.x, lever.y, lever.z, m.foot.normal.x, m.foot.normal.y, m.foot.normal.z;
    return row;
  }

  /// The inverse of the normal equations. Motions that the samples leave undetermined get a variance of 1e12.
  MotionDoubt doubt_of(const std::vector<Meeting>& meetings, const std::vector<std::size_t>& chosen,
                       const glm::dmat4& motion) const {
    MotionDoubt doubt{through(motion, moving_.centre_mm), moving_.spread_mm};
    Matrix6 normal = Matrix6::Zero();
    for (const std::size_t i : chosen) {
      const Vector6 row = row_of(meetings[i], doubt.centre_mm);
      normal += row * row.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(normal);
    Vector6 inverse;
    for (int k = 0; k < 6; ++k) {
      const double value = solver.eigenvalues()[k];
      inverse[k] = value > softest_share() * solver.eigenvalues()[5] ? 1.0 / value : 1e12;
    }
    const Matrix6 covariance =
        solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 6; ++column)
        doubt.covariance[static_cast<std::size_t>(6 * row + column)] = covariance(row, column);
    return doubt;
  }

  /// Stores the best motion so far. Returns whether none of the last cycle_rounds rounds has improved it.
  static bool is_cycling(Fit& fit, const std::vector<Meeting>& meetings,
                         const std::vector<std::size_t>& chosen) {
    double squares = 0.0;
    for (const std::size_t i : chosen) squares += std::pow(meetings[i].foot.distance_mm, 2);
    const double rms_mm = std::sqrt(squares / static_cast<double>(chosen.size()));
    if (rms_mm < (1.0 - settled_share()) * fit.best_mm) {
      fit.since_best = 0;
    } else {
      ++fit.since_best;
    }
    if (rms_mm < fit.best_mm) {
      fit.best_mm = rms_mm;
      fit.best_motion = fit.motion;
    }
    return fit.since_best >= cycle_rounds;
  }

  /// Orthonormalises by Gram-Schmidt, so that rounding over many rounds does not add up to a shear.
  static glm::dmat4 rigid(glm::dmat4 motion) {
    const glm::dvec3 x = glm::normalize(glm::dvec3(motion[0]));
    const glm::dvec3 z = glm::normalize(glm::cross(x, glm::dvec3(motion[1])));
    motion[0] = glm::dvec4(x, 0.0);
    motion[1] = glm::dvec4(glm::cross(z, x), 0.0);
    motion[2] = glm::dvec4(z, 0.0);
    return motion;
  }

  void judge(Fit& fit) const {
    const std::vector<Meeting> meetings = meet(fit.motion);
    const std::vector<std::size_t> chosen = kept(meetings, fit);
    fit.kept = chosen.size();
    fit.doubt = doubt_of(meetings, chosen, fit.motion);
    double squares = 0.0;
    for (const std::size_t i : chosen) squares += std::pow(meetings[i].foot.distance_mm, 2);
    fit.rms_mm = chosen.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(chosen.size()));
    std::vector<double> all(meetings.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = std::pow(meetings[i].foot.distance_mm, 2);
    std::sort(all.begin(), all.end());
    all.resize(wanted());
    fit.score_mm = std::sqrt(std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size()));
    // A sheet that is fitted inside out is as near as one that is fitted correctly, but few of its normals
    // agree.
    if (fit.kept < wanted() / 2) fit.score_mm = std::numeric_limits<double>::infinity();
  }

  const Cloud& moving_;
  const OrientedSurface& fixed_;
  double overlap_;
  double rest_mm_;
  std::stop_token stop_;
};

void sort_by_score(std::vector<Fit>& fits) {
  std::stable_sort(fits.begin(), fits.end(),
                   [](const Fit& a, const Fit& b) { return a.score_mm < b.score_mm; });
}

/// The result of a search with few samples.
struct Searched {
  glm::dmat4 best{1.0};
  std::vector<glm::dmat4> ends;    ///< motion reached from each start of the search, the best first
  std::vector<glm::dmat4> others;  ///< the different ones of them after further refinement, the best first
};

std::vector<glm::dmat4> motions_of(const std::vector<Fit>& fits) {
  std::vector<glm::dmat4> motions;
  motions.reserve(fits.size());
  for (const Fit& fit : fits) motions.push_back(fit.motion);
  return motions;
}

/// Refines the present position and each rotation with few samples, and sorts the results.
Searched search(const Cloud& cloud, const Cloud& fixed, const OrientedSurface& surface,
                const SurfaceFitOptions& options) {
  const Refinement refinement(cloud, surface, options);
  std::vector<Fit> fits = {refinement.run(glm::dmat4(1.0), search_rounds)};
  const std::vector<glm::dmat3> turns = icosahedral_turns();
  for (const glm::dmat3& turn : turns) {
    fits.push_back(refinement.run(laid_on(cloud, fixed, turn), search_rounds));
    if (options.progress)
      options.progress(0.5 * static_cast<double>(fits.size()) / static_cast<double>(turns.size() + 1));
  }
  sort_by_score(fits);
  Searched searched;
  searched.ends = motions_of(fits);
  fits.resize(finalists);
  for (Fit& fit : fits) fit = refinement.run(fit.motion, finalist_rounds);
  sort_by_score(fits);
  searched.best = fits.front().motion;
  // Several finalists often end at the same motion. Therefore other, different ends are refined with as many
  // rounds.
  for (const glm::dmat4& end : different_motions(cloud, searched.ends, finalists + 1)) {
    const bool is_refined = apart_mm(cloud, end, searched.ends.front()) == 0.0;
    if (!is_refined) searched.others.push_back(refinement.run(end, finalist_rounds).motion);
  }
  for (const Fit& fit : fits) searched.others.push_back(fit.motion);
  searched.others = different_motions(cloud, searched.others, searched.others.size());
  return searched;
}

/// Refines the search's results with a smaller overlap. Returns the motions, the one that matches most first.
std::vector<glm::dmat4> narrowed(const Cloud& cloud, const Searched& searched, const OrientedSurface& surface,
                                 double noise_mm, const SurfaceFitOptions& options) {
  const std::vector<double> ladder_mm = trust_ladder_mm(cloud.spread_mm, noise_mm);
  struct Candidate {
    glm::dmat4 motion{1.0};
    double share = 0.0;
  };
  const auto sorted = [&](const std::vector<glm::dmat4>& motions, double distance_mm) {
    std::vector<Candidate> candidates;
    for (const glm::dmat4& motion : motions)
      candidates.push_back({motion, matched_shares(cloud, surface, motion, {distance_mm}).front()});
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.share > b.share; });
    std::vector<glm::dmat4> order;
    for (const Candidate& candidate : candidates) order.push_back(candidate.motion);
    return order;
  };
  const Refinement refinement(cloud, surface, options);
  std::vector<glm::dmat4> again;
  // Ends of short refinements are a few hundredths of the spread away from where longer ones would come to
  // rest.
  const std::vector<glm::dmat4> ends = sorted(searched.ends, 2.0 * ladder_mm.back());
  for (const glm::dmat4& end : different_motions(cloud, ends, narrowed_ends))
    again.push_back(refinement.widened(refinement.run(end, finalist_rounds), finalist_rounds).motion);
  return sorted(again, ladder_mm[1]);
}

void check(const SurfaceFitOptions& options) {
  const auto refuse = [](const std::string& why) { throw InvalidInput("register: " + why); };
  if (!(options.overlap > 0.0 && options.overlap <= 1.0)) refuse("the overlap must be above 0 and at most 1");
  if (options.samples < 100) refuse("at least 100 samples are needed");
  if (options.max_rounds < 1) refuse("there must be at least one round");
  if (options.rest_mm && !(*options.rest_mm > 0.0)) refuse("the length at rest must be above 0 mm");
  if (options.overlap * static_cast<double>(search_samples) < 6.0)
    refuse("the overlap keeps fewer than six samples: place landmarks instead");
}

/// The standard deviation of a linear function of the motion.
double deviation_of(const std::array<double, 36>& covariance, const std::array<double, 6>& row) {
  double variance = 0.0;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) variance += row[i] * covariance[6 * i + j] * row[j];
  return std::sqrt(std::max(variance, 0.0));
}

}  // namespace

double MotionDoubt::deviation(const glm::dvec3& p_mm, const glm::dvec3& along) const {
  const glm::dvec3 lever = glm::cross(p_mm - centre_mm, along) / spread_mm;
  return deviation_of(covariance, {lever.x, lever.y, lever.z, along.x, along.y, along.z});
}

double MotionDoubt::turn_deviation(const glm::dvec3& axis) const {
  return deviation_of(covariance, {axis.x, axis.y, axis.z, 0.0, 0.0, 0.0}) / spread_mm;
}

/// `count` samples, each of which represents the same area.
Cloud cloud_of(const Mesh& mesh, std::size_t count, const std::string& which) {
  double area = 0.0;
  for (const auto f : mesh.faces()) area += mesh.calc_face_area(f);
  if (!(area > 0.0)) throw InvalidInput("register: the " + which + " surface has no area");
  const Triangles triangles = triangles_of(mesh);
  const auto wanted = static_cast<double>(count);
  const SurfaceSamples samples =
      sample_surface(triangles, widened_spacing_mm(triangles, std::sqrt(2.0 * area / wanted), 64.0 * wanted));
  Cloud cloud;
  const double whole = std::accumulate(samples.areas_mm2.begin(), samples.areas_mm2.end(), 0.0);
  const double each = whole / static_cast<double>(count);
  double passed = 0.0;
  for (std::size_t i = 0; i < samples.points_mm.size(); ++i) {
    passed += samples.areas_mm2[i];
    if (passed <= (static_cast<double>(cloud.points_mm.size()) + 0.5) * each) continue;
    cloud.points_mm.push_back(samples.points_mm[i]);
    cloud.normals.push_back(samples.normals[i]);
  }
  const auto n = static_cast<double>(cloud.points_mm.size());
  for (const glm::dvec3& p : cloud.points_mm) cloud.centre_mm += p / n;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const glm::dvec3& p : cloud.points_mm) {
    const Eigen::Vector3d d(p.x - cloud.centre_mm.x, p.y - cloud.centre_mm.y, p.z - cloud.centre_mm.z);
    moments += d * d.transpose() / n;
  }
  cloud.spread_mm = std::sqrt(moments.trace());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d axis = solver.eigenvectors().col(2 - k);
    cloud.axes[k] = {axis[0], axis[1], axis[2]};
  }
  cloud.axes[2] = glm::cross(cloud.axes[0], cloud.axes[1]);
  return cloud;
}

SurfaceFit fit_cloud(const Cloud& cloud, const OrientedSurface& fixed, const glm::dmat4& start,
                     const SurfaceFitOptions& options, bool widens) {
  check(options);
  const Refinement refinement(cloud, fixed, options);
  Fit fit = refinement.run(start, options.max_rounds);
  if (widens) fit = refinement.widened(fit, options.max_rounds);
  SurfaceFit answer;
  answer.fixed_from_moving = fit.motion;
  answer.rms_mm = fit.rms_mm;
  answer.kept_share = static_cast<double>(fit.kept) / static_cast<double>(cloud.points_mm.size());
  answer.rounds = fit.rounds;
  answer.converged = fit.converged;
  answer.last_step_mm = fit.last_step_mm;
  answer.rest_mm = options.rest_mm.value_or(rest_share() * cloud.spread_mm);
  answer.stiffness = fit.stiffness;
  answer.doubt = fit.doubt;
  if (!fit.converged)
    answer.findings.push_back("the motion still moved by " + short_text(fit.last_step_mm) +
                              " mm a round after " + std::to_string(fit.rounds) +
                              " rounds: start nearer, by landmarks, or allow more rounds by --rounds");
  if (fit.stiffness < sliding_stiffness())
    answer.findings.emplace_back(
        "the surfaces can slide on each other, as spheres and planes can, so a part of the motion is "
        "undetermined: add landmarks");
  if (answer.kept_share < 0.9 * options.overlap)
    answer.findings.push_back("only " + short_text(100.0 * answer.kept_share) +
                              " % of the surface found a counterpart, less than the requested overlap");
  return answer;
}

namespace {

/// Adds findings that state the verdict on a fit.
void tell_trust(SurfaceFit& fit) {
  const FitTrust& trust = *fit.trust;
  // Surfaces that slide on each other have a finding already.
  if (!trust.equals.empty() && fit.stiffness >= sliding_stiffness())
    fit.findings.push_back(
        "WARN registration: " + std::to_string(trust.equals.size()) +
        (trust.equals.size() == 1 ? " other motion matches" : " other motions match") +
        " as much of the surface, within " + short_text(trust.tolerance_mm) +
        " mm: the shape is symmetric, so the choice among the answers is a guess; give --landmarks");
  if (trust.verdict == FitVerdict::Right) return;
  const std::string figures = trust.reason + "; the residual is " + short_text(fit.rms_mm) +
                              " mm, the surfaces' own noise " + short_text(trust.noise_mm) + " mm";
  if (trust.verdict == FitVerdict::Failed)
    fit.findings.push_back("FAIL registration: no position was found at which the surfaces match: " +
                           figures + ": give --landmarks, or keep only the parts that both surfaces show");
  else
    fit.findings.push_back("WARN registration: the position is doubtful: " + figures +
                           ": look at the result, or give --landmarks");
}

}  // namespace

SurfaceFit register_surfaces(const Mesh& moving, const Mesh& fixed, const SurfaceFitOptions& options) {
  check(options);
  const Cloud cloud = cloud_of(moving, options.samples, "moving");
  const Cloud fixed_cloud = cloud_of(fixed, options.samples, "fixed");
  const OrientedSurface surface(fixed);
  const double noise_mm = std::max(own_noise_mm(moving), own_noise_mm(fixed));
  SurfaceFit answer;
  if (options.start) {
    answer = fit_cloud(cloud, surface, *options.start, options);
    answer.trust = trust_of(answer.fixed_from_moving, {cloud, surface, noise_mm, answer.rms_mm});
  } else {
    const Cloud few = cloud_of(moving, search_samples, "moving");
    const Searched searched = search(few, fixed_cloud, surface, options);
    answer = fit_cloud(cloud, surface, searched.best, options);
    answer.trust = trust_of(answer.fixed_from_moving,
                            {cloud, surface, noise_mm, answer.rms_mm, searched.others, searched.ends});
    SurfaceFitOptions less = options;
    while (answer.trust->verdict != FitVerdict::Right && less.overlap > least_narrowed * options.overlap) {
      less.overlap *= 0.5;
      if (less.overlap * static_cast<double>(search_samples) < 6.0) break;
      const std::vector<glm::dmat4> again = narrowed(few, searched, surface, noise_mm, less);
      SurfaceFit fit = fit_cloud(cloud, surface, again.front(), less);
      fit.trust =
          trust_of(fit.fixed_from_moving, {cloud, surface, noise_mm, fit.rms_mm, again, searched.ends});
      if (fit.trust->verdict >= answer.trust->verdict) continue;
      answer = std::move(fit);
      answer.findings.push_back(
          "WARN overlap: at " + short_text(100.0 * options.overlap) +
          " % overlap no position was certain, so that " + short_text(100.0 * less.overlap) +
          " % were fitted: give the share that both surfaces have in common by --overlap");
    }
  }
  tell_trust(answer);
  if (options.progress) options.progress(1.0);
  return answer;
}

}  // namespace octotomy::brep
