// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// A plane in LPS millimetres, by a point and a unit normal.
struct MirrorPlane {
  glm::dvec3 point_mm{0.0}, normal{1, 0, 0};
};

/// The mesh mirrored about a plane; its triangles still wind outward. Throws std::invalid_argument if the
/// normal has no length.
Mesh mirrored(const Mesh& mesh, const MirrorPlane& plane);
Solid mirrored(const Solid& solid, const MirrorPlane& plane);

struct MirrorFitOptions {
  /// A plane within about 20 degrees of the right one. None: tries the planes perpendicular to the surface's
  /// three axes, and the planes about which the most pairs of points are mirror images.
  std::optional<MirrorPlane> start = std::nullopt;
  /// Share of the surface's area that has a counterpart on the other side, as in SurfaceFitOptions: the
  /// missing or crooked part of one side must be less than the rest. Without a start, half of this share is
  /// used, with a finding, if the residual shows that a smaller share has a counterpart.
  double overlap = 0.7;
  int max_rounds = 100;                          ///< as in SurfaceFitOptions
  std::optional<double> rest_mm = std::nullopt;  ///< as in SurfaceFitOptions
  std::stop_token stop = {};
  std::function<void(double)> progress = {};  ///< called with 0..1
};

struct MirrorFit {
  MirrorPlane plane;    ///< its point is the plane's nearest point to the surface's centre; the largest
                        ///< component of its normal is positive
  double rms_mm = 0.0;  ///< root mean square distance of the mirrored surface's kept samples from the surface
  double kept_share = 0.0;
  /// The remaining motion that would fit the mirror image to the surface best, as rotation about the normal
  /// and shift in the plane. Both are near zero if the surface has a mid-plane.
  double twist_deg = 0.0, slide_mm = 0.0;
  int rounds = 0;                            ///< number of rounds of the last two refinements
  bool converged = false;                    ///< both refinements came to rest within max_rounds
  double last_step_mm = 0.0, rest_mm = 0.0;  ///< as in SurfaceFit
  /// Doubts about the fit. Without a start also: another plane that fits nearly as well, and the use of a
  /// smaller overlap.
  std::vector<std::string> findings;
};

/// The plane about which a surface is most nearly its own mirror image. Throws as register_surfaces(). Cost:
/// one fit of register_surfaces(); without a start, also 27 short fits with few samples and four with more.
/// Source: Benz et al., "The symmetry of faces", VMV 2002: mirror about any plane, register, and return the
/// plane half way between points and their images; starts by votes of pairs after Mitra, Guibas, Pauly,
/// "Partial and approximate symmetry detection for 3D geometry", SIGGRAPH 2006.
MirrorFit fit_mirror_plane(const Mesh& mesh, const MirrorFitOptions& options = {});

}  // namespace octotomy::brep
