// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>

#include "verify/interval/size_interval.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Volume and area of a solid of one density in surroundings of another density. They are computed from all
// samples near the solid and not from the surface of a threshold. Blur redistributes the values of samples
// but keeps their sum, so walls thinner than the blur count in full. phase_size.cpp has the derivations.
namespace octotomy::verify {

/// Deviations of the Gaussian blurs that are added to the scan, in samples.
inline constexpr std::array<double, 4> added_blur{0.0, 0.6, 1.0, 1.6};

/// Measurements of a scan of two densities. A share is a sample's difference from the background, divided by
/// the contrast.
struct PhaseEvidence {
  double background = 0.0, contrast = 0.0;  ///< in sample units; their sum is the solid's density
  double noise = 0.0;                       ///< standard deviation, in sample units
  double correlation = 1.0;                 ///< deviation of a sum of samples, divided by that of white noise
  /// Thin walls that blur lowers and a thick solid of a lower density both explain the samples. The measures
  /// are then possible, but not certain.
  bool is_ambiguous = false;
  bool has_third = false;   ///< samples of a third density, away from the solid, count as surroundings
  bool has_core = false;    ///< the contrast was measured; otherwise it follows from the bound `low`
  double least_seen = 0.0;  ///< the least share that differs from noise
  double highest = 0.0;     ///< the highest share after a blur of one sample
  double sum = 0.0;         ///< sum of the shares: the volume in samples
  std::size_t band = 0;     ///< number of samples near the solid that are not deep in it
  double tail = 0.0;        ///< sum of shares of the samples just beyond the band
  std::array<double, 4> squares{};    ///< sum of squared shares at each added_blur
  double counted_mm3 = 0.0;           ///< volume of the samples over the half level, without added blur
  std::array<double, 4> level_mm2{};  ///< area of the half level at each added_blur
};

struct TwoPhase {
  Interval volume_mm3, area_mm2;
  PhaseEvidence evidence;
};

/// Measures the solid whose half level is `low`, in sample units. None if the solid and its surroundings do
/// not have two densities: samples near it differ by more than noise; samples deep in it are not as far above
/// `low` as the background is below; or nothing rises above noise. Also none if the solid touches the scan's
/// border or a third density, if the scan's axes are not perpendicular, if parts of the scan were not
/// measured (Scene::padding), or if the scan has fewer than eight samples along an axis or more than 2^27 in
/// all. Away from the solid the scan may have other densities, provided that the solid reaches `low`. Throws
/// voxel::Stopped. Parallel; same bits on any thread count. Memory: five times four bytes a sample. Cost:
/// three blurs of the scan, and six where the first attempt with two densities fails. A scan of many
/// densities is rejected after one pass over its samples.
std::optional<TwoPhase> two_phase(const voxel::Scene& scan, double low, const voxel::Progress& progress = {});

/// Widens the interval of a surface, by a source "faint", until it contains an ambiguous interval.
void widen_to(const Interval& ambiguous, Interval& by_surface);

}  // namespace octotomy::verify
