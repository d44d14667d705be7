// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>

#include "verify/interval/size_interval.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// The size of a solid of one density in surroundings of another, from all samples near it and not from a
// threshold's surface: blur moves samples' values about and keeps their sum, so that walls thinner than the
// blur count whole. The source has the derivations.
namespace octotomy::verify {

/// Deviations of the blurs that are added to the samples, in samples.
inline constexpr std::array<double, 4> added_blur{0.0, 0.6, 1.0, 1.6};

/// What a scan of two densities shows, in samples and shares of the contrast.
struct PhaseEvidence {
  double background = 0.0, contrast = 0.0;  ///< in sample units; the solid has their sum
  double noise = 0.0;                       ///< deviation, in sample units
  double correlation = 1.0;  ///< of the noise: by how much a sum's deviation exceeds white noise's
  /// Thin walls that blur lowers and a thick solid of a lower density both explain the samples: the numbers
  /// are what could be there, not what is.
  bool is_ambiguous = false;
  bool has_third = false;  ///< samples of a third density, away from the solid, were taken for surroundings
  bool has_core = false;   ///< the contrast was measured; else the window's bound is taken for the half level
  double least_seen = 0.0;            ///< share of the contrast that is told from noise
  double highest = 0.0;               ///< the highest share, after a blur of one sample
  double sum = 0.0;                   ///< of shares: the volume in samples
  std::size_t band = 0;               ///< samples near the solid that are not deep in it
  double tail = 0.0;                  ///< sum of shares just beyond
  std::array<double, 4> squares{};    ///< sum of squared shares at added_blur
  double counted_mm3 = 0.0;           ///< of samples over the half level
  std::array<double, 4> level_mm2{};  ///< area of the half level at the same
};

struct TwoPhase {
  Interval volume_mm3, area_mm2;
  PhaseEvidence evidence;
};

/// The solid whose half level is `low`. None where the solid and what is about it are not of two densities:
/// samples near it differ by more than noise, those deep in it are not as far above `low` as the background
/// is below, nothing rises above noise, the solid meets the scan's border or a third density, the
/// scan's axes are not at right angles, or parts of it were not measured (Scene::padding). Where the solid
/// reaches `low`, the scan may have other densities away from it. Throws voxel::Stopped. Parallel; same bits
/// on any thread count. Memory: four bytes a sample, five times. Cost: three blurs of the scan, and six where
/// the first reading of it as two densities fails; a scan of many densities is left after one look at its
/// samples.
std::optional<TwoPhase> two_phase(const voxel::Scene& scan, double low, const voxel::Progress& progress = {});

/// Widens a surface's interval to hold the whole of an ambiguous one, by a source "faint".
void widen_to(const Interval& ambiguous, Interval& by_surface);

}  // namespace octotomy::verify
