// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/mirror.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "brep/align/forward_axis.h"
#include "brep/align/register_surfaces.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

glm::dmat4 reflection(const MirrorPlane& plane) {
  glm::dmat4 matrix(1.0);
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) matrix[column][row] -= 2.0 * plane.normal[column] * plane.normal[row];
  const glm::dvec3 shift = 2.0 * glm::dot(plane.point_mm, plane.normal) * plane.normal;
  matrix[3] = glm::dvec4(shift, 1.0);
  return matrix;
}

/// Unit eigenvectors, of rising eigenvalue.
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

MirrorFit fit_from(const Mesh& mesh, const MirrorPlane& start, const glm::dvec3& centre,
                   const MirrorFitOptions& options) {
  SurfaceFitOptions fit_options;
  fit_options.start = glm::dmat4(1.0);
  fit_options.overlap = options.overlap;
  fit_options.stop = options.stop;
  const SurfaceFit fit = register_surfaces(mirrored(mesh, start), mesh, fit_options);
  const glm::dmat4 image_of = fit.fixed_from_moving * reflection(start);

  MirrorFit found;
  found.rms_mm = fit.rms_mm;
  found.kept_share = fit.kept_share;
  found.findings = fit.findings;
  // A reflection has -1 along its normal and 1 in the plane; a twist about the normal leaves that axis alone.
  const glm::dmat3 turn(image_of);
  found.plane.normal = axes_of(turn)[0];
  const glm::dvec3 between = glm::dvec3(image_of * glm::dvec4(centre, 1.0)) - centre;
  found.plane.point_mm = centre + 0.5 * glm::dot(between, found.plane.normal) * found.plane.normal;
  found.slide_mm = glm::length(between - glm::dot(between, found.plane.normal) * found.plane.normal);
  // An improper turn's trace is 2 cos(twist) - 1.
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
  std::optional<MirrorFit> best;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    MirrorFit fit = fit_from(mesh, starts[k], spread.centre_mm, options);
    if (!best || fit.rms_mm < best->rms_mm) best = std::move(fit);
    if (options.progress) options.progress(static_cast<double>(k + 1) / static_cast<double>(starts.size()));
  }
  return std::move(*best);
}

}  // namespace octotomy::brep
