// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/mirror.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include "brep/align/cloud_fit.h"
#include "brep/align/forward_axis.h"
#include "brep/align/register_surfaces.h"
#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

/// Fits with few samples and rounds sort the starts; the best planes are then fitted with more of both.
constexpr std::size_t voting_samples = 1000, voted_count = 24, sift_samples = 150, trial_samples = 1000;
constexpr int sift_rounds = 15, trial_rounds = 60;
constexpr std::size_t tried_count = 4;

/// Trials keep only this share of the overlap. The part that is missing on one side may shift the surface's
/// centre and axes, or exceed what the stated overlap allows. The trials then still find the plane.
constexpr double trial_overlap() {
  return 0.5;
}

/// Two planes count as one if their normals differ by less than this angle in degrees and they pass the
/// centre within a twentieth of the spread.
constexpr double same_plane_deg() {
  return 10.0;
}

/// A plane fits nearly as well as the best one if its residual is at most this many times as large.
constexpr double rival_share() {
  return 1.5;
}

glm::dmat4 reflection(const MirrorPlane& plane) {
  glm::dmat4 matrix(1.0);
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) matrix[column][row] -= 2.0 * plane.normal[column] * plane.normal[row];
  const glm::dvec3 shift = 2.0 * glm::dot(plane.point_mm, plane.normal) * plane.normal;
  matrix[3] = glm::dvec4(shift, 1.0);
  return matrix;
}

/// Unit eigenvectors in order of rising eigenvalue.
std::array<glm::dvec3, 3> axes_of(const glm::dmat3& symmetric) {
  Eigen::Matrix3d matrix;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      matrix(row, column) = 0.5 * (symmetric[column][row] + symmetric[row][column]);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  std::array<glm::dvec3, 3> axes;
  for (int k = 0; k < 3; ++k)
    axes[static_cast<std::size_t>(k)] =
        forward({solver.eigenvectors()(0, k), solver.eigenvectors()(1, k), solver.eigenvectors()(2, k)});
  return axes;
}

/// A surface's centre of area and the spread of its area about it.
struct Spread {
  glm::dvec3 centre_mm{0.0};
  glm::dmat3 covariance{0.0};
};

Spread spread_of(const Triangles& surface) {
  Spread spread;
  double area = 0.0;
  const auto each = [&](const auto& visit) {
    for (const auto& face : surface.faces) {
      const glm::dvec3 &a = surface.points_mm[face[0]], &b = surface.points_mm[face[1]],
                       &c = surface.points_mm[face[2]];
      visit(0.5 * glm::length(glm::cross(b - a, c - a)), (a + b + c) / 3.0);
    }
  };
  each([&](double part, const glm::dvec3& p) {
    area += part;
    spread.centre_mm += part * p;
  });
  if (!(area > 0.0)) throw InvalidInput("fit_mirror_plane: the surface has no area");
  spread.centre_mm /= area;
  each([&](double part, const glm::dvec3& p) {
    const glm::dvec3 arm = p - spread.centre_mm;
    spread.covariance += part / area * glm::outerProduct(arm, arm);
  });
  return spread;
}

/// The mirror image of the samples, with normals that still point outward.
Cloud mirrored_cloud(Cloud cloud, const MirrorPlane& plane) {
  const glm::dmat4 image_of = reflection(plane);
  for (glm::dvec3& p : cloud.points_mm) p = glm::dvec3(image_of * glm::dvec4(p, 1.0));
  for (glm::dvec3& n : cloud.normals) n = glm::dmat3(image_of) * n;
  cloud.centre_mm = glm::dvec3(image_of * glm::dvec4(cloud.centre_mm, 1.0));
  return cloud;
}

/// The plane half way between the points and their images, from a fit that began at `start`.
MirrorFit plane_of(const SurfaceFit& fit, const MirrorPlane& start, const glm::dvec3& centre) {
  const glm::dmat4 image_of = fit.fixed_from_moving * reflection(start);
  MirrorFit found;
  found.rms_mm = fit.rms_mm;
  found.kept_share = fit.kept_share;
  found.rounds = fit.rounds;
  found.converged = fit.converged;
  found.last_step_mm = fit.last_step_mm;
  found.rest_mm = fit.rest_mm;
  found.findings = fit.findings;
  // A reflection has the eigenvalue -1 along its normal and 1 in the plane. A twist about the normal leaves
  // the eigenvector of -1 unchanged.
  const glm::dmat3 turn(image_of);
  found.plane.normal = axes_of(turn)[0];
  const glm::dvec3 between = glm::dvec3(image_of * glm::dvec4(centre, 1.0)) - centre;
  found.plane.point_mm = centre + 0.5 * glm::dot(between, found.plane.normal) * found.plane.normal;
  found.slide_mm = glm::length(between - glm::dot(between, found.plane.normal) * found.plane.normal);
  // The trace of an improper rotation is 2 cos(twist) - 1.
  const double cosine = std::clamp(0.5 * (turn[0][0] + turn[1][1] + turn[2][2] + 1.0), -1.0, 1.0);
  found.twist_deg = std::acos(cosine) * 180.0 / std::numbers::pi;
  return found;
}

/// The planes about which most pairs of samples are mirror images, by point and normal. They do not depend
/// on the surface's centre and axes: a loss on one side removes votes from the mid-plane but does not move
/// it. Pairs vote in cells of about ten degrees by a tenth of the spread. Returns the peaks, the highest
/// first.
std::vector<MirrorPlane> voted_planes(const Cloud& cloud, std::size_t count) {
  constexpr double cells_of_normal = 6.0, cell_share = 0.1, like_normals = 0.15;
  struct Votes {
    std::size_t count = 0;
    glm::dvec3 normal{0.0};
    double along_mm = 0.0;
  };
  std::map<std::array<int, 4>, Votes> cells;
  const std::size_t samples = cloud.points_mm.size();
  for (std::size_t i = 0; i < samples; ++i)
    for (std::size_t k = i + 1; k < samples; ++k) {
      const glm::dvec3 way = cloud.points_mm[i] - cloud.points_mm[k];
      const double length = glm::length(way);
      if (!(length > cell_share * cloud.spread_mm)) continue;
      const glm::dvec3 normal = forward(way / length);
      const glm::dvec3 image = cloud.normals[i] - 2.0 * glm::dot(cloud.normals[i], normal) * normal;
      if (glm::length(image - cloud.normals[k]) > like_normals) continue;
      const double along_mm =
          glm::dot(0.5 * (cloud.points_mm[i] + cloud.points_mm[k]) - cloud.centre_mm, normal);
      Votes& votes = cells[{static_cast<int>(std::lround(cells_of_normal * normal.x)),
                            static_cast<int>(std::lround(cells_of_normal * normal.y)),
                            static_cast<int>(std::lround(cells_of_normal * normal.z)),
                            static_cast<int>(std::lround(along_mm / (cell_share * cloud.spread_mm)))}];
      ++votes.count;
      votes.normal += normal;
      votes.along_mm += along_mm;
    }
  std::vector<Votes> peaks;
  peaks.reserve(cells.size());
  for (const auto& [cell, votes] : cells) peaks.push_back(votes);
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const Votes& a, const Votes& b) { return a.count > b.count; });
  std::vector<MirrorPlane> planes;
  for (const Votes& votes : peaks) {
    if (planes.size() == count) break;
    const glm::dvec3 normal = glm::normalize(votes.normal);
    const glm::dvec3 on_mm = cloud.centre_mm + votes.along_mm / static_cast<double>(votes.count) * normal;
    const bool is_known = std::any_of(planes.begin(), planes.end(), [&](const MirrorPlane& known) {
      return std::abs(glm::dot(known.normal, normal)) > 0.96 &&
             std::abs(glm::dot(on_mm - known.point_mm, known.normal)) < 2.0 * cell_share * cloud.spread_mm;
    });
    if (!is_known) planes.push_back({on_mm, normal});
  }
  return planes;
}

/// A plane with its residual, which is infinite if too little of the surface has a counterpart.
struct Tried {
  MirrorPlane plane;
  double rms_mm = 0.0;

  bool is_fit() const { return std::isfinite(rms_mm); }
};

bool are_same(const MirrorPlane& a, const MirrorPlane& b, const Spread& spread) {
  const double cosine = glm::dot(a.normal, b.normal);
  const double size_mm =
      std::sqrt(spread.covariance[0][0] + spread.covariance[1][1] + spread.covariance[2][2]);
  const double apart_mm = glm::dot(spread.centre_mm - a.point_mm, a.normal) -
                          std::copysign(1.0, cosine) * glm::dot(spread.centre_mm - b.point_mm, b.normal);
  return std::abs(cosine) > std::cos(same_plane_deg() * std::numbers::pi / 180.0) &&
         std::abs(apart_mm) < 0.05 * size_mm;
}

/// Fits from each start. Returns the different planes at which the fits end, the best first; of equally good
/// ones, that of the earlier start first.
std::vector<Tried> tried(const std::vector<MirrorPlane>& starts, const Cloud& cloud,
                         const OrientedSurface& surface, const Spread& spread, SurfaceFitOptions options,
                         int rounds) {
  options.max_rounds = rounds;
  options.overlap *= trial_overlap();
  std::vector<Tried> planes;
  for (const MirrorPlane& start : starts) {
    const SurfaceFit fit = fit_cloud(mirrored_cloud(cloud, start), surface, glm::dmat4(1.0), options, false);
    const bool is_fit = fit.kept_share >= 0.5 * options.overlap;
    planes.push_back({plane_of(fit, start, spread.centre_mm).plane,
                      is_fit ? fit.rms_mm : std::numeric_limits<double>::infinity()});
  }
  std::stable_sort(planes.begin(), planes.end(),
                   [](const Tried& a, const Tried& b) { return a.rms_mm < b.rms_mm; });
  std::vector<Tried> different;
  for (const Tried& plane : planes)
    if (std::none_of(different.begin(), different.end(),
                     [&](const Tried& known) { return are_same(known.plane, plane.plane, spread); }))
      different.push_back(plane);
  return different;
}

/// If the final residual is more than this many times that of the trials, which keep less of the surface,
/// some of its samples have no counterpart.
constexpr double far_worse() {
  return 5.0;
}

/// Reports that no tried plane fits, or that a second plane fits nearly as well.
void tell_rival(const std::vector<Tried>& planes, MirrorFit& found) {
  if (!planes.empty() && !planes[0].is_fit())
    found.findings.emplace_back(
        "WARN mid-plane: the plane is a guess, because less than a quarter of the stated overlap has a "
        "counterpart at every plane that was tried: give a plane near the right one by --plane, or a smaller "
        "--overlap");
  if (planes.size() < 2 || !planes[1].is_fit() || planes[1].rms_mm > rival_share() * planes[0].rms_mm) return;
  const glm::dvec3& n = planes[1].plane.normal;
  found.findings.push_back("WARN mid-plane: another plane, of normal (" + short_text(n.x) + ", " +
                           short_text(n.y) + ", " + short_text(n.z) +
                           "), fits nearly as well, with a residual of " + short_text(planes[1].rms_mm) +
                           " mm instead of " + short_text(planes[0].rms_mm) +
                           " mm: check the mirrored surface, or give a plane near the right one by --plane");
}

Triangles mirrored_triangles(Triangles triangles, const MirrorPlane& plane) {
  const double length = glm::length(plane.normal);
  if (!(length > 0.0) || !std::isfinite(length))
    throw InvalidInput("mirrored: the length of the plane's normal is 0 or not finite");
  const glm::dmat4 image_of = reflection({plane.point_mm, plane.normal / length});
  for (glm::dvec3& p : triangles.points_mm) p = glm::dvec3(image_of * glm::dvec4(p, 1.0));
  for (auto& face : triangles.faces) std::swap(face[1], face[2]);
  return triangles;
}

}  // namespace

Mesh mirrored(const Mesh& mesh, const MirrorPlane& plane) {
  return mesh_of(mirrored_triangles(triangles_of(mesh), plane));
}

Solid mirrored(const Solid& solid, const MirrorPlane& plane) {
  return trusted_solid(mirrored_triangles(solid.triangles(), plane), proof_of_image(solid.proof()));
}

MirrorFit fit_mirror_plane(const Mesh& mesh, const MirrorFitOptions& options) {
  const Spread spread = spread_of(triangles_of(mesh));
  SurfaceFitOptions fit_options;
  fit_options.overlap = options.overlap;
  fit_options.max_rounds = options.max_rounds;
  fit_options.rest_mm = options.rest_mm;
  fit_options.stop = options.stop;
  const OrientedSurface surface(mesh);
  std::vector<Tried> planes;
  if (!options.start) {
    std::vector<MirrorPlane> starts = voted_planes(cloud_of(mesh, voting_samples, "mirrored"), voted_count);
    for (const glm::dvec3& axis : axes_of(spread.covariance)) starts.push_back({spread.centre_mm, axis});
    planes =
        tried(starts, cloud_of(mesh, sift_samples, "mirrored"), surface, spread, fit_options, sift_rounds);
    std::vector<MirrorPlane> best;
    for (std::size_t i = 0; i < std::min(tried_count, planes.size()); ++i) best.push_back(planes[i].plane);
    planes =
        tried(best, cloud_of(mesh, trial_samples, "mirrored"), surface, spread, fit_options, trial_rounds);
  }
  const MirrorPlane plane = options.start ? *options.start : planes.front().plane;
  if (options.progress) options.progress(0.5);
  const Cloud all = cloud_of(mesh, fit_options.samples, "mirrored");
  SurfaceFit fit = fit_cloud(mirrored_cloud(all, plane), surface, glm::dmat4(1.0), fit_options);
  const bool is_narrowed = !planes.empty() && fit.rms_mm > far_worse() * planes.front().rms_mm;
  if (is_narrowed) {
    const double wide_mm = fit.rms_mm;
    fit_options.overlap *= trial_overlap();
    fit = fit_cloud(mirrored_cloud(all, plane), surface, glm::dmat4(1.0), fit_options);
    fit.findings.push_back("WARN mid-plane: at " + short_text(100.0 * options.overlap) +
                           " % overlap the residual is " + short_text(wide_mm) + " mm, so only " +
                           short_text(100.0 * fit_options.overlap) +
                           " % of the surface were fitted, with a residual of " + short_text(fit.rms_mm) +
                           " mm: give by --overlap the share that has a counterpart");
  }
  if (options.progress) options.progress(1.0);
  MirrorFit found = plane_of(fit, plane, spread.centre_mm);
  tell_rival(planes, found);
  return found;
}

}  // namespace octotomy::brep
