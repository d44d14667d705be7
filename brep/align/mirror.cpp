// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/mirror.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "brep/align/cloud_fit.h"
#include "brep/align/forward_axis.h"
#include "brep/align/register_surfaces.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t trial_samples = 1000;
constexpr int trial_rounds = 60;

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
  if (!(area > 0.0)) throw std::invalid_argument("fit_mirror_plane: the surface has no area");
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

/// The plane half way between points and their images under a fit from `start`.
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
  // A reflection has the eigenvalue -1 along its normal and 1 in the plane. A twist about the normal does not
  // change that axis.
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

Triangles mirrored_triangles(Triangles triangles, const MirrorPlane& plane) {
  const double length = glm::length(plane.normal);
  if (!(length > 0.0) || !std::isfinite(length))
    throw std::invalid_argument("mirrored: the plane's normal has no length");
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
  std::vector<MirrorPlane> starts;
  if (options.start)
    starts.push_back(*options.start);
  else
    for (const glm::dvec3& axis : axes_of(spread.covariance)) starts.push_back({spread.centre_mm, axis});
  SurfaceFitOptions fit_options;
  fit_options.overlap = options.overlap;
  fit_options.max_rounds = options.max_rounds;
  fit_options.rest_mm = options.rest_mm;
  fit_options.stop = options.stop;
  const OrientedSurface surface(mesh);
  // Finds the best start with few samples, then its plane with all samples.
  MirrorPlane plane = starts.front();
  if (starts.size() > 1) {
    const Cloud few = cloud_of(mesh, trial_samples, "mirrored");
    SurfaceFitOptions trial_options = fit_options;
    trial_options.max_rounds = trial_rounds;
    double least_mm = std::numeric_limits<double>::infinity();
    for (const MirrorPlane& start : starts) {
      const SurfaceFit trial =
          fit_cloud(mirrored_cloud(few, start), surface, glm::dmat4(1.0), trial_options, false);
      const double rms_mm =
          trial.kept_share < 0.5 * options.overlap ? std::numeric_limits<double>::max() : trial.rms_mm;
      if (!(rms_mm < least_mm)) continue;
      least_mm = rms_mm;
      plane = plane_of(trial, start, spread.centre_mm).plane;
    }
  }
  if (options.progress) options.progress(0.5);
  const Cloud all = cloud_of(mesh, fit_options.samples, "mirrored");
  const SurfaceFit fit = fit_cloud(mirrored_cloud(all, plane), surface, glm::dmat4(1.0), fit_options);
  if (options.progress) options.progress(1.0);
  return plane_of(fit, plane, spread.centre_mm);
}

}  // namespace octotomy::brep
