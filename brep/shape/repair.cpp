// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/repair.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/line_volume.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/short_text.h"
#include "brep/shape/enclose.h"
#include "brep/shape/mender.h"
#include "brep/shape/offset.h"

namespace octotomy::brep {
namespace {

/// If a solid is requested and merging equal points leaves the surface open, points within this share of the
/// extent are merged: sixteen times the rounding error of single precision.
constexpr double weld_share() {
  return 0x1p-20;
}

void check(const Triangles& surface, const RepairOptions& options) {
  if (options.weld_mm && !(*options.weld_mm >= 0.0 && std::isfinite(*options.weld_mm)))
    throw InvalidInput("repair: the distance to weld over must be 0 mm or more");
  if (options.longest_hole_mm && !(*options.longest_hole_mm > 0.0))
    throw InvalidInput("repair: the longest border of a hole must be above 0 mm");
  if (options.wall_mm && !(*options.wall_mm > 0.0))
    throw InvalidInput("repair: a wall must be thicker than 0 mm");
  if (!(options.max_volume_share > 0.0))
    throw InvalidInput("repair: the largest share of the volume must be above 0");
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    for (const std::uint32_t v : surface.faces[f])
      if (v >= surface.points_mm.size() ||
          (!options.solid && !std::isfinite(glm::dot(surface.points_mm[v], glm::dvec3(1.0)))))
        throw Error(
            ErrorCode::Input,
            "repair: triangle " + std::to_string(f) +
                " refers to a point that does not exist or is not finite; --solid leaves out triangles with "
                "points that are not finite; if the point does not exist, export the mesh again");
}

/// The volume inside, for comparison; lines through holes are left out.
double volume_inside_mm3(const Triangles& surface) {
  const LineVolumes volumes = line_volumes(surface, {});
  const auto closed = static_cast<double>(volumes.lines - volumes.open_lines);
  return closed > 0.0 ? volumes.all.a_mm3 * static_cast<double>(volumes.lines) / closed : 0.0;
}

bool is_within_share(double before_mm3, double now_mm3, const RepairOptions& options) {
  return std::abs(now_mm3 - before_mm3) <= options.max_volume_share * before_mm3;
}

[[noreturn]] void refuse_volume(double before_mm3, double now_mm3, const RepairOptions& options,
                                const char* step, const std::string& ways) {
  throw Error(ErrorCode::Geometry, std::string("repair: ") + step + " changed the volume from " +
                                       short_text(before_mm3) + " to " + short_text(now_mm3) +
                                       " mm3, more than the allowed share of " +
                                       short_text(options.max_volume_share) + ": " + ways);
}

void check_volume(double before_mm3, const Triangles& now, const RepairOptions& options, const char* step) {
  const double now_mm3 = volume_inside_mm3(now);
  if (!is_within_share(before_mm3, now_mm3, options))
    refuse_volume(before_mm3, now_mm3, options, step,
                  "take --solid instead, which unites closed shells and rebuilds other surfaces, or "
                  "accept the change by --max-volume-share " +
                      short_text(1.01 * std::abs(now_mm3 - before_mm3) / before_mm3));
}

/// The volume of the region that a surface encloses; none if it encloses nothing.
std::optional<double> enclosed_mm3(const Triangles& surface, double cell_mm, bool hull,
                                   const Progress& progress) {
  try {
    return size_of(brep::enclose(surface, {cell_mm, hull, progress}).solid).volume_mm3;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::Geometry) throw;
    return std::nullopt;
  }
}

/// The edge of a lattice's cells for a wall: at most half the wall's thickness, so that no part of the wall
/// is missed.
double wall_cell_mm(double wall_mm, const RepairOptions& options) {
  return std::min(options.cell_mm.value_or(0.5 * wall_mm), 0.5 * wall_mm);
}

/// A wall around the given surface, without triangles that have a point that is not finite or repeat a point.
Solid wall_of(const Triangles& given, double wall_mm, const RepairOptions& options) {
  Mender finite(given);
  finite.remove_not_finite();
  finite.remove_repeats();
  if (finite.surface().faces.empty()) return {};
  return thickened(finite.surface(), {0.5 * wall_mm, wall_cell_mm(wall_mm, options), options.progress});
}

/// Advice to make a sheet a wall whose thickness is a 50th of the sheet's extent, with the resulting volume.
/// Empty if that fails.
std::string wall_way(const Triangles& given, double extent_mm, const RepairOptions& options) {
  const std::string wall = short_text(0.02 * extent_mm);
  try {
    const Solid solid = wall_of(given, std::stod(wall), options);
    if (solid.empty()) return {};
    return "--wall " + wall + " makes the surface, where it is a sheet, a wall of " + wall + " mm, " +
           short_text(solid.measures().volume_mm3) + " mm3";
  } catch (const TooLarge&) {
    return {};
  }
}

/// Advice for an enclosing that changed the volume by too much: the options that were tried and would be
/// accepted, such as smaller cells or the hull.
std::string ways_that_work(const Triangles& surface, const Triangles& given, double before_mm3,
                           double now_mm3, double cell_mm, const RepairOptions& options) {
  std::string ways;
  const auto add = [&](const std::string& way) { ways += (ways.empty() ? "" : "; or ") + way; };
  for (const double part : {0.5, 0.25}) {
    const std::string cell = short_text(part * cell_mm);
    const std::optional<double> finer_mm3 = enclosed_mm3(surface, std::stod(cell), false, options.progress);
    if (!finer_mm3 || !is_within_share(before_mm3, *finer_mm3, options)) continue;
    add("--cell " + cell + " encloses " + short_text(*finer_mm3) + " mm3, which is within it");
    break;
  }
  if (const std::optional<double> hull_mm3 = enclosed_mm3(surface, cell_mm, true, options.progress))
    add("--hull fills the outermost shells, " + short_text(*hull_mm3) + " mm3");
  if (const std::string wall = wall_way(given, Mender(given).extent_mm(), options); !wall.empty()) add(wall);
  const double share = std::abs(now_mm3 - before_mm3) / before_mm3;
  add("the region with a winding number of a half or more differs by a share of " + short_text(share) +
      ", accepted by --max-volume-share " + short_text(1.01 * share) +
      ": check the result, because thin sheets may be lost and gaps filled");
  return ways;
}

/// The order matters: splitting fans needs orientation, orienting needs the shells that splitting closes, and
/// shells with holes can be oriented only after these are filled.
void connect(Mender& mender, const RepairOptions& options) {
  const bool solid = options.solid;
  if (solid) mender.remove_not_finite();
  if (options.weld_mm || solid) mender.weld(options.weld_mm.value_or(0.0));
  if (solid && !options.weld_mm && mender.is_open()) mender.weld(weld_share() * mender.extent_mm());
  if (options.remove_flat || solid) mender.remove_repeats();
  if (options.remove_duplicates || solid) mender.remove_duplicates();
  const auto nested = solid ? Nested::AsGiven : Nested::Alternating;
  if (options.orient || solid) mender.orient(nested);
  if (options.remove_flat || solid) mender.flip_flat();
  if (solid) mender.split();
  if (solid) mender.remove_films();
  if (options.fill_holes || solid) mender.fill_holes(options.longest_hole_mm);
  if (solid) mender.remove_films();
  if ((options.orient && options.fill_holes) || solid) mender.orient(nested);
}

/// With more triangles, a solid is enclosed at once, without trying to preserve the rest of the surface.
constexpr std::size_t most_untangled = 100'000;

/// With more shells, their union by Booleans would take longer than enclosing them.
constexpr std::size_t most_united = 1000;

void make_solid(Mender& mender, double before_mm3, const RepairOptions& options) {
  Health now = health(mender.surface());
  if (now.solid() && !options.hull) return;
  if (now.closed && now.shells > 1 && now.shells <= most_united && !options.hull && !options.cell_mm &&
      mender.unite(options.progress.stop))
    return;
  const std::size_t triangles = mender.surface().faces.size();
  if (!options.hull && !options.cell_mm && now.closed && triangles <= most_untangled &&
      now.self_intersections <= triangles / 10) {
    Mender tried = mender;
    tried.remove_intersections();
    tried.split();
    tried.orient();
    const double share = std::abs(volume_inside_mm3(tried.surface()) - before_mm3) / before_mm3;
    if (share <= options.max_volume_share && health(tried.surface()).solid()) {
      mender = std::move(tried);
      return;
    }
  }
  mender.enclose(options);
}

Repair mended(const Triangles& surface, const RepairOptions& options, bool offers_ways);

/// Suggests the option --weld for a surface in loose pieces if joining their points closes it; else empty.
std::string weld_way(const Triangles& given, double extent_mm, const RepairOptions& options) {
  if (options.weld_mm) return {};
  for (const double share : {3e-4, 1e-3, 3e-3}) {
    RepairOptions welded = options;
    const std::string apart = short_text(share * extent_mm);
    welded.weld_mm = std::stod(apart);
    try {
      const Repair made = mended(given, welded, false);
      // Rejects an answer in which a few pieces closed by chance and the others were removed.
      constexpr double most = 0.8;
      if (size_of(made.surface).area_mm2 < most * size_of(given).area_mm2) continue;
      return "--weld " + apart + " joins points up to " + apart + " mm apart and encloses " +
             short_text(size_of(made.surface).volume_mm3) + " mm3";
    } catch (const Error& error) {
      if (error.code() != ErrorCode::Geometry) throw;
    }
  }
  return {};
}

Repair mended(const Triangles& surface, const RepairOptions& options, bool offers_ways) {
  Mender mender(surface);
  if (options.solid && options.wall_mm) {
    mender.replace(wall_of(surface, *options.wall_mm, options), wall_cell_mm(*options.wall_mm, options),
                   "made a wall of " + short_text(*options.wall_mm) + " mm about the surface as given");
    return mender.result();
  }
  connect(mender, options);
  if (!options.remove_intersections && !options.solid) {
    mender.split();
    if (options.orient) mender.orient();
    return mender.result();
  }
  options.progress.at(0.2);
  const double before_mm3 = volume_inside_mm3(mender.surface());
  if (options.solid) {
    const Triangles connected = mender.surface();
    try {
      make_solid(mender, before_mm3, options);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::Geometry || !offers_ways) throw;
      std::string ways;
      const double extent_mm = Mender(surface).extent_mm();
      for (const std::string& way :
           {weld_way(surface, extent_mm, options), wall_way(surface, extent_mm, options)})
        if (!way.empty()) ways += "; or " + way;
      throw Error(ErrorCode::Geometry, error.what() + ways);
    }
    const double now_mm3 = options.hull ? before_mm3 : volume_inside_mm3(mender.surface());
    if (!is_within_share(before_mm3, now_mm3, options))
      refuse_volume(before_mm3, now_mm3, options, "enclosing",
                    mender.cell_mm() && offers_ways
                        ? ways_that_work(connected, surface, before_mm3, now_mm3, *mender.cell_mm(), options)
                        : "allow a larger one, --max-volume-share");
  } else {
    mender.remove_intersections();
    check_volume(before_mm3, mender.surface(), options, "taking out intersections");
  }
  mender.split();
  // Shells that intersected can be placed only now; each orientation may make another one necessary.
  for (int turns = 0; (options.orient || options.solid) && turns < 3 && mender.orient(); ++turns) continue;
  return mender.result();
}

}  // namespace

Repair repair(const Triangles& surface, const RepairOptions& options) {
  check(surface, options);
  return mended(surface, options, true);
}

TurnedAlike turned_alike(const Triangles& surface) {
  RepairOptions options;
  options.weld_mm = 0.0;
  options.orient = true;
  Repair repaired = repair(surface, options);
  const auto turned = std::count_if(repaired.changes.begin(), repaired.changes.end(),
                                    [](const Change& change) { return change.step == "orient"; });
  return {std::move(repaired.surface), static_cast<std::size_t>(turned)};
}

}  // namespace octotomy::brep
