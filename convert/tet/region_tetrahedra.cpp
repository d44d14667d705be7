// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/region_tetrahedra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <tuple>

#include "convert/tet/element_faces.h"
#include "convert/tet/flat_interfaces.h"
#include "convert/tet/improve_tetrahedra.h"
#include "convert/tet/mesher_process.h"
#include "convert/tet/tetrahedralise.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"
#include "voxel/tree/slice_bits.h"
#include "voxel/tree/slice_build.h"

// 1 The regions' voxels become an image of labels: their box and a voxel all round.
//   An interface that is flat within the voxels' resolution counts as a plane, and the side of the plane
//   decides between its regions.
// 2 Mesh_3 starts from the middles between voxels of different labels, a size apart, so that it misses no
//   region and no part of one, and from rims, where three labels meet, because it would otherwise put the
//   rims half a voxel off. Denser start points would lie on the voxels' steps, where refinement for good
//   angles never ends.
// 3 The nodes are moved to the patient's frame. Where regions meet in a plane, the nodes along its rim, where
//   three labels meet, are put on it, because surfaces in contact that are not flat interlock. Then nodes
//   move to mend flat elements. Where that leaves nodes off the plane, elements are split at it.
// 4 The answer counts only if all volumes are positive and each region's volume is near its voxels' volume.

namespace octotomy::convert {
namespace {

[[noreturn]] void refuse_regions(const std::string& why) {
  throw voxel::InvalidInput("smooth_tetrahedra_of: " + why);
}

using voxel::rounded;

void check(const std::vector<voxel::Octree>& regions, const RegionMeshOptions& options) {
  if (regions.empty()) refuse_regions("there is no region");
  if (regions.size() > std::numeric_limits<std::uint8_t>::max())
    refuse_regions("there are more than 255 regions");
  for (const voxel::Octree& region : regions) {
    if (region.is_empty()) refuse_regions("a region is empty");
    if (!(region.universe() == regions.front().universe()))
      refuse_regions("regions are of different universes: evaluate them in one");
  }
  if (!(options.size_mm > 0.0) || !std::isfinite(options.size_mm))
    refuse_regions("the size must be positive");
  if (!(options.min_dihedral_deg >= 0.0 && options.min_dihedral_deg <= 30.0))
    refuse_regions("the smallest dihedral angle to reach must be 0 to 30 degrees");
}

/// Calls f(voxel, how many along x) for each run of a region's voxels.
template <typename F>
void for_each_run(const voxel::Octree& region, const F& f) {
  voxel::for_each_slice(region, [&](int z, const voxel::SliceBits& slice) {
    for (int y = 0; y < slice.side; ++y)
      for (int first = 0, last = -1; voxel::next_run(slice, y, last + 1, first, last);)
        f(glm::ivec3(first, y, z), last - first + 1);
  });
}

/// Pass 1.
struct Labelled {
  LabelImage image;
  glm::ivec3 first_voxel{0};  ///< voxel of the universe at the image's (0, 0, 0)

  std::size_t number(const glm::ivec3& v) const {
    return (static_cast<std::size_t>(v.z) * static_cast<std::size_t>(image.dims.y) +
            static_cast<std::size_t>(v.y)) *
               static_cast<std::size_t>(image.dims.x) +
           static_cast<std::size_t>(v.x);
  }
};

Labelled labelled(const std::vector<voxel::Octree>& regions) {
  glm::ivec3 low(std::numeric_limits<int>::max()), high(0);
  for (const voxel::Octree& region : regions)
    for_each_run(region, [&](const glm::ivec3& v, int count) {
      low = glm::min(low, v);
      high = glm::max(high, v + glm::ivec3(count - 1, 0, 0));
    });
  Labelled made;
  made.first_voxel = low - 1;
  made.image.dims = high - low + 3;
  made.image.spacing_mm = regions.front().universe().lattice().spacing_mm();
  made.image.labels.assign(made.number(made.image.dims - 1) + 1, 0);
  for (std::size_t r = regions.size(); r-- > 0;)  // the first region overwrites the others
    for_each_run(regions[r], [&](const glm::ivec3& v, int count) {
      std::fill_n(made.image.labels.begin() + static_cast<std::ptrdiff_t>(made.number(v - made.first_voxel)),
                  count, static_cast<std::uint8_t>(r + 1));
    });
  return made;
}

glm::dvec3 lps_mm(const Labelled& labelled, const voxel::Lattice& lattice, const glm::dvec3& image_mm) {
  return lattice.lps_mm(image_mm / labelled.image.spacing_mm + glm::dvec3(labelled.first_voxel));
}

/// Adds the factors of the sizes at the refinements.
void add_shares(Labelled& labelled, const voxel::Lattice& lattice, const RegionMeshOptions& options) {
  if (options.finer.empty()) return;
  LabelImage& image = labelled.image;
  const SizingField sizes(options.finer);
  const glm::dvec3& edge_mm = image.spacing_mm;
  // Sizes grow by a quarter between shares that are one element apart.
  image.share_step =
      static_cast<int>(std::clamp(sizes.least_mm() / std::max({edge_mm.x, edge_mm.y, edge_mm.z}), 2.0, 8.0));
  glm::ivec3 count;
  for (int axis = 0; axis < 3; ++axis) count[axis] = share_count(image.dims[axis], image.share_step);
  std::vector<glm::dvec3> points_mm;
  for (int z = 0; z < count.z; ++z)
    for (int y = 0; y < count.y; ++y)
      for (int x = 0; x < count.x; ++x)
        points_mm.push_back(
            lps_mm(labelled, lattice, static_cast<double>(image.share_step) * glm::dvec3(x, y, z) * edge_mm));
  image.shares = sizes.at_mm(points_mm);
  // The bound is on a facet's ball; no side of a facet in this ball is longer than the side of an equilateral
  // one.
  for (double& share : image.shares) share = std::min(1.0, share / (std::sqrt(3.0) * options.size_mm));
}

/// A region's voxels and their exposed faces.
struct Counted {
  std::uint64_t voxels = 0;
  double exposed_mm2 = 0.0;  ///< faces towards other labels
};

using LabelPair = std::pair<std::uint8_t, std::uint8_t>;  // the lower first

/// Planes of the interfaces that may be plane cuts. If a plane cuts two regions apart, the middle between two
/// voxels on either side of it lies within half a voxel's edge of it; an interface is flat within the voxels'
/// resolution if all its middles do. The fitted plane is not the cut itself, hence a tenth of an edge more.
std::vector<LabelPlane> planes_between(const Labelled& labelled) {
  constexpr std::size_t fewest = 16;
  constexpr double most_edges = 0.6, near_share = 0.99;
  const LabelImage& image = labelled.image;
  struct Between {
    std::vector<glm::dvec3> middles_mm;
    glm::dvec3 across{0.0};  ///< sum of the faces' areas, from the lower label to the higher
  };
  std::map<LabelPair, Between> of_pair;
  const glm::dvec3& edge_mm = image.spacing_mm;
  for (int z = 0; z + 1 < image.dims.z; ++z)
    for (int y = 0; y + 1 < image.dims.y; ++y)
      for (int x = 0; x + 1 < image.dims.x; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const glm::ivec3 v(x, y, z);
          glm::ivec3 beside = v;
          ++beside[axis];
          const std::uint8_t one = image.labels[labelled.number(v)],
                             other = image.labels[labelled.number(beside)];
          if (one == other || one == 0 || other == 0) continue;
          Between& between = of_pair[std::minmax(one, other)];
          between.middles_mm.push_back(0.5 * (glm::dvec3(v) + glm::dvec3(beside)) * edge_mm);
          between.across[axis] +=
              (one < other ? 1.0 : -1.0) * edge_mm[(axis + 1) % 3] * edge_mm[(axis + 2) % 3];
        }
  std::vector<LabelPlane> planes;
  for (const auto& [pair, between] : of_pair) {
    const std::vector<glm::dvec3>& points_mm = between.middles_mm;
    if (points_mm.size() < fewest || !(glm::length(between.across) > 0.0)) continue;
    glm::dvec3 middle_mm(0.0);
    for (const glm::dvec3& p_mm : points_mm) middle_mm += p_mm / static_cast<double>(points_mm.size());
    const InterfacePlane plane = fitted_plane(points_mm, {middle_mm, glm::normalize(between.across)},
                                              std::numeric_limits<double>::infinity());
    const double near_mm = most_edges * std::max({edge_mm.x, edge_mm.y, edge_mm.z});
    const auto near = std::count_if(points_mm.begin(), points_mm.end(), [&](const glm::dvec3& p_mm) {
      return std::abs(plane.away_mm(p_mm)) <= near_mm;
    });
    if (static_cast<double>(near) >= near_share * static_cast<double>(points_mm.size()))
      planes.push_back({plane, pair.first, pair.second});
  }
  return planes;
}

/// Seed points on the interface of one label pair are at least `size_mm` apart. They also keep a distance
/// from rims: the mesher would take a point beside a rim, half-way between two of the rim's points, for a
/// point of the rim.
class Starts {
 public:
  explicit Starts(double size_mm, const std::vector<glm::dvec3>& rims_mm = {}) : size_mm_(size_mm) {
    for (const glm::dvec3& p_mm : rims_mm) insert(p_mm, rim());
  }

  /// Adds a point unless another of its pair or a rim's is too near; true if added.
  bool add(const glm::dvec3& p_mm, std::uint8_t one, std::uint8_t other) {
    const Pair pair(std::min(one, other), std::max(one, other));
    constexpr double clear_share = 0.8;
    if (is_near(p_mm, pair, size_mm_) || is_near(p_mm, rim(), clear_share * size_mm_)) return false;
    insert(p_mm, pair);
    return true;
  }

 private:
  using Pair = std::pair<std::uint8_t, std::uint8_t>;
  using Key = std::tuple<Pair, int, int, int>;

  /// The key of rim points: a pair that no interface has, because the labels of an interface differ.
  static Pair rim() { return {1, 1}; }

  glm::ivec3 cell_of(const glm::dvec3& p_mm) const { return glm::ivec3(glm::floor(p_mm / size_mm_)); }
  void insert(const glm::dvec3& p_mm, const Pair& pair) {
    const glm::ivec3 c = cell_of(p_mm);
    in_cell_.emplace(Key{pair, c.x, c.y, c.z}, p_mm);
  }
  bool is_near(const glm::dvec3& p_mm, const Pair& pair, double near_mm) const {
    for (int n = 0; n < 27; ++n) {
      const glm::ivec3 c = cell_of(p_mm) + glm::ivec3(n % 3, (n / 3) % 3, n / 9) - 1;
      const auto [first, end] = in_cell_.equal_range({pair, c.x, c.y, c.z});
      for (auto at = first; at != end; ++at)
        if (glm::distance(at->second, p_mm) < near_mm) return true;
    }
    return false;
  }

  double size_mm_;
  std::multimap<Key, glm::dvec3> in_cell_;
};

/// The point of the square between four voxels' centres where three regions meet: three bilinear shares are
/// equal there. None if the corners have fewer than three labels, or if both corners of a diagonal have one
/// label.
std::optional<glm::dvec2> triple_point(const std::array<std::uint8_t, 4>& labels) {
  // Corners 0 and 1 share a side, as do 0 and 2; 3 is across from 0.
  const auto [a, b, c, d] = labels;
  if (a == d || b == c) return std::nullopt;
  const bool is_low_x = a == c, is_high_x = b == d, is_low_y = a == b, is_high_y = c == d;
  const int pairs = is_low_x + is_high_x + is_low_y + is_high_y;
  if (pairs == 0) return glm::dvec2(0.5);
  if (pairs > 1) return std::nullopt;
  // A label at both corners of a side has the share 1 - t at the distance t from this side, each of the
  // others t / 2. The shares are equal at t = 2 / 3.
  constexpr double far = 2.0 / 3.0;
  if (is_low_x) return glm::dvec2(far, 0.5);
  if (is_high_x) return glm::dvec2(1.0 - far, 0.5);
  return glm::dvec2(0.5, is_low_y ? far : 1.0 - far);
}

/// Start points along the lines where three labels meet. Without them, Mesh_3 ends an interface at a start
/// point that happens to lie on one side of its rim, half a voxel off.
void add_rim_starts(Labelled& labelled, double size_mm) {
  LabelImage& image = labelled.image;
  Starts starts(size_mm);
  for (int z = 0; z + 1 < image.dims.z; ++z)
    for (int y = 0; y + 1 < image.dims.y; ++y)
      for (int x = 0; x + 1 < image.dims.x; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const int u = (axis + 1) % 3, w = (axis + 2) % 3;
          std::array<std::uint8_t, 4> labels{};
          for (int k = 0; k < 4; ++k) {
            glm::ivec3 v(x, y, z);
            v[u] += k % 2;
            v[w] += k / 2;
            labels.at(static_cast<std::size_t>(k)) = image.labels[labelled.number(v)];
          }
          const std::optional<glm::dvec2> at = triple_point(labels);
          if (!at) continue;
          glm::dvec3 place(x, y, z);
          place[u] += at->x;
          place[w] += at->y;
          glm::dvec3 p_mm = place * image.spacing_mm;
          for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t l = 0; l < k; ++l)
              if (const LabelPlane* plane = plane_between(image.planes, labels.at(k), labels.at(l)))
                p_mm -= plane->away_mm(p_mm) * plane->normal;
          if (starts.add(p_mm, 0, 0)) image.start_mm.push_back(p_mm);
        }
}

/// Pass 2. In the same loop, counts each region's voxels and the area of their exposed faces.
std::vector<Counted> add_starts(Labelled& labelled, double size_mm, std::size_t regions) {
  LabelImage& image = labelled.image;
  std::vector<Counted> counted(regions + 1);
  if (regions > 1) add_rim_starts(labelled, size_mm);
  Starts starts(size_mm, image.start_mm);
  const glm::dvec3& edge_mm = image.spacing_mm;
  for (int z = 0; z < image.dims.z; ++z)
    for (int y = 0; y < image.dims.y; ++y)
      for (int x = 0; x < image.dims.x; ++x) {
        const glm::ivec3 v(x, y, z);
        const std::uint8_t label = image.labels[labelled.number(v)];
        ++counted[label].voxels;
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 beside = v;
          if (++beside[axis] >= image.dims[axis]) continue;
          const std::uint8_t other = image.labels[labelled.number(beside)];
          if (label == other) continue;
          for (const std::uint8_t one : {label, other})
            counted[one].exposed_mm2 += edge_mm[(axis + 1) % 3] * edge_mm[(axis + 2) % 3];
          glm::dvec3 p_mm = 0.5 * (glm::dvec3(v) + glm::dvec3(beside)) * edge_mm;
          if (const LabelPlane* plane = plane_between(image.planes, label, other))
            p_mm -= plane->away_mm(p_mm) * plane->normal;
          if (starts.add(p_mm, label, other)) image.start_mm.push_back(p_mm);
        }
      }
  return counted;
}

/// Mends flat elements. Nodes of interfaces count as nodes of surfaces.
void mend(Tetrahedra& made, const RegionMeshOptions& options) {
  std::vector<std::uint32_t> outer = made.boundary_nodes;
  for (const Interface& between : interfaces(made))
    for (const ElementFace& face : between.faces)
      for (const std::uint32_t v : corners_of(made, face)) made.boundary_nodes.push_back(v);
  std::sort(made.boundary_nodes.begin(), made.boundary_nodes.end());
  made.boundary_nodes.erase(std::unique(made.boundary_nodes.begin(), made.boundary_nodes.end()),
                            made.boundary_nodes.end());
  constexpr double play_share = 0.1;
  ImproveOptions improving;
  improving.min_dihedral_deg = options.min_dihedral_deg;
  improving.surface_play_mm.assign(made.boundary_nodes.size(), play_share * options.size_mm);
  improving.rounds = 30;
  improving.progress.stop = options.progress.stop;
  improve(made, improving);
  // An element whose nodes all lie on a flat face can be mended only if a node leaves the face.
  improving.min_dihedral_deg = std::min(options.min_dihedral_deg, fit_dihedral_deg());
  improving.keeps_flat = false;
  if (quality(made).min_dihedral_deg < improving.min_dihedral_deg) improve(made, improving);
  made.boundary_nodes = std::move(outer);
}

/// Pass 3.
void flatten(Tetrahedra& made, const RegionMeshOptions& options, const FlatInterfaceOptions& flat) {
  divide_by_planes(made, flat.planes);
  flatten_interfaces(made, flat);
  mend(made, options);
  // Nodes that mending took off a plane go back where that leaves elements fit.
  flatten_interfaces(made, flat);
  // Splits make nodes and elements that may need mending and flattening again.
  constexpr int most_rounds = 4;
  for (int round = 0; round < most_rounds && !bumps(made, flat).empty(); ++round) {
    split_at_planes(made, flat);
    mend(made, options);
    flatten_interfaces(made, flat);
  }
  for (std::string& finding : bumps(made, flat)) made.findings.push_back(std::move(finding));
}

/// Pass 4.
void check_volumes(Tetrahedra& made, const std::vector<Counted>& counted, const Labelled& labelled) {
  const glm::dvec3& edge_mm = labelled.image.spacing_mm;
  const double voxel_mm3 = edge_mm.x * edge_mm.y * edge_mm.z;
  const double off_mm = 0.25 * std::max({edge_mm.x, edge_mm.y, edge_mm.z});
  std::vector<double> volume_mm3(counted.size(), 0.0);
  for (std::size_t t = 0; t < made.tets.size(); ++t) {
    const double six = six_volumes(corners_mm(made, t));
    if (!(six > 0.0))
      throw voxel::Error(voxel::ErrorCode::Geometry, "smooth_tetrahedra_of: tetrahedron " +
                                                         std::to_string(t) + " has a volume of " +
                                                         rounded(six / 6.0) + " mm3: take another size");
    volume_mm3[made.region_of_tet[t] + 1] += six / 6.0;
  }
  for (std::size_t label = 1; label < counted.size(); ++label) {
    const double voxels_mm3 = static_cast<double>(counted[label].voxels) * voxel_mm3;
    const std::string volumes = "region " + std::to_string(label) + " has " + rounded(volume_mm3[label]) +
                                " mm3, its voxels " + rounded(voxels_mm3) + " mm3";
    if (std::abs(volume_mm3[label] - voxels_mm3) > off_mm * counted[label].exposed_mm2)
      throw voxel::Error(
          voxel::ErrorCode::Geometry,
          "smooth_tetrahedra_of: " + volumes +
              ": parts of it are thinner than elements: take smaller elements, or the voxels' own");
    made.findings.push_back(volumes);
  }
}

}  // namespace

Tetrahedra smooth_tetrahedra_of(const std::vector<voxel::Octree>& regions, const RegionMeshOptions& options) {
  check(regions, options);
  Labelled image = labelled(regions);
  const voxel::Lattice lattice = regions.front().universe().lattice();
  add_shares(image, lattice, options);
  image.image.planes = planes_between(image);
  const std::vector<Counted> counted = add_starts(image, options.size_mm, regions.size());
  for (std::size_t label = 1; label < counted.size(); ++label)
    if (counted[label].voxels == 0)
      refuse_regions("region " + std::to_string(label) + " lies wholly within the regions before it");

  const glm::dvec3& edge_mm = image.image.spacing_mm;
  // Facets may lie half a voxel off, because that is the height of the voxels' steps, which are to be
  // smoothed. Cells may have one and a half times the radius of facets.
  const LabelSizes sizes{options.size_mm,
                         std::max(0.5 * std::min({edge_mm.x, edge_mm.y, edge_mm.z}), 0.1 * options.size_mm),
                         1.5 * options.size_mm};
  MesherOutcome outcome =
      run_mesh3(image.image, sizes, {options.time_limit, options.memory_limit_bytes, options.progress});
  if (outcome.failure) throw voxel::Error(outcome.code, "smooth_tetrahedra_of: " + *outcome.failure);

  Tetrahedra made;
  made.method = "Mesh_3 of labels";
  made.tets = std::move(outcome.tetrahedra);
  for (const std::uint32_t label : outcome.labels) made.region_of_tet.push_back(label - 1);
  for (const glm::dvec3& p_mm : outcome.points_mm) made.nodes_mm.push_back(lps_mm(image, lattice, p_mm));
  if (!lattice.right_handed())
    for (auto& tet : made.tets) std::swap(tet[0], tet[1]);
  made.boundary_nodes = boundary_nodes(made.tets);
  const double voxel_mm = std::min({edge_mm.x, edge_mm.y, edge_mm.z});
  std::vector<LabelPlane> planes = image.image.planes;
  for (LabelPlane& plane : planes) {
    const glm::dvec3 end_mm = lps_mm(image, lattice, plane.on_mm + plane.normal);
    plane.on_mm = lps_mm(image, lattice, plane.on_mm);
    plane.normal = glm::normalize(end_mm - plane.on_mm);  // still from the lower label to the higher
  }
  flatten(
      made, options,
      {std::move(planes), voxel_mm, options.size_mm, std::min(options.min_dihedral_deg, fit_dihedral_deg())});
  check_volumes(made, counted, image);
  return made;
}

}  // namespace octotomy::convert
