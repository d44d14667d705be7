// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "brep/align/cloud_fit.h"
#include "brep/align/register_surfaces.h"
#include "brep/mesh/mesh.h"
#include "brep/mesh/oriented_surface.h"

// Judges whether a fit is the true position or only the best one that a search reached.
namespace octotomy::brep {

/// The noise of a surface's own points: the median distance of a vertex from the mean of its neighbours, along
/// its normal. Facets of curved surfaces count as noise. Zero for a surface without inner vertices.
double own_noise_mm(const Mesh& mesh);

/// Root mean square distance, in mm, between the places of a cloud's points under two motions.
double apart_mm(const Cloud& cloud, const glm::dmat4& a, const glm::dmat4& b);

/// The first `most` different motions, in their order: motions closer than a tenth of the spread to an
/// earlier one are left out.
std::vector<glm::dmat4> different_motions(const Cloud& cloud, const std::vector<glm::dmat4>& motions,
                                          std::size_t most);

/// For each distance of the ladder: the share of the samples, moved by `motion`, that lie within this
/// distance of the fixed surface and whose normals agree with it to 37 degrees.
std::vector<double> matched_shares(const Cloud& cloud, const OrientedSurface& fixed, const glm::dmat4& motion,
                                   const std::vector<double>& ladder_mm);

/// The distances within which the surfaces are compared: three, each twice the one before, and a last one of
/// at least 2 % of the spread. The first is 0.25 % of the spread or, if larger, a quarter of the surfaces'
/// noise (at most 1 % of the spread). It is not larger, because wrong fits also match within distances above
/// the noise.
std::vector<double> trust_ladder_mm(double spread_mm, double noise_mm);

/// The data from which trust_of() judges a motion.
struct TrustedFrom {
  const Cloud& cloud;
  const OrientedSurface& fixed;
  double noise_mm = 0.0;                    ///< the larger of both surfaces' own noise
  double residual_mm = 0.0;                 ///< rms distance of the samples that the fit kept
  std::vector<glm::dmat4> others = {};      ///< other motions at which a search came to rest
  std::vector<glm::dmat4> start_ends = {};  ///< where each start of the search ended; empty: a start was
                                            ///< given
};

/// Judges a motion. A right motion brings a much larger share of the surface within the noise than any other
/// motion found by the search; if the motion is wrong, the search's other ends match about the same share.
/// Motions that match equally much, each to within the noise, are equal answers of a symmetric shape. If
/// motions match little and not equally much, the motion is not right. A small match whose distances are
/// scattered evenly, instead of ending within the noise, is not right either, even if other motions match
/// less. Without a search the share alone decides, and a small one is doubtful. A residual far above the
/// noise is doubtful, too.
FitTrust trust_of(const glm::dmat4& motion, const TrustedFrom& from);

}  // namespace octotomy::brep
