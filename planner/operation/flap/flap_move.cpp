// SPDX-License-Identifier: AGPL-3.0-or-later
// The motion of one segment of a flap, from the uncut donor bone to its place. What is attached to the bone before
// it is cut, as screws, goes along with its segment.
#include <stdexcept>

#include "planner/operation/flap/flap_space.h"
#include "planner/operation/motion/move.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct FlapMove {
  ObjectName object, segment;
  // Settled.
  glm::dmat4 moved_from_still{1.0};
};

void check(const FlapMove& move, const FieldLocation& place) {
  if (move.object.name == move.segment.name)
    place.at("segment").refuse("is the object itself: name the flap_space step of its segment");
}

FlapMove settle(const FlapMove& asked, const SettleBench& bench) {
  const Action* maker = bench.maker_of ? bench.maker_of(asked.segment.name) : nullptr;
  const std::vector<FlapCut> cuts = maker == nullptr ? std::vector<FlapCut>() : flap_cuts(*maker);
  const bool is_of_segment = !cuts.empty() && !cuts.front().is_of_resection;
  const std::optional<glm::dmat4> uncut_from_placed =
      is_of_segment ? flap_place(maker, asked.segment.name, 0.0).uncut_from_placed : std::nullopt;
  if (!uncut_from_placed)
    throw std::runtime_error(
        "'" + asked.segment.name +
        "' is not a segment's space on the uncut donor bone: name a flap_space step with 'uncut_at'");
  FlapMove settled = asked;
  settled.moved_from_still = glm::inverse(*uncut_from_placed);
  return settled;
}

std::string definition(const FlapMove& move, const Objects&) {
  return move.object.name + " moved with " + move.segment.name + " to its place in the flap";
}

void bound(const FlapMove& move, const BoundBench& bench, Object& made) {
  move_bound(move, bench, made);
  made.shared_values.push_back("the motion of the flap's segment");
}

}  // namespace

Operation flap_move_operation() {
  return Describe<FlapMove>(
             "flap_move",
             "Moves an object from the uncut donor bone to the place of one segment in a free flap.",
             Makes::Object)
      .takes(field("object", &FlapMove::object, "The object that moves with the segment, such as a screw.")
                 .required())
      .takes(field("segment", &FlapMove::segment,
                   "The flap_space step that made the segment's space on the uncut bone, with 'uncut_at'.")
                 .required())
      .example(R"({"id": "screw_moved", "do": "flap_move", "object": "left_1", "segment": "cut"})")
      .motion()
      .check(check)
      .settle(settle)
      .object(definition, moved_voxels<FlapMove>, moved_triangles<FlapMove>, bound);
}

}  // namespace octotomy::planner
