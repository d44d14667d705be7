// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/smooth.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

/// Taubin's inward step: the largest at which no wave (eigenvalues 0..2 of the umbrella operator) changes
/// sign.
constexpr double step_in() {
  return 0.5;
}

/// The outward step that leaves waves at `pass_band` unchanged: 1 / step_in + 1 / step_out = pass_band.
double step_out(double pass_band) {
  return 1.0 / (pass_band - 1.0 / step_in());
}

void check(const SmoothOptions& options) {
  const auto refuse = [](const std::string& why) { throw InvalidInput("smooth: " + why); };
  if (options.rounds < 1) refuse("there must be at least one round");
  if (!(options.pass_band > 0.0 && options.pass_band < 1.0)) refuse("the pass band must be between 0 and 1");
  if (!(options.max_volume_share > 0.0)) refuse("the share of volume that may change must be positive");
}

/// The volume to which `max_volume_share` refers: a closed mesh's own volume; for an open mesh, which has
/// none, the volume of a ball with the mesh's area.
double volume_for_share_mm3(const Mesh& mesh, double volume_mm3) {
  bool is_open = false;
  for (const auto halfedge : mesh.halfedges()) is_open = is_open || mesh.is_boundary(halfedge);
  if (!is_open) return std::abs(volume_mm3);
  const double radius_mm = std::sqrt(size_of(triangles_of(mesh)).area_mm2 / (4.0 * std::numbers::pi));
  return 4.0 / 3.0 * std::numbers::pi * radius_mm * radius_mm * radius_mm;
}

/// Moves every vertex by a share of the way to its neighbours' mean, computed from the positions before this
/// step.
void step(Mesh& mesh, double share, std::vector<Mesh::Point>& before) {
  before.resize(mesh.n_vertices());
  for (const auto vertex : mesh.vertices())
    before[static_cast<std::size_t>(vertex.idx())] = mesh.point(vertex);
  for (const auto vertex : mesh.vertices()) {
    Mesh::Point sum(0.0, 0.0, 0.0);
    double count = 0.0;
    for (auto beside = mesh.cvv_begin(vertex); beside != mesh.cvv_end(vertex); ++beside, count += 1.0)
      sum += before[static_cast<std::size_t>(beside->idx())];
    if (count == 0.0 || mesh.is_boundary(vertex)) continue;
    const Mesh::Point& here = before[static_cast<std::size_t>(vertex.idx())];
    mesh.set_point(vertex, here + (sum / count - here) * share);
  }
}

}  // namespace

Mesh smooth(const Mesh& mesh, const SmoothOptions& options) {
  check(options);
  Mesh smoothed = mesh;
  std::vector<Mesh::Point> before;
  for (int round = 0; round < options.rounds; ++round) {
    step(smoothed, step_in(), before);
    step(smoothed, step_out(options.pass_band), before);
  }
  const double volume = volume_mm3(mesh), now = volume_mm3(smoothed);
  if (!(std::abs(now - volume) <= options.max_volume_share * volume_for_share_mm3(mesh, volume)))
    throw Error(ErrorCode::Geometry, "smooth: the volume went from " + std::to_string(volume) + " to " +
                                         std::to_string(now) +
                                         " mm3, more than the allowed share: use fewer rounds or a "
                                         "wider pass band, or allow a larger share");
  return smoothed;
}

}  // namespace octotomy::brep
