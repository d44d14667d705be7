// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/interval_suite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <tuple>

#include "convert/surface/isosurface.h"
#include "verify/interval/two_phase.h"
#include "verify/phantom/drawn_solid.h"
#include "verify/phantom/phantom_scan.h"
#include "voxel/scan/tilt_correction.h"
#include "voxel/space/error.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::verify {
namespace {

struct SpacingName {
  glm::dvec3 mm;
  const char* name;
};
const std::array<SpacingName, 4> spacings{
    {{{1, 1, 1}, "1:1:1"}, {{1, 1, 2}, "2:1:1"}, {{1, 1, 3}, "3:1:1"}, {{1, 1, 5}, "5:1:1"}}};
constexpr std::array<const char*, 3> samplings{"shares", "blurred, noise", "tilted, noise"};

/// The error of an interval's value: relative to the truth, and as a share of the half-width. `width` is the
/// half-width relative to the truth.
struct Error {
  double relative = 0.0, share = 0.0, width = 0.0;
};
struct Errors {
  std::size_t group = 0, spacing = 0, sampling = 0;
  Error volume, area;
};

Error error_of(const Interval& found, double truth) {
  const double error = found.value - truth;
  return {
      error / truth,
      found.half_width > 0.0 ? std::abs(error) / found.half_width : std::numeric_limits<double>::infinity(),
      found.half_width / truth};
}

/// The trilinear interpolant of the samples. Beyond the outermost samples it has the nearest value.
std::function<double(const glm::dvec3&)> sampler_of(const voxel::Scene& scan) {
  const auto& samples = std::get<voxel::Int16Samples>(scan.samples);
  return [&samples, lattice = scan.lattice](const glm::dvec3& p_mm) {
    const glm::dvec3 q = lattice.voxel(p_mm), first = glm::floor(q), t = q - first;
    double value = 0.0;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 corner(i & 1, (i >> 1) & 1, i >> 2);
      const glm::dvec3 weights = glm::mix(1.0 - t, t, corner);
      const glm::ivec3 at = glm::clamp(glm::ivec3(first + corner), glm::ivec3(0), lattice.dims - 1);
      const std::size_t index =
          static_cast<std::size_t>(at.x) +
          static_cast<std::size_t>(lattice.dims.x) *
              (static_cast<std::size_t>(at.y) +
               static_cast<std::size_t>(lattice.dims.y) * static_cast<std::size_t>(at.z));
      value += weights.x * weights.y * weights.z * static_cast<double>(samples[index]);
    }
    return value;
  };
}

/// Returns the solid with slices that lean by 5 to 25 degrees in a random direction. The middle of the
/// lattice does not move.
SolidPhantom with_tilted_slices(SolidPhantom solid, Chance& chance) {
  voxel::Universe& universe = solid.universe;
  const double lean = std::tan(glm::radians(chance.between(5.0, 25.0))), towards = chance.between(0.0, 6.3);
  glm::dmat4& axes = universe.lps_from_voxel;
  axes[2] += glm::dvec4(std::cos(towards), std::sin(towards), 0.0, 0.0) * lean * axes[2].z;
  ++universe.depth;  // leaning slices need a larger universe
  axes[3] = glm::dvec4(-0.5 * (universe.side() - 1) * glm::dvec3(axes[0] + axes[1] + axes[2]), 1.0);
  return solid;
}

Errors errors_of(std::uint64_t seed, std::size_t number) {
  const std::size_t groups = measured_groups().size();
  Errors errors;
  errors.sampling = number % samplings.size();
  errors.spacing = number / samplings.size() % spacings.size();
  errors.group = number / (samplings.size() * spacings.size()) % groups;
  const std::uint64_t kind = number / (samplings.size() * spacings.size() * groups);
  Chance chance((seed << 32) + number);
  SolidPhantom solid =
      measured_solid(measured_groups()[errors.group], kind, spacings[errors.spacing].mm, chance);
  PhantomScanOptions sampling;
  sampling.near_slices_only = true;
  if (errors.sampling == 1) sampling.blur_voxels = 0.7;
  if (errors.sampling > 0) sampling.noise_share = 0.05;
  const bool is_tilted = errors.sampling == 2;
  if (is_tilted) solid = with_tilted_slices(std::move(solid), chance);
  voxel::Scene scan = phantom_scan(digitise_partial(solid), sampling, chance);
  if (is_tilted) scan = voxel::tilt_corrected(scan);
  const brep::Solid surface = brep::trusted_solid(
      convert::isosurface(scan, 0.0, std::numeric_limits<double>::infinity()), brep::Proof::Construction);
  SampledFrom from;
  from.sample_edges = glm::dmat3(scan.lattice.lps_from_voxel);
  from.blur_samples2 = blur_of(surface, from.sample_edges, sampler_of(scan));
  const SizeIntervals found = size_intervals(surface, from);
  errors.volume = error_of(found.volume_mm3, solid.volume_mm3);
  errors.area = error_of(found.area_mm2, solid.area_mm2);
  return errors;
}

IntervalCoverage coverage_of(std::vector<Error> errors) {
  IntervalCoverage found;
  found.cases = static_cast<int>(errors.size());
  const auto at = [&](double share) {
    return static_cast<std::size_t>(std::lround(share * static_cast<double>(errors.size() - 1)));
  };
  double sum = 0.0;
  for (const Error& error : errors) {
    sum += error.relative;
    found.held += error.share <= 1.0 ? 1.0 / found.cases : 0.0;
  }
  found.bias_percent = 100.0 * sum / found.cases;
  std::sort(errors.begin(), errors.end(), [](const Error& a, const Error& b) { return a.share < b.share; });
  found.p99_share = errors[at(0.99)].share;
  std::sort(errors.begin(), errors.end(),
            [](const Error& a, const Error& b) { return std::abs(a.relative) < std::abs(b.relative); });
  found.p99_error_percent = 100.0 * std::abs(errors[at(0.99)].relative);
  std::sort(errors.begin(), errors.end(), [](const Error& a, const Error& b) { return a.width < b.width; });
  found.median_width_percent = 100.0 * errors[at(0.5)].width;
  return found;
}

SizeIntervals sizes_of(const voxel::Scene& scan, double low) {
  const std::optional<TwoPhase> phases = two_phase(scan, low);
  if (phases && !phases->evidence.is_ambiguous) return {phases->volume_mm3, phases->area_mm2, {}};
  const brep::Solid surface = brep::trusted_solid(
      convert::isosurface(scan, low, std::numeric_limits<double>::infinity()), brep::Proof::Construction);
  SampledFrom from;
  from.sample_edges = glm::dmat3(scan.lattice.lps_from_voxel);
  from.sample_at_mm = glm::dvec3(scan.lattice.lps_from_voxel[3]);
  from.blur_samples2 = blur_of(surface, from.sample_edges, sampler_of(scan));
  SizeIntervals found =
      surface.empty() ? nothing_found(scan.lattice.spacing_mm()) : size_intervals(surface, from);
  if (phases) widen_to(phases->volume_mm3, found.volume_mm3);
  if (phases) widen_to(phases->area_mm2, found.area_mm2);
  return found;
}

/// Returns the errors of the intervals for one random solid.
Errors drawn_errors_of(std::uint64_t seed, std::size_t number, const MeasureSizes& measure) {
  Errors errors;
  errors.group = number % drawn_groups().size();
  Chance chance((seed << 32) + number);
  const DrawnSolid solid = drawn_solid(drawn_groups()[errors.group].name, chance);
  const DrawnScan how = drawn_scan(chance);
  const SizeIntervals found = measure(scan_of(solid, how, chance), how.half());
  errors.volume = error_of(found.volume_mm3, solid.volume_mm3);
  errors.area = error_of(found.area_mm2, solid.area_mm2);
  return errors;
}

}  // namespace

bool is_likely(const IntervalCoverage& row, double least) {
  const double missed = (1.0 - row.held) * row.cases, expected = (1.0 - least) * row.cases;
  // The probability of at least this number of misses, from the binomial distribution.
  double probability = std::pow(least, row.cases), fewer = 0.0;
  for (int i = 0; i < std::lround(missed); ++i) {
    fewer += probability;
    probability *= static_cast<double>(row.cases - i) / (i + 1) * (1.0 - least) / least;
  }
  return missed <= expected || 1.0 - fewer > 0.01;
}

std::vector<IntervalCoverage> drawn_suite(const IntervalSuiteOptions& options) {
  if (options.solids < 1) throw voxel::InvalidInput("a suite of intervals needs at least one solid");
  std::vector<Errors> all(static_cast<std::size_t>(options.solids));
  const MeasureSizes measure = options.measure ? options.measure : sizes_of;
  voxel::SharedProgress done(options.progress, all.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    done.one_more();
    all[i] = drawn_errors_of(options.seed, i, measure);
  });
  std::vector<IntervalCoverage> table;
  const auto add = [&](bool of_volume, bool is_held_back, const std::string& group) {
    std::vector<Error> errors;
    for (const Errors& one : all) {
      const DrawnGroup& its = drawn_groups()[one.group];
      if (its.is_held_back == is_held_back && (group.empty() || group == its.name))
        errors.push_back(of_volume ? one.volume : one.area);
    }
    if (errors.empty()) return;
    table.push_back(coverage_of(std::move(errors)));
    table.back().quantity = of_volume ? "volume" : "area";
    table.back().group = group;
    table.back().sampling = is_held_back ? "held back" : "calibrated";
  };
  for (const bool of_volume : {true, false}) {
    for (const bool is_held_back : {true, false}) add(of_volume, is_held_back, "");
    for (const DrawnGroup& group : drawn_groups()) add(of_volume, group.is_held_back, group.name);
  }
  return table;
}

std::vector<IntervalCoverage> interval_suite(const IntervalSuiteOptions& options) {
  if (options.solids < 1) throw voxel::InvalidInput("a suite of intervals needs at least one solid");
  std::vector<Errors> all(static_cast<std::size_t>(options.solids));
  voxel::SharedProgress done(options.progress, all.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    done.one_more();
    all[i] = errors_of(options.seed, i);
  });
  std::vector<IntervalCoverage> table;
  for (const bool of_volume : {true, false}) {
    std::map<std::tuple<std::size_t, std::size_t, std::size_t>, std::vector<Error>> cells;
    std::vector<Error> pooled;
    for (const Errors& errors : all) {
      const Error& error = of_volume ? errors.volume : errors.area;
      cells[{errors.sampling, errors.group, errors.spacing}].push_back(error);
      pooled.push_back(error);
    }
    const char* quantity = of_volume ? "volume" : "area";
    table.push_back(coverage_of(pooled));
    table.back().quantity = quantity;
    for (const auto& [cell, errors] : cells) {
      table.push_back(coverage_of(errors));
      table.back().quantity = quantity;
      table.back().sampling = samplings[std::get<0>(cell)];
      table.back().group = measured_groups()[std::get<1>(cell)];
      table.back().spacing = spacings[std::get<2>(cell)].name;
    }
  }
  return table;
}

}  // namespace octotomy::verify
