// SPDX-License-Identifier: AGPL-3.0-or-later
// Closed forms of a lower leg. Each form is a function with Lipschitz constant 1, negative inside, so that a
// voxel whose value exceeds half its diagonal holds no surface.
#include "verify/phantom/leg_phantom.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <stdexcept>
#include <tbb/parallel_for.h>

#include "verify/phantom/chance.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::verify {
namespace {

constexpr int sub_samples = 4;  ///< along each edge of a voxel near a surface
const voxel::Box leg_box{{-60, -60, -150}, {60, 60, 150}};

/// At a point: a lower bound of the distance to the nearest surface of the leg, and the tissue's Hounsfield
/// value.
struct LegReading {
  double nearest_mm = 0.0;
  double hounsfield = 0.0;
};

double ball(const glm::dvec3& p_mm, const glm::dvec3& centre_mm, double radius_mm) {
  return glm::distance(p_mm, centre_mm) - radius_mm;
}

class Leg {
 public:
  explicit Leg(const HeadTissues& tissues)
      : tissues_(tissues), along_(fibula_.along()), face_(fibula_.face()) {
    third_ = glm::cross(along_, face_);
  }

  LegReading read(const glm::dvec3& p_mm) const {
    const double skin = std::hypot(p_mm.x - 8.0, p_mm.y - 10.0) - 46.0;
    const double tibia = tibia_at(p_mm),
                 tibia_canal = std::max(std::hypot(p_mm.x, p_mm.y) - 6.0, std::abs(p_mm.z) - 110.0);
    const glm::dvec3 from_axis = p_mm - fibula_.from_mm;
    const double at_mm = glm::dot(from_axis, along_), u = glm::dot(from_axis, face_),
                 v = glm::dot(from_axis, third_);
    const double shaft = shaft_at(at_mm, u, v);
    const double canal = std::max(std::hypot(u, v) - fibula_.canal_mm, beyond(at_mm));
    const double ends = std::min(ball(p_mm, fibula_.from_mm - 8.0 * along_, 13.0),
                                 ball(p_mm, fibula_.to_mm + 8.0 * along_, 12.0));
    const double fibula = std::min(shaft, ends);
    double nearest = std::abs(skin);
    for (const double each : {tibia, tibia_canal, shaft, canal, ends})
      nearest = std::min(nearest, std::abs(each));
    const bool in_bone = (fibula < 0.0 && canal > 0.0) || (tibia < 0.0 && tibia_canal > 0.0);
    return {nearest, skin > 0.0 ? tissues_.air : in_bone ? tissues_.bone : tissues_.soft};
  }

  bool in_shaft(const glm::dvec3& p_mm) const {
    const glm::dvec3 from_axis = p_mm - fibula_.from_mm;
    const double at_mm = glm::dot(from_axis, along_), u = glm::dot(from_axis, face_),
                 v = glm::dot(from_axis, third_);
    return shaft_at(at_mm, u, v) < 0.0 && std::hypot(u, v) > fibula_.canal_mm;
  }

 private:
  /// The tibia: a shaft that widens into the plateau above and the ankle below.
  static double tibia_at(const glm::dvec3& p_mm) {
    const double shaft = std::max(std::hypot(p_mm.x, p_mm.y) - 13.0, std::abs(p_mm.z) - 130.0);
    return std::min({shaft, ball(p_mm, {-2, 2, 130}, 24.0), ball(p_mm, {-2, 0, -132}, 18.0)});
  }
  double beyond(double at_mm) const { return std::max(-at_mm, at_mm - fibula_.length_mm()); }
  double shaft_at(double at_mm, double u, double v) const {
    const double ellipse = (std::hypot(u / fibula_.across_mm, v / fibula_.other_mm) - 1.0) *
                           std::min(fibula_.across_mm, fibula_.other_mm);
    return std::max(ellipse, beyond(at_mm));
  }

  HeadTissues tissues_;
  LegFibula fibula_;
  glm::dvec3 along_, face_, third_{0.0};
};

void check(const LegOptions& options) {
  if (!(options.voxel_mm >= 0.25 && options.voxel_mm <= 20.0))
    throw voxel::InvalidInput("leg phantom: voxel_mm must be from 0.25 to 20, not " +
                              voxel::rounded(options.voxel_mm));
  if (!(options.noise_sigma_hu >= 0.0) || !std::isfinite(options.noise_sigma_hu))
    throw voxel::InvalidInput("leg phantom: noise_sigma_hu must not be negative, not " +
                              voxel::rounded(options.noise_sigma_hu));
}

voxel::Lattice lattice_of(double voxel_mm) {
  const glm::dvec3 extent_mm = leg_box.high_mm - leg_box.low_mm;
  const glm::ivec3 dims(glm::ceil(extent_mm / voxel_mm - 1e-6));
  const glm::dvec3 first_mm =
      0.5 * (leg_box.low_mm + leg_box.high_mm) - 0.5 * voxel_mm * glm::dvec3(dims - 1);
  return voxel::axis_aligned_lattice(dims, glm::dvec3(voxel_mm), first_mm);
}

/// The mean Hounsfield value over a voxel; `centre_mm` is the voxel's centre.
double mean_at(const Leg& leg, const glm::dvec3& centre_mm, double voxel_mm) {
  const LegReading middle = leg.read(centre_mm);
  if (middle.nearest_mm > 0.5 * std::sqrt(3.0) * voxel_mm) return middle.hounsfield;
  double sum = 0.0;
  for (int z = 0; z < sub_samples; ++z)
    for (int y = 0; y < sub_samples; ++y)
      for (int x = 0; x < sub_samples; ++x)
        sum += leg.read(centre_mm + voxel_mm * ((glm::dvec3(x, y, z) + 0.5) / double{sub_samples} - 0.5))
                   .hounsfield;
  return sum / (sub_samples * sub_samples * sub_samples);
}

}  // namespace

glm::dvec3 LegFibula::along() const {
  return glm::normalize(to_mm - from_mm);
}

glm::dvec3 LegFibula::face() const {
  const glm::dvec3 axis = along(), left(1, 0, 0);
  return glm::normalize(left - axis * glm::dot(left, axis));
}

double LegFibula::section_mm2() const {
  return glm::pi<double>() * (across_mm * other_mm - canal_mm * canal_mm);
}

bool in_fibula_shaft(const glm::dvec3& p_mm) {
  static const Leg leg{HeadTissues()};
  return leg.in_shaft(p_mm);
}

voxel::Scene leg_phantom(const LegOptions& options, const voxel::Progress& progress) {
  check(options);
  voxel::Scene scene;
  scene.lattice = lattice_of(options.voxel_mm);
  scene.meaning = voxel::Meaning::Hounsfield;
  scene.modality = "CT";
  scene.source = "leg phantom";
  const Leg leg(options.tissues);
  const glm::ivec3 dims = scene.lattice.dims;
  voxel::FloatSamples samples(scene.lattice.sample_count());
  voxel::SharedProgress slices_done(progress, static_cast<std::size_t>(dims.z));
  tbb::parallel_for(0, dims.z, [&](int z) {
    slices_done.one_more();
    std::size_t index =
        static_cast<std::size_t>(z) * static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y);
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x)
        samples[index++] =
            static_cast<float>(mean_at(leg, scene.lattice.lps_mm({x, y, z}), options.voxel_mm));
  });
  voxel::Int16Samples rounded(samples.size());
  Chance chance(options.seed);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double noise = options.noise_sigma_hu > 0.0 ? options.noise_sigma_hu * chance.normal() : 0.0;
    constexpr double low = std::numeric_limits<std::int16_t>::min(),
                     high = std::numeric_limits<std::int16_t>::max();
    rounded[i] = static_cast<std::int16_t>(std::clamp(std::round(samples[i] + noise), low, high));
  }
  scene.samples = std::move(rounded);
  return scene;
}

}  // namespace octotomy::verify
