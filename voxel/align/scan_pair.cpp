// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/align/scan_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>

namespace octotomy::voxel {
namespace {

/// Number of bins of the joint histogram for each scan: enough for bone, soft tissue, fat and air, and few
/// enough that thousands of points fill them.
constexpr int bins = 40;
/// Number of partial sums. They are added in a fixed order, so that the result does not depend on the number
/// of threads.
constexpr std::size_t parts = 32;

/// Hashes a number, so that consecutive numbers yield unrelated bits (Steele, Lea, Flood, Fast splittable
/// pseudorandom number generators, 2014).
std::uint64_t scattered(std::uint64_t n) {
  n += 0x9e3779b97f4a7c15ULL;
  n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9ULL;
  n = (n ^ (n >> 27)) * 0x94d049bb133111ebULL;
  return n ^ (n >> 31);
}

/// Converts bits to a number from -1/2 to 1/2.
double offset(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53 - 0.5;
}

struct Sums {
  std::uint64_t count = 0;
  double a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  std::vector<double> joint;  ///< joint histogram: bins * bins entries, the moving scan's bin fastest
};

double correlation(const Sums& s) {
  const auto n = static_cast<double>(s.count);
  const double spread = (s.aa - s.a * s.a / n) * (s.bb - s.b * s.b / n);
  return spread > 0.0 ? (s.ab - s.a * s.b / n) / std::sqrt(spread) : 0.0;
}

double entropy(const std::vector<double>& counts, double sum) {
  double bits = 0.0;
  for (const double count : counts)
    if (count > 0.0) bits -= count / sum * std::log2(count / sum);
  return bits;
}

/// Twice the mutual information over the sum of the entropies: the entropy correlation coefficient of Maes et al., 1997.
double shared_entropy(const Sums& s) {
  std::vector<double> of_moving(bins, 0.0), of_fixed(bins, 0.0);
  for (std::size_t j = 0; j < bins; ++j)
    for (std::size_t i = 0; i < bins; ++i) {
      of_moving[i] += s.joint[j * bins + i];
      of_fixed[j] += s.joint[j * bins + i];
    }
  const auto n = static_cast<double>(s.count);
  const double alone = entropy(of_moving, n) + entropy(of_fixed, n);
  return alone > 0.0 ? 2.0 * (alone - entropy(s.joint, n)) / alone : 0.0;
}

}  // namespace

float CoarseScan::at(const glm::dvec3& p_voxel) const {
  const glm::dvec3 floor = glm::floor(p_voxel);
  const glm::ivec3 last = dims - 1;
  // Outside the centres of the outermost blocks, their values continue to the blocks' edges.
  std::array<int, 3> first{}, next{};
  glm::vec3 part(0.0f);
  for (int k = 0; k < 3; ++k) {
    if (!(p_voxel[k] >= -0.5 && p_voxel[k] <= last[k] + 0.5)) return std::numeric_limits<float>::quiet_NaN();
    const auto i = static_cast<std::size_t>(k);
    const int low_index = static_cast<int>(floor[k]);
    first[i] = std::clamp(low_index, 0, last[k]);
    next[i] = std::clamp(low_index + 1, 0, last[k]);
    part[k] = static_cast<float>(p_voxel[k] - floor[k]);
  }
  float value = 0.0f;
  for (int corner = 0; corner < 8; ++corner) {
    const float weight = ((corner & 1) ? part.x : 1.0f - part.x) * ((corner & 2) ? part.y : 1.0f - part.y) *
                         ((corner & 4) ? part.z : 1.0f - part.z);
    if (weight == 0.0f) continue;
    value += weight * values[index((corner & 1) ? next[0] : first[0], (corner & 2) ? next[1] : first[1],
                                   (corner & 4) ? next[2] : first[2])];
  }
  return std::isnan(value) ? value : std::clamp(value, low, high);
}

CoarseScan coarse_scan(const Scene& scene, double resolution_mm) {
  CoarseScan coarse;
  const glm::ivec3 dims = scene.lattice.dims;
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  glm::ivec3 block(1);
  for (int k = 0; k < 3; ++k) {
    block[k] = std::clamp(static_cast<int>(std::lround(resolution_mm / spacing_mm[k])), 1, dims[k]);
    coarse.dims[k] = (dims[k] + block[k] - 1) / block[k];
  }
  coarse.lps_from_voxel = scene.lattice.lps_from_voxel;
  for (int k = 0; k < 3; ++k) {
    coarse.lps_from_voxel[3] += scene.lattice.lps_from_voxel[k] * (0.5 * (block[k] - 1));
    coarse.lps_from_voxel[k] *= block[k];
  }
  coarse.voxel_from_lps = glm::inverse(coarse.lps_from_voxel);
  coarse.values.assign(static_cast<std::size_t>(coarse.dims.x) * static_cast<std::size_t>(coarse.dims.y) *
                           static_cast<std::size_t>(coarse.dims.z),
                       std::numeric_limits<float>::quiet_NaN());
  std::visit(
      [&](const auto& samples) {
        tbb::parallel_for(0, coarse.dims.z, [&](int z) {
          for (int y = 0; y < coarse.dims.y; ++y)
            for (int x = 0; x < coarse.dims.x; ++x) {
              const glm::ivec3 from = glm::ivec3(x, y, z) * block, to = glm::min(from + block, dims);
              double sum = 0.0;
              int count = 0;
              for (int k = from.z; k < to.z; ++k)
                for (int j = from.y; j < to.y; ++j)
                  for (int i = from.x; i < to.x; ++i) {
                    const std::size_t at =
                        static_cast<std::size_t>(i) +
                        static_cast<std::size_t>(dims.x) *
                            (static_cast<std::size_t>(j) +
                             static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(k));
                    const auto sample = static_cast<double>(samples[at]);
                    if (scene.padding && sample == *scene.padding) continue;
                    sum += sample;
                    ++count;
                  }
              if (count > 0) coarse.values[coarse.index(x, y, z)] = static_cast<float>(sum / count);
            }
        });
      },
      scene.samples);
  std::vector<float> sorted;
  for (const float value : coarse.values)
    if (!std::isnan(value)) sorted.push_back(value);
  coarse.measured_mm3 =
      static_cast<double>(sorted.size()) * std::abs(glm::determinant(glm::dmat3(coarse.lps_from_voxel)));
  if (sorted.empty()) return coarse;
  std::sort(sorted.begin(), sorted.end());
  coarse.low = sorted[sorted.size() / 200];
  coarse.high = sorted[sorted.size() - 1 - sorted.size() / 200];
  return coarse;
}

glm::dvec3 centre_of_mass_mm(const CoarseScan& scan) {
  glm::dvec3 moment(0.0);
  double mass = 0.0;
  for (int z = 0; z < scan.dims.z; ++z)
    for (int y = 0; y < scan.dims.y; ++y)
      for (int x = 0; x < scan.dims.x; ++x) {
        const float value = scan.values[scan.index(x, y, z)];
        if (std::isnan(value)) continue;
        const double weight = std::clamp(value, scan.low, scan.high) - scan.low;
        moment += weight * glm::dvec3(x, y, z);
        mass += weight;
      }
  const glm::dvec3 middle = mass > 0.0 ? moment / mass : 0.5 * glm::dvec3(scan.dims - 1);
  return glm::dvec3(scan.lps_from_voxel * glm::dvec4(middle, 1.0));
}

ScanPair::ScanPair(const Scene& moving, const Scene& fixed, double resolution_mm, std::size_t most_points,
                   ScanLikeness by)
    : moving_(coarse_scan(moving, resolution_mm)), fixed_(coarse_scan(fixed, resolution_mm)), by_(by) {
  const std::size_t blocks = fixed_.values.size();
  const std::uint64_t one_of = std::max<std::size_t>(1, (blocks + most_points - 1) / most_points);
  for (int z = 0; z < fixed_.dims.z; ++z)
    for (int y = 0; y < fixed_.dims.y; ++y)
      for (int x = 0; x < fixed_.dims.x; ++x) {
        const std::uint64_t bits = scattered(fixed_.index(x, y, z));
        if (bits % one_of != 0) continue;
        const std::uint64_t more = scattered(bits), most = scattered(more);
        Point point;
        point.p_voxel =
            glm::vec3(glm::dvec3(x, y, z) + glm::dvec3(offset(scattered(most)), offset(more), offset(most)));
        point.value = fixed_.at(glm::dvec3(point.p_voxel));
        if (std::isnan(point.value)) continue;
        const float room = fixed_.high - fixed_.low;
        if (room > 0.0f)
          point.bin = std::min(
              bins - 1, static_cast<int>((point.value - fixed_.low) / room * static_cast<float>(bins)));
        points_.push_back(point);
      }
  if (!points_.empty()) point_mm3_ = fixed_.measured_mm3 / static_cast<double>(points_.size());
}

Likeness ScanPair::likeness(const glm::dmat4& moving_from_fixed) const {
  const glm::dmat4 moving_from_point = moving_.voxel_from_lps * moving_from_fixed * fixed_.lps_from_voxel;
  const float room = moving_.high - moving_.low;
  const float per_value = room > 0.0f ? static_cast<float>(bins - 1) / room : 0.0f;
  std::array<Sums, parts> by_part;
  tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
    Sums& s = by_part[part];
    if (by_ == ScanLikeness::MutualInformation) s.joint.assign(bins * bins, 0.0);
    for (std::size_t i = points_.size() * part / parts; i < points_.size() * (part + 1) / parts; ++i) {
      const Point& point = points_[i];
      const float value =
          moving_.at(glm::dvec3(moving_from_point * glm::dvec4(glm::dvec3(point.p_voxel), 1.0)));
      if (std::isnan(value)) continue;
      ++s.count;
      if (by_ == ScanLikeness::Correlation) {
        const double a = value - moving_.low, b = point.value - fixed_.low;
        s.a += a;
        s.b += b;
        s.aa += a * a;
        s.bb += b * b;
        s.ab += a * b;
        continue;
      }
      // A point is counted partly in each of the two nearest bins, so that the likeness is continuous.
      const float place = (value - moving_.low) * per_value;
      const int bin = std::min(bins - 2, static_cast<int>(place));
      const double beyond = place - static_cast<float>(bin);
      double* row = &s.joint[static_cast<std::size_t>(point.bin * bins + bin)];
      row[0] += 1.0 - beyond;
      row[1] += beyond;
    }
  });
  Sums sum = std::move(by_part[0]);
  for (std::size_t part = 1; part < parts; ++part) {
    const Sums& s = by_part[part];
    sum.count += s.count;
    sum.a += s.a;
    sum.b += s.b;
    sum.aa += s.aa;
    sum.bb += s.bb;
    sum.ab += s.ab;
    for (std::size_t i = 0; i < s.joint.size(); ++i) sum.joint[i] += s.joint[i];
  }
  Likeness likeness;
  const double smaller_mm3 = std::min(moving_.measured_mm3, fixed_.measured_mm3);
  if (sum.count == 0 || !(smaller_mm3 > 0.0)) return likeness;
  likeness.overlap = std::min(1.0, static_cast<double>(sum.count) * point_mm3_ / smaller_mm3);
  likeness.value = by_ == ScanLikeness::Correlation ? correlation(sum) : shared_entropy(sum);
  return likeness;
}

}  // namespace octotomy::voxel
