// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/printed_part.h"

#include <algorithm>

#include "brep/measure/necks.h"
#include "brep/mesh/flat_triangles.h"
#include "brep/mesh/health.h"
#include "brep/shape/offset.h"
#include "brep/shape/untangle.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/part/print_checks.h"
#include "planner/operation/table/number_format.h"
#include "voxel/filter/components.h"
#include "voxel/filter/offset.h"

namespace octotomy::planner {
namespace {

/// Cuts stay this share of the radius away from the balls, which exceeds the error of either kernel's
/// distances on flat and gently curved parts.
constexpr double standing_off = 0.1;

/// The largest piece of a solid, with its cavities.
brep::Solid first_piece(const brep::Solid& solid) {
  const std::vector<brep::Component>& pieces = solid.components();
  if (pieces.size() < 2) return solid;
  return brep::trusted_solid(brep::part_of(solid.mesh(), pieces.front().faces),
                             brep::proof_of_part(solid.proof()));
}

/// The expression with only the largest of its pieces. `whole` is the octree of the expression, `largest`
/// that of its largest piece.
voxel::Expression of_largest(const voxel::Expression& expression, const voxel::Octree& whole,
                             const voxel::Octree& largest, const VoxelBench& bench) {
  return expression -
         voxel::Expression(bench.combined(voxel::Expression(whole) - voxel::Expression(largest)));
}

/// The union of the balls of the radius that fit within a solid. With `without_necks`, only of the balls
/// around the largest connected piece of their centres. The balls around another piece meet these in a neck
/// that is thinner than a ball, because no ball fits between them.
voxel::Expression balls_within(const voxel::Expression& solid, double radius_mm, bool without_necks,
                               const VoxelBench& bench) {
  const voxel::Octree octree = bench.combined(solid);
  if (octree.is_empty()) return voxel::Expression(octree);
  // Distances to edges are overestimated by up to 2/3 of a voxel's diagonal. Balls narrower than a voxel
  // would therefore cut off most of a part that is few voxels thick.
  const glm::dvec3 spacing_mm = bench.universe.lattice().spacing_mm();
  if (std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z}) > 2.0 * radius_mm) return solid;
  const voxel::Expression middles(
      voxel::offset(octree, bench.within_universe(solid), -radius_mm, bench.progress));
  const voxel::Octree all = bench.combined(middles);
  if (all.is_empty()) return voxel::Expression(all);
  const double reach_mm = radius_mm + standing_off * radius_mm;
  if (!without_necks) return solid & voxel::Expression(voxel::offset(all, middles, reach_mm, bench.progress));
  const voxel::Octree largest = voxel::components(all, voxel::Neighbours::Corners).largest;
  return solid & voxel::Expression(voxel::offset(largest, of_largest(middles, all, largest, bench), reach_mm,
                                                 bench.progress));
}

/// Necks thinner than this are cut through: the least wall that printers make, or this share of the part's
/// own least wall if that is smaller. Other walls are thinner than the part's least wall by at most twice the
/// tolerance of triangles. Where balls as wide as the least wall meet in a neck, the surface turns by at
/// least 74 degrees, or by half of that at each of two neighbouring edges; both exceed the least angle of
/// NecksOptions.
constexpr double neck_share = 0.8;
double neck_mm(double least_wall_mm) {
  return std::min(neck_share * least_wall_mm, PrintLimits{}.least_wall_mm);
}
/// Half the width of the cleft that separates the two sides of a neck. In prints, clefts of at least 0.5 mm
/// stay open.
constexpr double half_cleft_mm = 0.3;

/// The union of balls of the radius around the middles of necks.
brep::Solid balls_about(const std::vector<brep::Neck>& necks, double radius_mm,
                        const brep::Progress& progress) {
  // Triangles this small change the balls by less than the tolerance of their surface.
  constexpr double small_mm = 1e-3;
  brep::Triangles points;
  for (const brep::Neck& neck : necks) {
    const auto first = static_cast<std::uint32_t>(points.points_mm.size());
    for (int axis = 0; axis < 3; ++axis) {
      points.points_mm.push_back(neck.middle_mm);
      points.points_mm.back()[axis] += small_mm;
    }
    points.faces.push_back({first, first + 1, first + 2});
  }
  return brep::thickened(points, {radius_mm, 0.5 * radius_mm, progress});
}

/// Appends the middles of necks to `at_mm`; of necks within `apart_mm` of each other, only the first.
void record_necks(const std::vector<brep::Neck>& necks, double apart_mm, std::vector<glm::dvec3>& at_mm) {
  for (const brep::Neck& neck : necks)
    if (std::none_of(at_mm.begin(), at_mm.end(), [&](const glm::dvec3& other_mm) {
          return glm::distance(neck.middle_mm, other_mm) < apart_mm;
        }))
      at_mm.push_back(neck.middle_mm);
}

}  // namespace

voxel::Expression rounded(const voxel::Expression& solid, double radius_mm, const VoxelBench& bench) {
  return balls_within(solid, radius_mm, false, bench);
}

voxel::Expression thick_part(const voxel::Expression& solid, double least_wall_mm, const VoxelBench& bench) {
  return balls_within(solid, 0.5 * least_wall_mm, true, bench);
}

void keep_largest(const voxel::Expression& solid, const VoxelBench& bench, VoxelSide& made) {
  const voxel::Octree whole = bench.combined(solid);
  const voxel::Components pieces = voxel::components(whole);
  made.octree = pieces.largest;
  made.symbol = bench.within_universe(
      pieces.voxel_counts.size() < 2 ? solid : of_largest(solid, whole, pieces.largest, bench));
}

brep::Solid largest_piece(const brep::Solid& solid, const std::string& part, MeshSide& made) {
  const std::vector<brep::Component>& pieces = solid.components();
  if (pieces.size() < 2) return solid;
  double dropped_mm3 = 0.0;
  for (std::size_t i = 1; i < pieces.size(); ++i) dropped_mm3 += pieces[i].volume_mm3;
  made.findings.push_back(std::to_string(pieces.size() - 1) + " pieces of " + three_figures(dropped_mm3) +
                          " mm\u00b3 beside the " + part + " are left out");
  return first_piece(solid);
}

brep::Solid printed(const brep::Solid& solid, const std::string& part, MeshSide& made) {
  const brep::Solid largest = largest_piece(solid, part, made);
  brep::Triangles triangles = largest.triangles();
  // Along the intersection of a Boolean's surfaces, thin triangles would cross their neighbours when a file
  // rounds their points to single precision.
  constexpr int most_rounds = 4;
  for (int round = 0; round < most_rounds; ++round) {
    for (glm::dvec3& p_mm : triangles.points_mm) p_mm = glm::dvec3(glm::vec3(p_mm));
    brep::Mesh mesh = brep::mesh_of(triangles);
    brep::take_out_flat_triangles(mesh);
    if (brep::health(mesh).solid()) return brep::trusted_solid(mesh, brep::Proof::Health);
    triangles = brep::untangle(mesh).surface;
  }
  made.findings.push_back(
      "triangles intersect where points of the " + part +
      " are rounded to single precision: before printing, mend its file by octotomy repair --solid");
  return largest;
}

brep::Solid thick_part(const brep::LevelBody& body, const ThickPart& asked, const std::string& part,
                       const MeshBench& bench, MeshSide& made) {
  const brep::Progress progress{bench.progress.stop, bench.progress.report};
  const double radius_mm = 0.5 * asked.least_wall_mm;
  brep::Solid middles;
  {
    const Stopwatch watch(bench.timings, part + "_core");
    // The balls around other pieces would be connected only by necks, as balls_within() explains.
    middles = first_piece(brep::core_of(body, {-radius_mm, asked.cell_mm, progress}));
  }
  brep::Solid whole;
  std::vector<glm::dvec3> necks_mm;
  // Beside a neck that is cut, another neck may appear where the two sides come nearer to each other.
  constexpr int most_rounds = 6;
  for (int round = 0; !middles.empty(); ++round) {
    {
      const Stopwatch watch(bench.timings, part + "_surface");
      whole = asked.holes.empty()
                  ? brep::offset(middles, {radius_mm, asked.cell_mm, progress})
                  : brep::core_of({{{{middles, radius_mm}}}, asked.holes}, {0.0, asked.cell_mm, progress});
    }
    const Stopwatch watch(bench.timings, part + "_necks");
    const std::vector<brep::Neck> necks =
        brep::necks(whole, {.below_mm = neck_mm(asked.least_wall_mm), .stop = progress.stop});
    if (necks.empty() || round == most_rounds) break;
    const double cut_mm = radius_mm + half_cleft_mm;
    record_necks(necks, 2.0 * cut_mm, necks_mm);
    middles = first_piece(brep::boolean(middles, brep::Operation::Difference,
                                        balls_about(necks, cut_mm, progress), progress.stop)
                              .solid);
  }
  if (middles.empty()) return {};
  if (!necks_mm.empty()) {
    made.details["necks_mm"] = nlohmann::ordered_json::array();
    for (const glm::dvec3& at_mm : necks_mm) made.details["necks_mm"].push_back(to_json(at_mm));
    const std::string places =
        necks_mm.size() == 1 ? "" : std::to_string(necks_mm.size()) + " places, the first at ";
    made.findings.push_back("necks thinner than " + three_figures(neck_mm(asked.least_wall_mm)) +
                            " mm were cut through at " + places + place_in_words(necks_mm.front()));
  }
  {
    const Stopwatch watch(bench.timings, part + "_thin");
    // Edges that are rounded by the radius recede by up to 0.73 of the radius, at the corners of a cube. This
    // does not count as a thin wall.
    const double thin_mm3 = brep::volume_beyond_mm3(body, whole, radius_mm, 0.5);
    made.details["thin_mm3"] = thin_mm3;
    if (thin_mm3 > 0.0)
      made.findings.push_back("walls thinner than " + three_figures(asked.least_wall_mm) + " mm, about " +
                              three_figures(thin_mm3) + " mm\u00b3, are cut off");
  }
  const Stopwatch watch(bench.timings, part + "_printed");
  return printed(whole, part, made);
}

double thick_part_allowance_mm(const ThickPart& asked) {
  // On smooth surfaces, triangles deviate by a third of the tolerance on average.
  const double radius_mm = 0.5 * asked.least_wall_mm;
  return 2.0 * brep::offset_tolerance_mm({radius_mm, asked.cell_mm, {}}) / 3.0;
}

void check_least_wall(double least_wall_mm, double wall_mm, const char* wall, const FieldLocation& place) {
  if (least_wall_mm > 0.9 * wall_mm)
    place.at("least_wall_mm")
        .refuse("is more than 0.9 of '" + std::string(wall) +
                "', so walls of that thickness would be cut off: make it smaller, or the wall thicker");
}

brep::Solid noted(const brep::BooleanResult& result, MeshSide& made) {
  made.shift_mm += result.shift_mm;
  made.findings.insert(made.findings.end(), result.findings.begin(), result.findings.end());
  return result.solid;
}

}  // namespace octotomy::planner
