// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Compares an octree with a solid of another lineage, as a metrologist would: what is the largest difference
// that two right answers may show? With h the edge of the universe's voxels, s that of the scan's samples, S
// the mesh's area off the planes below and M its total absolute mean curvature at the scale of three samples
// (see smooth_curvature_mm):
//
// digitisation   The voxels of a curved or oblique boundary err independently, S / h^2 of them by a fraction
//                of h^3 each: k h^2 sqrt(S). Spheres, lenses and oblique cuts gave a root mean square k of
//                0.20 to 0.32; coverage 3 on the larger (0.96) lies above the worst seen, 0.83.
// flat           A plane whose normal n is a vector of small integers in voxels errs coherently: its centres
//                lie on lattice planes h / |n| apart. Where it lies is known from the mesh, and so is the
//                place half-way between lattice planes that sampling at centres moves it to: displacements
//                are summed with their sign.
// flat_unsure    Of the same kind, without sign: a plane through centres may go either way (h / 2 |n|), a cut
//                that was declared and is not seen may lie anywhere (h / 2), and an isosurface chamfers the
//                rim of a flat over the width of a sample, which then is not seen as flat.
// chord          A polyhedron with its vertices on a surface of mean curvature H lies within it by a^2 H / 4
//                in the mean for edges a (equilateral: mean of rho^2 - d^2 over twice the radius), and the
//                half level of samples that are means over a cuboid lies within it by s^2 H / 12. Marching
//                cubes has a^2 of about s^2 / 2, so the sum is near s^2 H / 5. The same product bounds what
//                is lost at sharp edges and thin rims, which M counts by their angle: a right-angled edge may
//                lose s^2 / 6 per length and is allowed s^2 pi / 16. c = 0.25.
// rounding       Coordinates are good to a few units in the last place.
//
// The symmetric difference counts what cancels in the volume. The octree samples the trilinear interpolant,
// the mesh is linear along the lattice's edges: between saturated samples of an oblique plane they lie apart
// by a part of s that does not fall with curvature. On spheres 0.020 to 0.022 s in the mean, on oblique
// planes up to 0.055: 0.06 s S is allowed. To it come c s^2 M, a layer of voxels where a plane goes through
// centres, and three standard deviations of the count of voxels in those layers. The centroid moves by the
// moment of each error of the volume over the volume.
//
// Hausdorff distances: centres of the octree's boundary faces to the triangles, and the mesh's vertices to
// the boundary faces; each weighted by its area (a third of the triangles around a vertex). The 95th
// percentile is the smallest distance that at least 95 % of that area does not exceed; of the two directions
// the larger is given.

#include "verify/certificate.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "brep/distance.h"
#include "brep/measure.h"
#include "brep/triangles.h"
#include "convert/voxelise.h"
#include "verify/voxel_boundary.h"
#include "voxel/combine.h"
#include "voxel/measure.h"

namespace octotomy::verify {
namespace {

constexpr double digitisation_rms = 0.32;
constexpr double coverage = 3.0;
constexpr double chord = 0.25;
constexpr double interpolation = 0.06;
/// A difference up to so many tolerances is doubtful, beyond it wrong: a normal error of three standard
/// deviations that is met six deviations off is no accident.
constexpr double doubt = 2.0;
/// Fewer voxels across and the boundary's voxels are most of the object.
constexpr double resolved_voxels = 6.0;
/// A surface so many times further away than digitisation explains has no counterpart. What is thinner than a
/// voxel may be lost in one of them for two or three voxels, so this is a doubt and not a failure.
constexpr double lost = 3.0;

/// A sum of weights times displacements, and of those times place: an error of volume and its first moment.
struct Moments {
  double volume = 0.0;
  glm::dvec3 moment{0.0};  // about the mesh's centroid
  void add(double mm3, const glm::dvec3& arm_mm) {
    volume += mm3;
    moment += mm3 * arm_mm;
  }
};

/// What the mesh shows of itself beyond brep::measure.
struct Shape {
  Moments flat;                    // signed, by digitisation at centres
  double unsure_mm3 = 0.0;         // either sign: planes through centres, chamfers
  double unsure_mm4 = 0.0;         // the same times its arm
  double tied_mm3 = 0.0;           // of which planes through centres
  glm::dvec3 flat_mm2{0.0};        // area along the universe's own planes
  double coherent_mm2 = 0.0;       // area of all planes of small integers
  double second_moment_mm4 = 0.0;  // of the area about the centroid
  double curvature_mm = 0.0;       // smooth_curvature_mm
};

double longest(const glm::dvec3& edges_mm) {
  return std::max({edges_mm.x, edges_mm.y, edges_mm.z});
}

struct Triangle {
  std::array<glm::dvec3, 3> p;
  glm::dvec3 centre() const { return (p[0] + p[1] + p[2]) / 3.0; }
  glm::dvec3 area_vector() const { return 0.5 * glm::cross(p[1] - p[0], p[2] - p[0]); }
};

/// A plane n . q = c of index space q whose normal has small integers.
struct LatticePlane {
  glm::ivec3 normal{0};
  double offset = 0.0;
};

/// A plane counts as one of the lattice's where its points leave it by less than this, in voxels: a thousand
/// times what coordinates of a universe of 4096 voxels round to.
constexpr double flatness_voxels = 1000.0 * 4096.0 * std::numeric_limits<double>::epsilon();
/// Integers up to here: a plane of a larger normal errs by less than h / 8 in each voxel, and no longer all
/// in step.
constexpr int largest_index = 3;

std::optional<LatticePlane> lattice_plane(const std::array<glm::dvec3, 3>& q) {
  const glm::dvec3 across = glm::cross(q[1] - q[0], q[2] - q[0]);
  const double largest = std::max({std::abs(across.x), std::abs(across.y), std::abs(across.z)});
  if (!(largest > 0.0)) return std::nullopt;
  for (int index = 1; index <= largest_index; ++index) {
    const glm::dvec3 normal = glm::round(across * (index / largest));
    const std::array<double, 3> c{glm::dot(normal, q[0]), glm::dot(normal, q[1]), glm::dot(normal, q[2])};
    const auto [low, high] = std::minmax({c[0], c[1], c[2]});
    if (high - low < flatness_voxels * index) return LatticePlane{glm::ivec3(normal), 0.5 * (low + high)};
  }
  return std::nullopt;
}

/// Half the sum over edges of length times angle, as brep::measure has it, but with the angles' sign within
/// cells of three samples' edge and per direction of the normal, and without it from cell to cell. Marching
/// cubes' triangles alternate about the surface, which makes the unsigned sum grow as samples get finer; the
/// two sides of a thin plate must not cancel.
double smooth_curvature_mm(const brep::Mesh& mesh, double cell_mm) {
  std::vector<std::pair<std::array<int, 4>, double>> parts;
  for (const auto edge : mesh.edges()) {
    if (mesh.is_boundary(edge)) continue;
    const auto side = mesh.halfedge_handle(edge, 0);
    const auto a = mesh.point(mesh.from_vertex_handle(side)), b = mesh.point(mesh.to_vertex_handle(side));
    const auto normal = mesh.calc_face_normal(mesh.face_handle(side)) +
                        mesh.calc_face_normal(mesh.opposite_face_handle(side));
    int direction = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (std::abs(normal[axis]) > std::abs(normal[direction])) direction = axis;
    std::array<int, 4> cell{0, 0, 0, normal[direction] < 0.0 ? direction : direction + 3};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<unsigned>(axis);
      cell[axis] = static_cast<int>(std::floor(0.5 * (a[i] + b[i]) / cell_mm));
    }
    const double angle = mesh.calc_dihedral_angle(edge);
    if (std::isfinite(angle)) parts.emplace_back(cell, 0.5 * (b - a).norm() * angle);
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& x, const auto& y) { return x.first < y.first; });
  double total = 0.0, cell_sum = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    cell_sum += parts[i].second;
    if (i + 1 < parts.size() && parts[i + 1].first == parts[i].first) continue;
    total += std::abs(cell_sum);
    cell_sum = 0.0;
  }
  return total;
}

Shape shape_of(const brep::Mesh& mesh, const voxel::Lattice& lattice, const glm::dvec3& about_mm,
               double sample_mm) {
  Shape shape;
  const glm::dmat3 lps_from_voxel(lattice.lps_from_voxel);
  // Moves of one in n . q are moves of 1 / |n'| millimetres, n' the normal in LPS.
  const glm::dmat3 normal_from_voxel = glm::transpose(glm::inverse(lps_from_voxel));
  const brep::Triangles triangles = brep::triangles_of(mesh);
  // Displacement of each face in millimetres outward, where it is part of a lattice plane.
  std::vector<std::optional<double>> moved(triangles.faces.size());
  for (std::size_t face = 0; face < triangles.faces.size(); ++face) {
    Triangle triangle;
    std::array<glm::dvec3, 3> q;
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.p[i] = triangles.points_mm[triangles.faces[face][i]];
      q[i] = lattice.voxel(triangle.p[i]);
    }
    const double area_mm2 = glm::length(triangle.area_vector());
    const glm::dvec3 arm_mm = triangle.centre() - about_mm;
    shape.second_moment_mm4 += area_mm2 * glm::dot(arm_mm, arm_mm);
    const std::optional<LatticePlane> plane = lattice_plane(q);
    if (!plane) continue;
    const glm::dvec3 normal = normal_from_voxel * glm::dvec3(plane->normal);
    const glm::ivec3 index = glm::abs(plane->normal);
    shape.coherent_mm2 += area_mm2;
    if (index.x + index.y + index.z == 1) shape.flat_mm2 += area_mm2 * glm::dvec3(index);
    // Centres have whole n . q, so the digitised plane lies half-way between two of them.
    const double shift = std::floor(plane->offset) + 0.5 - plane->offset;
    const double outward = glm::dot(triangle.area_vector(), normal) < 0.0 ? -1.0 : 1.0;
    moved[face] = outward * shift / glm::length(normal);
    if (0.5 - std::abs(shift) < flatness_voxels * largest_index) {
      const double mm3 = 0.5 / glm::length(normal) * area_mm2;
      shape.tied_mm3 += mm3;
      shape.unsure_mm3 += mm3;
      shape.unsure_mm4 += mm3 * glm::length(arm_mm);
    } else {
      shape.flat.add(*moved[face] * area_mm2, arm_mm);
    }
  }
  for (const auto edge : mesh.edges()) {
    if (mesh.is_boundary(edge)) continue;
    const auto side = mesh.halfedge_handle(edge, 0);
    const auto& a = moved[static_cast<std::size_t>(mesh.face_handle(side).idx())];
    const auto& b = moved[static_cast<std::size_t>(mesh.opposite_face_handle(side).idx())];
    if (a.has_value() == b.has_value()) continue;
    const auto from = mesh.point(mesh.from_vertex_handle(side)), to = mesh.point(mesh.to_vertex_handle(side));
    const glm::dvec3 arm_mm = glm::dvec3(from[0] + to[0], from[1] + to[1], from[2] + to[2]) * 0.5 - about_mm;
    const double mm3 = std::abs(a ? *a : *b) * (to - from).norm() * sample_mm;
    shape.unsure_mm3 += mm3;
    shape.unsure_mm4 += mm3 * glm::length(arm_mm);
  }
  shape.curvature_mm = smooth_curvature_mm(mesh, 3.0 * sample_mm);
  return shape;
}

/// Distances with the area that each stands for.
struct Weighted {
  std::vector<double> distances_mm, areas_mm2;

  double largest() const {
    return distances_mm.empty() ? 0.0 : *std::max_element(distances_mm.begin(), distances_mm.end());
  }
  double percentile95() const {
    std::vector<std::size_t> order(distances_mm.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return distances_mm[a] < distances_mm[b]; });
    const double total = std::accumulate(areas_mm2.begin(), areas_mm2.end(), 0.0);
    double reached = 0.0;
    for (const std::size_t i : order) {
      reached += areas_mm2[i];
      if (reached >= 0.95 * total) return distances_mm[i];
    }
    return largest();
  }
};

/// The boundary faces as two triangles each, and their centres.
struct Boundary {
  brep::Triangles triangles;
  std::vector<glm::dvec3> centres_mm;
  std::vector<double> areas_mm2;
};

Boundary boundary_of(const voxel::Octree& octree) {
  const voxel::Lattice lattice = octree.universe().lattice();
  Boundary boundary;
  for (const VoxelFace& face : voxel_boundary(octree)) {
    const int u = (face.axis + 1) % 3, v = (face.axis + 2) % 3;
    glm::dvec3 centre(face.voxel);
    centre[face.axis] += 0.5 * face.side;
    const auto first = static_cast<std::uint32_t>(boundary.triangles.points_mm.size());
    for (const glm::dvec2& corner : {glm::dvec2(-0.5, -0.5), {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      glm::dvec3 p = centre;
      p[u] += corner.x;
      p[v] += corner.y;
      boundary.triangles.points_mm.push_back(lattice.lps_mm(p));
    }
    boundary.triangles.faces.push_back({first, first + 1, first + 2});
    boundary.triangles.faces.push_back({first, first + 2, first + 3});
    boundary.centres_mm.push_back(lattice.lps_mm(centre));
    boundary.areas_mm2.push_back(glm::length(
        glm::cross(glm::dvec3(lattice.lps_from_voxel[u]), glm::dvec3(lattice.lps_from_voxel[v]))));
  }
  return boundary;
}

/// Both directions: voxel faces to triangles, vertices to voxel faces.
std::array<Weighted, 2> surface_distances(const voxel::Octree& octree, const brep::Mesh& mesh) {
  const Boundary boundary = boundary_of(octree);
  const brep::Triangles triangles = brep::triangles_of(mesh);
  Weighted from_voxels{brep::SurfaceTree(triangles).distances_mm(boundary.centres_mm), boundary.areas_mm2};
  Weighted from_mesh{brep::SurfaceTree(boundary.triangles).distances_mm(triangles.points_mm),
                     std::vector<double>(triangles.points_mm.size(), 0.0)};
  for (const auto& face : triangles.faces) {
    const Triangle triangle{
        {triangles.points_mm[face[0]], triangles.points_mm[face[1]], triangles.points_mm[face[2]]}};
    for (const std::uint32_t corner : face)
      from_mesh.areas_mm2[corner] += glm::length(triangle.area_vector()) / 3.0;
  }
  return {std::move(from_voxels), std::move(from_mesh)};
}

/// The tolerances, from the mesh, the universe's voxels and the scan's samples.
void derive_tolerances(Certificate& certificate, const brep::Measures& mesh, const Shape& shape,
                       const voxel::Lattice& lattice, const BoundInputs& inputs) {
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  const double h = longest(spacing_mm);
  const double s = longest(inputs.scan_spacing_mm);
  const double unseen_mm3 =
      glm::dot(glm::max(inputs.flat_cut_mm2 - shape.flat_mm2, glm::dvec3(0.0)), 0.5 * spacing_mm);
  const double free_mm2 = std::max(mesh.area_mm2 - shape.coherent_mm2, 0.0);
  const double reach_mm = glm::length(glm::max(glm::abs(mesh.low_mm), glm::abs(mesh.high_mm)));
  const double digitisation = coverage * digitisation_rms * h * h * std::sqrt(free_mm2);
  const double chordal = chord * s * s * shape.curvature_mm;
  // Each coordinate is off by half a unit in the last place, some operations each.
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * reach_mm * mesh.area_mm2;
  certificate.terms = {
      {"digitisation", "3 * 0.32 h^2 sqrt(S)", digitisation},
      {"flat", "|sum of area * displacement to the nearest voxel face|", std::abs(shape.flat.volume)},
      {"flat_unsure", "h/2 * area of planes through voxel centres or not seen, and rims",
       shape.unsure_mm3 + unseen_mm3},
      {"chord", "0.25 s^2 M", chordal},
      {"rounding", "16 eps |p| S", rounding}};
  certificate.tolerance_mm3 = 0.0;
  for (const ToleranceTerm& term : certificate.terms) certificate.tolerance_mm3 += term.value_mm3;

  const double voxel_mm3 = lattice.voxel_mm3();
  const double apart = interpolation * s * free_mm2;
  const double layer = apart + chordal + 2.0 * (shape.tied_mm3 + unseen_mm3) + rounding;
  certificate.symmetric_difference_tolerance_mm3 =
      layer + coverage * std::sqrt(layer * voxel_mm3) + voxel_mm3;

  if (mesh.volume_mm3 > 0.0 && mesh.area_mm2 > 0.0) {
    const double arm_mm = std::sqrt(shape.second_moment_mm4 / mesh.area_mm2);
    const double moment = (digitisation + chordal + rounding + unseen_mm3) * arm_mm +
                          glm::length(shape.flat.moment) + shape.unsure_mm4;
    certificate.centroid_tolerance_mm = moment / mesh.volume_mm3;
  }
}

void judge(Certificate& certificate, const voxel::Measures& voxels, const brep::Measures& mesh,
           const voxel::Lattice& lattice, const BoundInputs& inputs) {
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  if (mesh.volume_mm3 < 0.0)
    lower(certificate, Agreement::Fail, "the mesh is turned inside out: its volume is negative");
  if ((voxels.voxel_count == 0) != (mesh.area_mm2 == 0.0))
    lower(certificate, Agreement::Fail,
          voxels.voxel_count == 0 ? "the octree is empty, the mesh is not"
                                  : "the mesh is empty, the octree is not");
  add_comparison(certificate,
                 {"volume", "mm3", voxels.volume_mm3, mesh.volume_mm3, std::abs(certificate.difference_mm3),
                  certificate.tolerance_mm3, "sum of the terms"});
  add_comparison(certificate, {"symmetric difference",
                               "mm3",
                               {},
                               {},
                               certificate.symmetric_difference_mm3,
                               certificate.symmetric_difference_tolerance_mm3,
                               "layers of voxels that may differ"});
  if (certificate.centroid_distance_mm && certificate.centroid_tolerance_mm)
    add_comparison(certificate, {"centroid",
                                 "mm",
                                 {},
                                 {},
                                 *certificate.centroid_distance_mm,
                                 certificate.centroid_tolerance_mm,
                                 "first moment of the terms / volume"});
  // A right boundary face has its centre within half a voxel's diagonal of the surface that was digitised,
  // and that one lies within a cell of samples of the other's.
  const double near_mm = 0.5 * glm::length(spacing_mm) + 0.5 * glm::length(inputs.scan_spacing_mm);
  if (certificate.hausdorff95_mm)
    add_comparison(certificate, {"hausdorff95",
                                 "mm",
                                 {},
                                 {},
                                 *certificate.hausdorff95_mm,
                                 near_mm,
                                 "half a voxel's and half a sample cell's diagonal"});
  if (certificate.hausdorff_mm && *certificate.hausdorff_mm > lost * near_mm) {
    lower(certificate, Agreement::Warn,
          "a part of one surface is " + std::to_string(*certificate.hausdorff_mm) +
              " mm from the other: it may be missing there");
  }

  double extent_voxels = std::numeric_limits<double>::infinity();
  const auto shorten = [&](const glm::dvec3& extent_mm) {
    for (int axis = 0; axis < 3; ++axis)
      extent_voxels = std::min(extent_voxels, extent_mm[axis] / spacing_mm[axis]);
  };
  if (voxels.extents) shorten(voxels.extents->high_mm - voxels.extents->low_mm);
  if (mesh.area_mm2 > 0.0) shorten(mesh.high_mm - mesh.low_mm);
  // Twice the volume over the area is a sheet's thickness. Of one thinner than a voxel, chance decides which
  // voxels are inside, if any. Both kernels must say that it is thin.
  const double larger_mm3 = std::max(std::abs(mesh.volume_mm3), voxels.volume_mm3);
  if (mesh.area_mm2 > 0.0 && 2.0 * larger_mm3 < longest(spacing_mm) * mesh.area_mm2) {
    certificate.agreement = Agreement::BelowResolution;
    certificate.reasons.emplace_back("it is " + std::to_string(2.0 * larger_mm3 / mesh.area_mm2) +
                                     " mm thick on average, less than a voxel");
  }
  if (extent_voxels < resolved_voxels) {
    certificate.agreement = Agreement::BelowResolution;
    certificate.reasons.emplace_back("the smallest extent is " + std::to_string(extent_voxels) +
                                     " voxels; six are needed for agreement to prove anything");
  }
}

}  // namespace

void add_comparison(Certificate& certificate, Comparison comparison) {
  // Written so that a difference that is no number fails.
  const auto within = [&](double allowed) { return comparison.difference <= allowed; };
  if (comparison.tolerance && !within(*comparison.tolerance)) {
    comparison.agreement = within(doubt * *comparison.tolerance) ? Agreement::Warn : Agreement::Fail;
    char text[200];
    std::snprintf(text, sizeof text, "%s differs by %.6g %s where theory allows %.6g",
                  comparison.quantity.c_str(), comparison.difference, comparison.unit.c_str(),
                  *comparison.tolerance);
    lower(certificate, comparison.agreement, text);
  }
  certificate.comparisons.push_back(std::move(comparison));
}

void lower(Certificate& certificate, Agreement agreement, const std::string& reason) {
  certificate.agreement = std::max(certificate.agreement, agreement);
  certificate.reasons.push_back(reason);
}

Certificate certify_bounded(const voxel::Octree& octree, const brep::Mesh& solid, const BoundInputs& inputs) {
  const auto start = std::chrono::steady_clock::now();
  const voxel::Lattice lattice = octree.universe().lattice();
  const voxel::Measures voxels = voxel::measure(octree);
  const brep::Measures mesh = brep::measure(solid);
  Certificate certificate;
  certificate.operation = inputs.operation;
  certificate.tier = Tier::Bounded;
  certificate.voxel = {inputs.voxel_lineage, voxels.volume_mm3, voxels.area_crofton13_mm2,
                       voxels.centroid_mm};
  certificate.mesh = {inputs.mesh_lineage, mesh.volume_mm3, mesh.area_mm2, mesh.centroid_mm};
  certificate.difference_mm3 = voxels.volume_mm3 - mesh.volume_mm3;

  const glm::dvec3 about_mm = mesh.centroid_mm.value_or(0.5 * (mesh.low_mm + mesh.high_mm));
  derive_tolerances(certificate, mesh, shape_of(solid, lattice, about_mm, longest(inputs.scan_spacing_mm)),
                    lattice, inputs);
  const voxel::Octree digitised = convert::voxelise(octree.universe(), solid);
  const voxel::Octree either =
      voxel::combine(octree.universe(), voxel::Expression(octree) ^ voxel::Expression(digitised));
  certificate.symmetric_difference_mm3 = static_cast<double>(either.voxel_count()) * lattice.voxel_mm3();
  if (voxels.centroid_mm && mesh.centroid_mm)
    certificate.centroid_distance_mm = glm::length(*voxels.centroid_mm - *mesh.centroid_mm);
  if (!octree.is_empty() && mesh.area_mm2 > 0.0) {
    const auto [from_voxels, from_mesh] = surface_distances(octree, solid);
    certificate.hausdorff_mm = std::max(from_voxels.largest(), from_mesh.largest());
    certificate.hausdorff95_mm = std::max(from_voxels.percentile95(), from_mesh.percentile95());
  }
  judge(certificate, voxels, mesh, lattice, inputs);
  certificate.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return certificate;
}

std::string to_string(Tier tier) {
  switch (tier) {
    case Tier::Exact:
      return "exact";
    case Tier::Bounded:
      return "bounded";
    case Tier::ClosedForm:
      return "closed_form";
  }
  return {};
}

std::string to_string(Agreement agreement) {
  switch (agreement) {
    case Agreement::Pass:
      return "PASS";
    case Agreement::Warn:
      return "WARN";
    case Agreement::Fail:
      return "FAIL";
    case Agreement::BelowResolution:
      return "BELOW_RESOLUTION";
  }
  return {};
}

}  // namespace octotomy::verify
