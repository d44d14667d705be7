// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Sample the closed form of a row's teeth and gum on a lattice, and move its isosurface's points onto the closed form.
// 2 Remove the parts that the lattice's box cuts, and the gum's upper edge, so that the surface is open.
// 3 Random holes, bend, noise and pose.
#include "verify/phantom/tooth_scan_phantom.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <map>
#include <mutex>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <utility>

#include "convert/surface/isosurface.h"
#include "verify/phantom/chance.h"
#include "verify/phantom/head_solids.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {
namespace {

constexpr double between_rows_mm = -59.2;  ///< z between the rows of teeth
constexpr double gum_mm = 1.2, crown_mm = 9.0, shown_mm = 11.0, tips_mm = 1.2;
constexpr double half_width_mm = 36.0, front_mm = -96.0, back_mm = -30.0;

/// The height of a point above the level between the rows; positive towards the roots of the row.
double height_mm(const glm::dvec3& p_mm, bool is_upper) {
  return is_upper ? p_mm.z - between_rows_mm : between_rows_mm - p_mm.z;
}

/// A function of position that is negative inside teeth and gum.
double form_at(const glm::dvec3& p_mm, bool is_upper) {
  const HeadBricks::Brick& brick = HeadBricks::instance().at(p_mm);
  const double teeth = value(brick.steps[HeadBricks::Teeth], p_mm);
  const double gum = std::max(value(brick.steps[HeadBricks::Bone], p_mm) - gum_mm,
                              tips_mm + crown_mm - height_mm(p_mm, is_upper));
  // A smooth minimum, which rounds the crease where the gum meets the teeth.
  constexpr double width_mm = 0.8;
  const double apart = std::max(width_mm - std::abs(teeth - gum), 0.0);
  return std::min(teeth, gum) - apart * apart / (4.0 * width_mm);
}

glm::dvec3 gradient_at(const glm::dvec3& p_mm, bool is_upper) {
  constexpr double step_mm = 1e-3;
  glm::dvec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0.0);
    step[axis] = step_mm;
    gradient[axis] = (form_at(p_mm + step, is_upper) - form_at(p_mm - step, is_upper)) / (2.0 * step_mm);
  }
  return gradient;
}

/// Returns the triangles whose corners all satisfy `keeps`, with the points that they use. `from` gets the
/// original number of each point.
template <typename Keeps>
brep::Triangles kept(const brep::Triangles& whole, const Keeps& keeps, std::vector<std::uint32_t>& from) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(whole.points_mm.size(), none);
  brep::Triangles part;
  from.clear();
  for (const auto& face : whole.faces) {
    if (!std::all_of(face.begin(), face.end(), keeps)) continue;
    auto& corners = part.faces.emplace_back(face);
    for (std::uint32_t& corner : corners) {
      std::uint32_t& n = number[corner];
      if (n == none) {
        n = static_cast<std::uint32_t>(part.points_mm.size());
        part.points_mm.push_back(whole.points_mm[corner]);
        from.push_back(corner);
      }
      corner = n;
    }
  }
  return part;
}

brep::Triangles true_row(bool is_upper, double spacing_mm) {
  const double far_z = is_upper ? between_rows_mm + shown_mm + 1.0 : between_rows_mm - shown_mm - 1.0;
  const glm::dvec3 low(-half_width_mm, front_mm, std::min(between_rows_mm, far_z)),
      high(half_width_mm, back_mm, std::max(between_rows_mm, far_z));
  const glm::ivec3 dims = glm::ivec3(glm::ceil((high - low) / spacing_mm)) + 1;
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(dims, glm::dvec3(spacing_mm), low);
  voxel::FloatSamples samples(scene.lattice.sample_count());
  tbb::parallel_for(0, dims.z, [&](int z) {
    auto next = samples.begin() + std::ptrdiff_t{z} * dims.y * dims.x;
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x)
        *next++ = static_cast<float>(-form_at(scene.lattice.lps_mm(glm::dvec3(x, y, z)), is_upper));
  });
  scene.samples = std::move(samples);
  brep::Triangles row = convert::isosurface(scene, 0.0, std::numeric_limits<double>::infinity());
  tbb::parallel_for(std::size_t{0}, row.points_mm.size(), [&](std::size_t i) {
    glm::dvec3& p = row.points_mm[i];
    for (int round = 0; round < 3; ++round) {
      const glm::dvec3 gradient = gradient_at(p, is_upper);
      const double squared = glm::dot(gradient, gradient);
      // In a crease the gradient of the closed form gives no direction to the surface.
      if (squared < 0.25) break;
      const double step_mm = form_at(p, is_upper) / std::sqrt(squared);
      p -= std::clamp(step_mm, -0.3 * spacing_mm, 0.3 * spacing_mm) * gradient / std::sqrt(squared);
    }
  });
  const double margin_mm = 2.0 * spacing_mm;
  std::vector<std::uint32_t> from;
  return kept(
      row,
      [&](std::uint32_t i) {
        const glm::dvec3& p = row.points_mm[i];
        return height_mm(p, is_upper) < shown_mm && height_mm(p, is_upper) > margin_mm &&
               std::abs(p.x) < half_width_mm - margin_mm && p.y > front_mm + margin_mm &&
               p.y < back_mm - margin_mm;
      },
      from);
}

/// Returns the surface of a row without errors. Computes it at the first call and keeps it until the program
/// ends.
const brep::Triangles& row_of(bool is_upper, double spacing_mm) {
  static std::mutex mutex;
  static std::map<std::pair<bool, double>, brep::Triangles> rows;
  const std::scoped_lock lock(mutex);
  const std::pair key{is_upper, spacing_mm};
  if (const auto found = rows.find(key); found != rows.end()) return found->second;
  return rows.emplace(key, true_row(is_upper, spacing_mm)).first->second;
}

std::vector<glm::dvec3> normals_of(const brep::Triangles& surface) {
  std::vector<glm::dvec3> normals(surface.points_mm.size(), glm::dvec3(0.0));
  for (const auto& [a, b, c] : surface.faces) {
    const glm::dvec3 n =
        glm::cross(surface.points_mm[b] - surface.points_mm[a], surface.points_mm[c] - surface.points_mm[a]);
    for (const std::uint32_t corner : {a, b, c}) normals[corner] += n;
  }
  for (glm::dvec3& n : normals) n = glm::length(n) > 0.0 ? glm::normalize(n) : glm::dvec3(0, 0, 1);
  return normals;
}

glm::dmat4 pose_by_chance(Chance& chance) {
  glm::dvec3 axis;
  do axis = {chance.even(), chance.even(), chance.even()};
  while (glm::length(axis) < 0.05 || glm::length(axis) > 0.5);
  const glm::dvec3 shift(chance.between(-80, 80), chance.between(-80, 80), chance.between(-80, 80));
  return glm::rotate(glm::translate(glm::dmat4(1.0), shift), chance.between(-3.1, 3.1), glm::normalize(axis));
}

/// The tip of the row that is nearest to a place in x and y.
glm::dvec3 tip_near(const brep::Triangles& row, const glm::dvec2& at_mm, bool is_upper) {
  double best = std::numeric_limits<double>::infinity();
  glm::dvec3 found(0.0);
  for (const glm::dvec3& p : row.points_mm) {
    const double cost = glm::distance(glm::dvec2(p), at_mm) + 2.0 * height_mm(p, is_upper);
    if (cost < best) {
      best = cost;
      found = p;
    }
  }
  return found;
}

}  // namespace

ToothScanPhantom tooth_scan_phantom(const ToothScanPhantomOptions& options) {
  if (!(options.spacing_mm > 0.0))
    throw std::invalid_argument("the spacing of a scan's points must be above 0 mm");
  const brep::Triangles& row = row_of(options.is_upper, options.spacing_mm);
  // Neighbouring seeds of Chance yield the same numbers, shifted by one place, so seeds are spread apart.
  Chance chance(options.seed * 1'000'003);
  ToothScanPhantom made;
  made.lps_from_scan = pose_by_chance(chance);
  const glm::dmat4 scan_from_lps = glm::inverse(made.lps_from_scan);
  std::vector<std::pair<glm::dvec3, double>> holes;
  for (int hole = 0; hole < options.holes; ++hole) {
    const auto at =
        static_cast<std::size_t>(chance.between(0.0, static_cast<double>(row.points_mm.size()) - 1.0));
    holes.emplace_back(row.points_mm[at], chance.between(0.7, 2.0));
  }
  const double angle = chance.between(0.0, 2.0 * glm::pi<double>());
  const auto bent = [&](const glm::dvec3& p) {
    // The arch's ends, 27 mm beside and some 40 mm behind its middle, are shifted by the whole bend.
    const double share = std::pow(std::min(std::abs(p.x) / 27.0, 1.2), 2.0);
    const double side = p.x < 0.0 ? -1.0 : 1.0;
    return p + options.bend_mm * share * glm::dvec3(side * std::cos(angle), 0.0, std::sin(angle));
  };
  const std::vector<glm::dvec3> normals = normals_of(row);
  std::vector<std::uint32_t> from;
  made.scan = kept(
      row,
      [&](std::uint32_t i) {
        return std::none_of(holes.begin(), holes.end(), [&](const auto& hole) {
          return glm::distance(row.points_mm[i], hole.first) < hole.second;
        });
      },
      from);
  made.truth_mm = made.scan.points_mm;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const glm::dvec3 p = bent(made.truth_mm[i]) + options.noise_mm * chance.normal() * normals[from[i]];
    made.scan.points_mm[i] = glm::dvec3(scan_from_lps * glm::dvec4(p, 1.0));
  }
  const double front = options.is_upper ? -82.5 : -80.5;
  for (const double x : {-24.0, -18.0, -10.0, 0.0, 10.0, 18.0, 24.0}) {
    const glm::dvec3 tip = tip_near(row, {x, front + x * x / 17.5}, options.is_upper);
    const auto by_hand = [&] {
      return options.hand_mm * glm::dvec3(chance.normal(), chance.normal(), chance.normal());
    };
    made.points_mm.push_back(tip + by_hand());
    made.scan_points_mm.push_back(glm::dvec3(scan_from_lps * glm::dvec4(bent(tip) + by_hand(), 1.0)));
  }
  return made;
}

}  // namespace octotomy::verify
