// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Random heads. The warp from a head to the phantom works axis by axis, so that its inverse is a closed form:
//   z' = height(z);  y' = back(y - forward(z));  x' = (x - mid(z)) * width(z) * side(sign).
// All lengths of a head are drawn: the heights of its thirds, how far its jaws stand before the skull, its
// width by height, and, where crooked, how far its middle leaves the plane and how one side differs.
#include "tests/planner/operation/landmark/random_head.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "verify/phantom/head_solids.h"

namespace octotomy::tests {

using verify::Chance;
using verify::HeadBricks;

namespace {

/// Canonical heights between which a face is stretched: neck, chin, bite, nasal spine, orbit, brow, crown.
constexpr std::array<double, 7> heights_mm{-140.0, -104.0, -59.0, -31.0, 5.0, 30.0, 112.0};
/// Crowns of teeth, canonical heights.
constexpr double upper_crown_mm = -46.5, bite_mm = -59.2, lower_crown_mm = -69.8;

glm::dmat4 turned_about(const glm::dvec3& centre_mm, double degrees, const glm::dvec3& axis) {
  return glm::translate(glm::dmat4(1.0), centre_mm) *
         glm::rotate(glm::dmat4(1.0), glm::radians(degrees), axis) *
         glm::translate(glm::dmat4(1.0), -centre_mm);
}

bool happens(Chance& chance, double share) {
  return chance.between(0.0, 1.0) < share;
}

}  // namespace

const char* name_of(HeadKind kind) {
  constexpr std::array<const char*, head_kind_count> names{
      "plain",   "tilted", "toothless", "couch", "marker", "thick slices",
      "crooked", "masked", "defect",    "metal", "noisy",  "everything"};
  return names[static_cast<std::size_t>(kind)];
}

double Knots::operator()(double at) const {
  const auto next = std::clamp<std::ptrdiff_t>(std::upper_bound(from.begin(), from.end(), at) - from.begin(),
                                               1, static_cast<std::ptrdiff_t>(from.size()) - 1);
  const auto i = static_cast<std::size_t>(next);
  return to[i - 1] + (at - from[i - 1]) * (to[i] - to[i - 1]) / (from[i] - from[i - 1]);
}

double Knots::inverse(double value) const {
  return Knots{to, from}(value);
}

RandomHead::RandomHead(HeadKind kind, std::uint64_t seed) : seed_(seed) {
  Chance chance(seed * head_kind_count + static_cast<std::uint64_t>(kind));
  const bool is_all = kind == HeadKind::Everything;
  draw_proportions(chance, kind == HeadKind::Crooked || (is_all && happens(chance, 0.5)));
  const bool is_tilted = kind == HeadKind::Tilted || (is_all && happens(chance, 0.6));
  const double most_deg = is_tilted ? 20.0 : 5.0;
  const glm::dvec3 centre_mm(0, 0, 0);
  for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}})
    lps_from_head_ =
        turned_about(centre_mm, chance.between(-most_deg, most_deg) * (axis.x > 0.0 ? 1.0 : 0.7), axis) *
        lps_from_head_;
  lps_from_head_ = glm::translate(glm::dmat4(1.0), {chance.between(-15, 15), chance.between(-15, 15),
                                                    chance.between(-300, 300)}) *
                   lps_from_head_;
  bone_hu_ = chance.between(520.0, 1100.0);
  tooth_hu_ = chance.between(1500.0, 2600.0);
  voxel_mm_ = chance.between(0.8, 1.6);
  slice_mm_ = voxel_mm_ * chance.between(0.8, 1.2);
  blur_mm_ = chance.between(0.2, 0.6);
  noise_hu_ = chance.between(3.0, 20.0);
  below_mm_ = chance.between(4.0, 20.0);
  draw_things(chance, kind);
  for (const auto& other : {HeadKind::Toothless, HeadKind::Couch, HeadKind::Marker, HeadKind::Masked})
    if (is_all && happens(chance, 0.5)) draw_things(chance, other);
  find_truths();
}

void RandomHead::draw_proportions(Chance& chance, bool is_crooked) {
  const double all = chance.between(0.88, 1.1);
  std::vector<double> at(heights_mm.size());
  const std::vector<double> canonical(heights_mm.begin(), heights_mm.end());
  const std::size_t fixed = 4;
  at[fixed] = canonical[fixed];
  for (std::size_t i = fixed + 1; i < at.size(); ++i)
    at[i] = at[i - 1] + (canonical[i] - canonical[i - 1]) * all * chance.between(0.9, 1.1);
  for (std::size_t i = fixed; i-- > 0;)
    at[i] = at[i + 1] - (canonical[i + 1] - canonical[i]) * all * chance.between(0.88, 1.14);
  height_ = {at, canonical};
  const double front = all * chance.between(0.92, 1.08), back = all * chance.between(0.92, 1.08);
  back_ = {{-130.0 * front, 0.0, 130.0 * back}, {-130.0, 0.0, 130.0}};
  const double broad = all * chance.between(0.92, 1.08);
  std::vector<double> widths, shifts, middles;
  const double aside = is_crooked ? chance.between(-7.0, 7.0) : chance.between(-0.7, 0.7);
  // The jaws stand forward or back and, of the crooked, aside; the brain case does not.
  constexpr std::array<double, 7> moved{1.0, 1.0, 0.7, 0.4, 0.0, 0.0, 0.0};
  const double jaws = chance.between(-5.0, 5.0);
  for (std::size_t i = 0; i < at.size(); ++i) {
    widths.push_back(1.0 / (broad * chance.between(0.96, 1.04)));
    shifts.push_back(jaws * moved[i] + chance.between(-1.5, 1.5));
    middles.push_back(aside * moved[i]);
  }
  width_ = {at, widths};
  forward_ = {at, shifts};
  mid_ = {at, middles};
  if (is_crooked) side_ = {chance.between(0.93, 1.07), chance.between(0.93, 1.07)};
}

void RandomHead::draw_things(Chance& chance, HeadKind kind) {
  const auto beside = [&](double most) { return chance.between(-most, most); };
  switch (kind) {
    case HeadKind::Toothless: {
      const double which = chance.between(0.0, 3.0);
      has_upper_teeth_ = which < 1.0;
      has_lower_teeth_ = which >= 1.0 && which < 2.0;
      break;
    }
    case HeadKind::Couch:
      couch_ = {0.0,
                chance.between(15, 60),
                chance.between(1.5, 4.0),
                chance.between(150, 260),
                happens(chance, 0.5) ? chance.between(0, 40) : 0.0,
                chance.between(100, 1200),
                chance.between(-950, -700)};
      break;
    case HeadKind::Marker: {
      // Before the nose's tip, whose skin is at some -117; a ball or a wire across or along.
      const glm::dvec3 at = head_mm({beside(8), -119.0 - chance.between(4, 22), chance.between(-70, 20)});
      const double length = happens(chance, 0.5) ? chance.between(5, 40) : 0.0;
      const glm::dvec3 along = happens(chance, 0.5) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
      things_.push_back({at - 0.5 * length * along, at + 0.5 * length * along, chance.between(1.0, 3.5),
                         chance.between(800, 3000)});
      break;
    }
    case HeadKind::Masked:
      mask_mm_ = chance.between(1.5, 2.8);
      mask_hu_ = chance.between(-100, 250);
      for (const glm::dvec3& at :
           {glm::dvec3(0, -122, -20), {0, -104, 45}, {-78, -35, -10}, {78, -35, -10}}) {
        const glm::dvec3 p = head_mm(at + glm::dvec3{beside(3), 0.0, beside(8)});
        things_.push_back({p, p, chance.between(1.0, 2.5), chance.between(800, 3000)});
      }
      break;
    case HeadKind::Defect: {
      constexpr std::array<glm::dvec3, 7> places{
          glm::dvec3(36, -80, -9), {62, -35, -12}, {14, -80, -30}, {30, -75, 45},
          {0, -84, -92},           {48, -18, -70}, {0, -82, -42}};
      const auto which = static_cast<std::size_t>(chance.between(0.0, 6.999));
      const double side = happens(chance, 0.5) ? 1.0 : -1.0;
      defects_.push_back({places[which] * glm::dvec3(side, 1, 1), chance.between(9, 16)});
      break;
    }
    case HeadKind::Metal: {
      const double out = chance.between(15, 26) * (happens(chance, 0.5) ? 1.0 : -1.0);
      metal_ = {{out, -82.5 + out * out / 17.5, -53.0}, chance.between(3.0, 4.5)};
      break;
    }
    case HeadKind::ThickSlices:
      slice_mm_ = chance.between(2.0, 3.0);
      break;
    case HeadKind::Noisy:
      blur_mm_ = chance.between(0.6, 1.1);
      noise_hu_ = chance.between(25.0, 60.0);
      break;
    default:
      break;
  }
}

glm::dvec3 RandomHead::canonical_mm(const glm::dvec3& p) const {
  const double x = (p.x - mid_(p.z)) * width_(p.z);
  return {x * side_[x > 0.0 ? 1 : 0], back_(p.y - forward_(p.z)), height_(p.z)};
}

glm::dvec3 RandomHead::head_mm(const glm::dvec3& q) const {
  const double z = height_.inverse(q.z);
  return {q.x / side_[q.x > 0.0 ? 1 : 0] / width_(z) + mid_(z), back_.inverse(q.y) + forward_(z), z};
}

bool RandomHead::was_removed(const glm::dvec3& q, bool is_tooth) const {
  if (is_tooth && !has_upper_teeth_ && q.z < upper_crown_mm && q.z > bite_mm) return true;
  if (is_tooth && !has_lower_teeth_ && q.z < bite_mm && q.z > lower_crown_mm) return true;
  return std::any_of(defects_.begin(), defects_.end(),
                     [&](const Ball& ball) { return glm::distance(q, ball.centre_mm) < ball.radius_mm; });
}

bool RandomHead::is_bone(const glm::dvec3& p) const {
  const glm::dvec3 q = canonical_mm(p);
  const HeadBricks::Brick& brick = HeadBricks::instance().at(q);
  const auto holds = [&](HeadBricks::Field field) {
    return brick.places[field] >= 0 ? brick.places[field] == 1 : value(brick.steps[field], q) < 0.0;
  };
  return holds(HeadBricks::Bone) && !was_removed(q, holds(HeadBricks::Teeth));
}

}  // namespace octotomy::tests
