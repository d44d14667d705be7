// SPDX-License-Identifier: AGPL-3.0-or-later
// Spaces that cut a free flap: eight-sided beams along segments, mitred at their corners.
#include "planner/operation/flap/flap_space.h"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <stdexcept>

#include "planner/operation/flap/fields.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/witness.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

struct FlapSpace : FlapFields {
  std::string part = "segment";
  int number = 1;
  double slab_mm = 2.0;
  double aside_mm = 18.0;
  std::optional<int> uncut_at;
};

constexpr int sides = 8;

/// A part of a beam between two planes.
struct BeamSegment {
  FlapPlane start, end;
  glm::dvec3 along, across;
};
struct Beam {
  std::vector<BeamSegment> pieces;
  double reach_mm = 0.0;  ///< from its axis to its sides
};

/// The direction perpendicular to a piece that encloses the angle `radians` with the direction of its face.
glm::dvec3 square_at(const BeamSegment& piece, double radians) {
  return std::cos(radians) * piece.across + std::sin(radians) * glm::cross(piece.along, piece.across);
}

/// The slab of thickness `slab_mm` whose middle plane is the cut.
BeamSegment slab_about(const FlapPlane& cut, const glm::dvec3& across, double slab_mm) {
  const glm::dvec3 aside = glm::normalize(across - cut.normal * glm::dot(cut.normal, across));
  const glm::dvec3 half = 0.5 * slab_mm * cut.normal;
  return {{cut.point_mm - half, cut.normal}, {cut.point_mm + half, cut.normal}, cut.normal, aside};
}

/// The motion from a placed segment to its place on the uncut bone; none if the space is not on the uncut
/// bone.
std::optional<glm::dmat4> uncut_from_placed(const FlapSpace& space,
                                            const std::vector<FlapSegment>& segments) {
  if (!space.uncut_at) return std::nullopt;
  const auto motion = [&](int number) -> const glm::dmat4& {
    return segments.at(static_cast<std::size_t>(number - 1)).placed_from_donor;
  };
  return motion(*space.uncut_at) * glm::inverse(motion(space.number));
}

BeamSegment moved(const BeamSegment& piece, const glm::dmat4& motion) {
  const glm::dmat3 turn(motion);
  const auto plane = [&](const FlapPlane& cut) {
    return FlapPlane{glm::dvec3(motion * glm::dvec4(cut.point_mm, 1.0)), turn * cut.normal};
  };
  return {plane(piece.start), plane(piece.end), turn * piece.along, turn * piece.across};
}

Beam beam_of(const FlapSpace& space) {
  const std::vector<FlapSegment> segments = segments_of(space);
  const auto piece = [](const FlapSegment& one) {
    return BeamSegment{one.start, one.end, one.along, one.across};
  };
  if (space.part == "segment")
    return {{moved(piece(segments.at(static_cast<std::size_t>(space.number - 1))),
                   uncut_from_placed(space, segments).value_or(glm::dmat4(1.0)))},
            space.reach_mm};
  if (space.part == "osteotomy") {
    const auto cut = static_cast<std::size_t>(space.number - 1);
    const bool is_last = cut == segments.size();
    const FlapSegment& one = segments.at(is_last ? cut - 1 : cut);
    // The sides of a tilted cut extend farther along the axis than its centre.
    const double tilt = glm::radians(is_last ? one.end_tilt_deg : one.start_tilt_deg);
    return {{slab_about(is_last ? one.end : one.start, one.across, space.slab_mm)},
            space.reach_mm / std::cos(tilt) + space.slab_mm};
  }
  Beam beam{{}, space.aside_mm};
  for (const FlapSegment& one : segments) beam.pieces.push_back(piece(one));
  return beam;
}

void check(const FlapSpace& space, const FieldLocation& place) {
  check_flap(space, place);
  const std::size_t segments = space.curve.size() - 1;
  const std::size_t most = space.part == "osteotomy" ? segments + 1 : segments;
  if (space.part != "resection" && static_cast<std::size_t>(space.number) > most)
    place.at("number").refuse(
        "must be at most the number of places that the curve has for the part, which is " +
        std::to_string(most) + " for part '" + space.part + "'");
  if (space.uncut_at && static_cast<std::size_t>(*space.uncut_at) > segments)
    place.at("uncut_at")
        .refuse("must be a segment of the curve, which has " + std::to_string(segments) + " segments");
  if (space.part != "resection") return;
  FlapFields wide = space;
  wide.reach_mm = space.aside_mm;
  wide.donor[1].p_mm = wide.donor[0].p_mm + 1e4 * (wide.donor[1].p_mm - wide.donor[0].p_mm);
  try {
    segments_of(wide);
  } catch (const voxel::InvalidInput&) {
    place.at("aside_mm")
        .refuse("is so wide that the sides of the resection cross: state less than " + plain(space.aside_mm) +
                " mm");
  }
}

std::string definition(const FlapSpace& space, const Objects&) {
  if (space.part == "resection")
    return "all that lies within " + plain(space.aside_mm) + " mm beside the flap's curve";
  return (space.part == "segment" ? "between the cuts of segment " : "a slab about osteotomy ") +
         std::to_string(space.number) + (space.uncut_at ? " on the uncut donor" : "");
}

voxel::Expression voxels_of(const BeamSegment& piece, double reach_mm) {
  const auto below = [](const glm::dvec3& normal, double offset_mm) {
    return voxel::Expression(voxel::HalfSpace{normal, offset_mm});
  };
  voxel::Expression made = below(-piece.start.normal, -glm::dot(piece.start.normal, piece.start.point_mm)) &
                           below(piece.end.normal, glm::dot(piece.end.normal, piece.end.point_mm));
  for (int side = 0; side < sides; ++side) {
    const glm::dvec3 normal = glm::normalize(square_at(piece, glm::two_pi<double>() * side / sides));
    made = made & below(normal, glm::dot(normal, piece.start.point_mm) + reach_mm);
  }
  return made;
}

void voxels(const FlapSpace& space, const VoxelBench& bench, VoxelSide& made) {
  const Beam beam = beam_of(space);
  for (const BeamSegment& piece : beam.pieces) {
    const voxel::Expression one = voxels_of(piece, beam.reach_mm);
    made.symbol = made.symbol ? *made.symbol | one : one;
  }
  made.octree = bench.combined(*made.symbol);
  made.lineage = "half-spaces at voxel centres";
  if (made.octree.is_empty())
    throw std::runtime_error("it contains no voxel of the universe, which spans " + plain(bench.box_mm()) +
                             ": check the curve");
}

void triangles(const FlapSpace& space, const MeshBench&, MeshSide& made) {
  const Beam beam = beam_of(space);
  const double corner_mm = flap_corner_mm(beam.reach_mm);
  brep::Triangles surface;
  for (std::size_t cut = 0; cut <= beam.pieces.size(); ++cut) {
    const BeamSegment& piece = beam.pieces[std::min(cut, beam.pieces.size() - 1)];
    const FlapPlane& plane = cut < beam.pieces.size() ? piece.start : piece.end;
    for (int k = 0; k < sides; ++k) {
      const glm::dvec3 off = corner_mm * square_at(piece, glm::two_pi<double>() * (k + 0.5) / sides);
      const double back_mm = glm::dot(plane.normal, off) / glm::dot(plane.normal, piece.along);
      surface.points_mm.push_back(plane.point_mm + off - piece.along * back_mm);
    }
  }
  const auto at = [](std::size_t cut, int k) {
    return static_cast<std::uint32_t>(cut * sides + static_cast<std::size_t>(k % sides));
  };
  const std::size_t last = beam.pieces.size();
  for (std::size_t cut = 0; cut < last; ++cut)
    for (int k = 0; k < sides; ++k) {
      surface.faces.push_back({at(cut, k), at(cut, k + 1), at(cut + 1, k + 1)});
      surface.faces.push_back({at(cut, k), at(cut + 1, k + 1), at(cut + 1, k)});
    }
  for (int k = 1; k + 1 < sides; ++k) {
    surface.faces.push_back({at(0, 0), at(0, k + 1), at(0, k)});
    surface.faces.push_back({at(last, 0), at(last, k), at(last, k + 1)});
  }
  made.whole = brep::solid_of(surface);
  made.lineage = "beams between cut planes";
}

/// The points behind a plane, as a box that is larger than any universe.
verify::Witness behind(const glm::dvec3& normal, const glm::dvec3& point_mm) {
  constexpr double far_mm = 2000.0;
  const glm::dvec3 least = std::abs(normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(normal, least));
  glm::dmat4 placed(glm::dmat3(right, glm::cross(normal, right), normal));
  placed[3] = glm::dvec4(point_mm, 1.0);
  return verify::carried(verify::witness_of_box({glm::dvec3(-far_mm), {far_mm, far_mm, 0.0}}), placed);
}

verify::Witness witness_of(const BeamSegment& piece, double reach_mm) {
  verify::Witness made = verify::both(behind(-piece.start.normal, piece.start.point_mm),
                                      behind(piece.end.normal, piece.end.point_mm));
  for (int side = 0; side < sides; ++side) {
    const glm::dvec3 normal = glm::normalize(square_at(piece, glm::two_pi<double>() * side / sides));
    made = verify::both(made, behind(normal, piece.start.point_mm + reach_mm * normal));
  }
  return made;
}

void bound(const FlapSpace& space, const BoundBench&, Object& made) {
  const Beam beam = beam_of(space);
  std::string text;
  for (std::size_t i = 0; i < beam.pieces.size(); ++i) text += (i == 0 ? "p" : " | p") + std::to_string(i);
  made.witness = verify::witness_of_expression(text, [&](const std::string& name) {
    return witness_of(beam.pieces[std::stoul(name.substr(1))], beam.reach_mm);
  });
  if (made.mesh.whole) made.walls = {{made.id, *made.mesh.whole}};
}

const FlapSpace* space_of(const Action* maker) {
  const FlapSpace* space = maker == nullptr ? nullptr : maker->get_if<FlapSpace>();
  return space == nullptr || space->part == "osteotomy" ? nullptr : space;
}

}  // namespace

std::vector<FlapCut> flap_cuts(const Action& maker) {
  const FlapSpace* space = space_of(&maker);
  if (space == nullptr) return {};
  const Beam beam = beam_of(*space);
  const bool is_resection = space->part == "resection";
  const double outwards = is_resection ? -1.0 : 1.0;
  const auto cut = [&](const FlapPlane& plane, double sign) {
    return FlapCut{plane.point_mm, sign * outwards * plane.normal, space->kerf_mm,
                   flap_corner_mm(beam.reach_mm), is_resection};
  };
  return {cut(beam.pieces.front().start, -1.0), cut(beam.pieces.back().end, 1.0)};
}

FlapPlace flap_place(const Action* maker, const std::string& name, double share) {
  const FlapSpace* space = space_of(maker);
  if (space == nullptr)
    throw std::runtime_error("'" + name +
                             "' is not the space of a flap's segment or resection: name a flap_space step");
  const FlapPlan plan = plan_of(*space);
  if (space->part == "segment") {
    if (share < 0.0 || share > 1.0)
      throw std::runtime_error("'share' is " + plain(share) + ", beside segment " +
                               std::to_string(space->number) +
                               ": state a number from 0, its first cut, to 1, its second cut");
    const std::vector<FlapSegment> segments = segments_of(*space);
    const FlapSegment& segment = segments.at(static_cast<std::size_t>(space->number - 1));
    return {glm::mix(segment.start.point_mm, segment.end.point_mm, share), segment.along, space->reach_mm,
            uncut_from_placed(*space, segments)};
  }
  if (plan.stumps_mm.empty())
    throw std::runtime_error("'" + name +
                             "' has no 'stumps', which define places in the bone that stays: add them");
  if (share < -1.0 || share > 2.0 || (share > 0.0 && share < 1.0))
    throw std::runtime_error("'share' is " + plain(share) +
                             ", in the resected bone or beyond the points of 'stumps': state -1 to 0 before "
                             "the first cut, or 1 to 2 beyond the last");
  const bool is_first = share <= 0.0;
  const glm::dvec3 cut_mm = is_first ? plan.curve_mm.front() : plan.curve_mm.back(),
                   stump_mm = plan.stumps_mm[is_first ? 0 : 1];
  return {glm::mix(cut_mm, stump_mm, is_first ? -share : share - 1.0), glm::normalize(stump_mm - cut_mm),
          space->aside_mm, std::nullopt};
}

Operation flap_space_operation() {
  Describe<FlapSpace> entry("flap_space",
                            "Makes the space of one segment of a free flap, of one osteotomy, or of the "
                            "resection that the flap fills.",
                            Makes::Object);
  for (Field& each : flap_fields<FlapSpace>()) std::move(entry).takes(std::move(each));
  return std::move(entry)
      .takes(field("part", &FlapSpace::part,
                   "segment: the space between its two cuts; osteotomy: a slab around a cut; resection: the "
                   "space along the whole curve.")
                 .one_of({"segment", "osteotomy", "resection"}))
      .takes(field("number", &FlapSpace::number, "The number of the segment or osteotomy along the curve.")
                 .from(1)
                 .to(9))
      .takes(field("slab_mm", &FlapSpace::slab_mm, "The thickness of an osteotomy's slab.")
                 .greater_than(0)
                 .to(10))
      .takes(field("aside_mm", &FlapSpace::aside_mm,
                   "The distance from the curve to the sides of the resection.")
                 .greater_than(0)
                 .to(80))
      .takes(
          field("uncut_at", &FlapSpace::uncut_at,
                "For a segment: makes its space on the uncut donor bone, which flap_scan with 'uncut' places "
                "by the segment of this number. Default: the space at the segment's place in the flap.")
              .from(1)
              .to(8)
              .read_if<FlapSpace>([](const FlapSpace& space) { return space.part == "segment"; },
                                  "applies only to 'part': 'segment': leave it out"))
      .example(R"({"id": "wedge_1", "do": "flap_space", "part": "segment", "number": 1,
        "curve": [[-30, -60, -80], [0, -80, -85], [30, -60, -80]],
        "donor": [[30, 12, 90], [33, 15, -90]], "face": [45, 12, 90]})")
      .tool()
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
