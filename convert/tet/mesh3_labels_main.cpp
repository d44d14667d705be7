// SPDX-License-Identifier: AGPL-3.0-or-later

// octotomy-mesh3-labels: one run of CGAL's Mesh_3 over an image of labels for mesher_process.cpp. Touching
// regions share nodes. The request's switches are LabelSizes, its hole points are start points. No step ends
// by the clock, so the answer is the same on any machine. Source: as mesh3_main.cpp; regions: Pons, Segonne,
// Boissonnat, Rineau, Yvinec, Keriven, "High-quality consistent meshing of multi-label datasets", IPMI 2007.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "convert/tet/mesh3_criteria.h"
#include "convert/tet/mesh3_exchange.h"
#include "convert/tet/mesher_child.h"

using octotomy::convert::LabelSizes;
using octotomy::convert::MesherRequest;
using octotomy::convert::read_all;
namespace convert = octotomy::convert;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

/// The eight samples about a place on a lattice, x fastest, and their trilinear weights there.
struct Eight {
  std::array<std::size_t, 8> number{};
  std::array<double, 8> share{};
};

/// Precondition: the place is within 0..count - 1 along each axis, of two samples at least.
Eight eight_about(const std::array<double, 3>& place, const std::array<std::size_t, 3>& count) {
  std::array<std::size_t, 3> low{};
  std::array<double, 3> along{};
  for (std::size_t i = 0; i < 3; ++i) {
    assert(count[i] >= 2 && place[i] >= 0.0 && place[i] <= static_cast<double>(count[i] - 1));
    low[i] = std::min(static_cast<std::size_t>(place[i]), count[i] - 2);
    along[i] = place[i] - static_cast<double>(low[i]);
  }
  Eight eight;
  for (std::size_t k = 0; k < 8; ++k) {
    eight.share[k] = 1.0;
    for (std::size_t i = 3; i-- > 0;) {
      const std::size_t step = (k >> i) & 1;
      eight.number[k] = eight.number[k] * count[i] + low[i] + step;
      eight.share[k] *= step == 1 ? along[i] : 1.0 - along[i];
    }
  }
  return eight;
}

/// An image of labels, 0 outside of all regions; voxel (0, 0, 0) has its centre in the origin.
struct Labels {
  std::array<std::size_t, 3> dims{};
  std::array<double, 3> spacing_mm{};
  std::vector<std::uint8_t> of_voxel;
  std::vector<Point> start;
  std::vector<convert::LabelPlane> planes;
  std::vector<double> size_shares;  ///< factors of sizes, at every `share_step`-th voxel
  int share_step = 1;

  /// The label with the largest trilinear share of the eight samples about a point, of equal ones the lowest.
  /// So surfaces between labels are smooth and do not follow the voxels' steps. Labels that meet in a plane
  /// count as one label when they are compared with others; then the side of the plane decides between them.
  int at(const Point& p) const {
    std::array<double, 3> place{};
    for (std::size_t i = 0; i < 3; ++i) {
      place[i] = p[static_cast<int>(i)] / spacing_mm[i];
      if (!(place[i] >= 0.0 && place[i] <= static_cast<double>(dims[i] - 1))) return 0;
    }
    const auto [number, shares] = eight_about(place, dims);
    std::array<std::uint8_t, 8> labels{};
    for (std::size_t k = 0; k < 8; ++k) labels[k] = of_voxel[number[k]];
    int best = labels[0];
    double most = -1.0;
    const std::array<std::uint8_t, 8> groups = grouped(labels);
    for (std::size_t k = 0; k < 8; ++k) {
      double sum = 0.0;
      for (std::size_t j = 0; j < 8; ++j) sum += groups[j] == groups[k] ? shares[j] : 0.0;
      if (sum > most || (sum == most && groups[k] < best)) {
        most = sum;
        best = groups[k];
      }
    }
    return planes.empty() ? best : of_group(static_cast<std::uint8_t>(best), labels, groups, p);
  }

 private:
  static bool holds(const std::array<std::uint8_t, 8>& labels, std::uint64_t label) {
    return std::find(labels.begin(), labels.end(), label) != labels.end();
  }

  /// For each label, the lowest label of its group: planes connect the labels of a group.
  std::array<std::uint8_t, 8> grouped(const std::array<std::uint8_t, 8>& labels) const {
    std::array<std::uint8_t, 8> groups = labels;
    for (const convert::LabelPlane& plane : planes) {
      if (!holds(labels, plane.low) || !holds(labels, plane.high)) continue;
      const std::uint8_t one = group_of(plane.low, labels, groups),
                         other = group_of(plane.high, labels, groups);
      std::replace(groups.begin(), groups.end(), std::max(one, other), std::min(one, other));
    }
    return groups;
  }
  static std::uint8_t group_of(std::uint64_t label, const std::array<std::uint8_t, 8>& labels,
                               const std::array<std::uint8_t, 8>& groups) {
    return groups.at(
        static_cast<std::size_t>(std::find(labels.begin(), labels.end(), label) - labels.begin()));
  }

  /// The lowest label of a group for which the point lies on the label's side of every plane between that
  /// label and another label of the group. If no label fits, the group itself.
  int of_group(std::uint8_t group, const std::array<std::uint8_t, 8>& labels,
               const std::array<std::uint8_t, 8>& groups, const Point& p) const {
    const glm::dvec3 p_mm(p.x(), p.y(), p.z());
    int found = std::numeric_limits<int>::max();
    for (std::size_t k = 0; k < 8; ++k) {
      if (groups[k] != group || labels[k] >= found) continue;
      const bool is_here = std::all_of(planes.begin(), planes.end(), [&](const convert::LabelPlane& plane) {
        if ((labels[k] != plane.low && labels[k] != plane.high) || !holds(labels, plane.low) ||
            !holds(labels, plane.high))
          return true;
        return (plane.away_mm(p_mm) < 0.0) == (labels[k] == plane.low);
      });
      if (is_here) found = labels[k];
    }
    return found == std::numeric_limits<int>::max() ? group : found;
  }
};

/// A length times the request's factor at a point, in Mesh_3's form.
struct Length {
  using FT = Kernel::FT;
  const Labels& labels;
  double length_mm = 0.0;

  template <typename Index>
  FT operator()(const Point& p, int /*dimension*/, const Index& /*index*/) const {
    return length_mm * share(p);
  }

  /// A share between the eight samples about a point, trilinear.
  double share(const Point& p) const {
    if (labels.size_shares.empty()) return 1.0;
    std::array<std::size_t, 3> count{};
    std::array<double, 3> place{};
    for (std::size_t i = 0; i < 3; ++i) {
      count[i] =
          static_cast<std::size_t>(convert::share_count(static_cast<int>(labels.dims[i]), labels.share_step));
      place[i] = std::clamp(p[static_cast<int>(i)] / (labels.spacing_mm[i] * labels.share_step), 0.0,
                            static_cast<double>(count[i] - 1));
    }
    const Eight eight = eight_about(place, count);
    double sum = 0.0;
    for (std::size_t k = 0; k < 8; ++k) sum += eight.share[k] * labels.size_shares[eight.number[k]];
    return sum;
  }
};

using Domain = convert::StartingFrom<CGAL::Labeled_mesh_domain_3<Kernel>, Point>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;

bool read(const MesherRequest& request, Labels& labels, LabelSizes& sizes) {
  if (std::sscanf(request.switches.data(), convert::label_switches, &sizes.facet_mm, &sizes.distance_mm,
                  &sizes.cell_mm, &labels.share_step) != 4 ||
      request.triangles != 0 || labels.share_step < 1)
    return false;
  // One plane for each pair of labels.
  constexpr std::uint64_t most_planes = 256 * 255 / 2;
  if (request.points > most_planes) return false;
  labels.planes.resize(request.points);
  if (!read_all(labels.planes.data(), labels.planes.size() * sizeof(convert::LabelPlane))) return false;
  std::uint64_t voxels = 1, shares = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    if (request.dims[i] < 2 || request.dims[i] > 65536) return false;
    labels.dims[i] = static_cast<std::size_t>(request.dims[i]);
    labels.spacing_mm[i] = request.spacing_mm[i];
    voxels *= static_cast<std::uint64_t>(request.dims[i]);
    shares *= static_cast<std::uint64_t>(convert::share_count(request.dims[i], labels.share_step));
  }
  if (voxels != request.labels || (request.sizes != 0 && request.sizes != shares)) return false;
  if (!convert::read_points(request.holes, labels.start)) return false;
  labels.size_shares.resize(request.sizes);
  if (!read_all(labels.size_shares.data(), labels.size_shares.size() * sizeof(double))) return false;
  labels.of_voxel.resize(voxels);
  return read_all(labels.of_voxel.data(), voxels);
}

/// A length; facets and cells with only shorter sides are not refined.
struct Least {
  double length_mm = 0.0;

  double operator()(const Point& /*p*/) const { return length_mm; }
};

Complex mesh(const Labels& labels, const LabelSizes& sizes) {
  namespace p = CGAL::parameters;
  // Surfaces are found to a hundredth of a voxel.
  constexpr double error_voxels = 0.01;
  std::array<double, 3> extent{};
  for (std::size_t i = 0; i < 3; ++i)
    extent[i] = static_cast<double>(labels.dims[i] - 1) * labels.spacing_mm[i];
  const CGAL::Bbox_3 box(0.0, 0.0, 0.0, extent[0], extent[1], extent[2]);
  const double diagonal_mm = std::hypot(extent[0], extent[1], extent[2]);
  const std::function<int(const Point&)> label = [&labels](const Point& p) { return labels.at(p); };
  const Domain domain(
      labels.start, label, box,
      CGAL::parameters::relative_error_bound = error_voxels * labels.spacing_mm[0] / diagonal_mm);
  // Half a voxel: below it, refinement would only follow the corners of voxels.
  constexpr double least_voxels = 0.5;
  const Least least{least_voxels * *std::min_element(labels.spacing_mm.begin(), labels.spacing_mm.end())};
  const convert::FacetsDownTo<Triangulation, Least> facets(
      {convert::safe_facet_angle_deg, Length{labels, sizes.facet_mm}, sizes.distance_mm}, least);
  const convert::CellsDownTo<Triangulation, Least> cells(
      {convert::safe_radius_edge, Length{labels, sizes.cell_mm}}, least);
  const convert::CriteriaDownTo<Triangulation, Least> criteria(facets, cells);
  return CGAL::make_mesh_3<Complex>(domain, criteria, p::no_perturb(), p::no_exude());
}

bool answer(const convert::MesherTask& task) {
  LabelSizes sizes;
  Labels labels;
  return read(task.request, labels, sizes) &&
         convert::write_answer(task.answer_file, mesh(labels, sizes), convert::AnswerLabels::of_each);
}

}  // namespace

int main() {
  convert::run_mesher(answer);
}
