// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/scene_pictures.h"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <tbb/parallel_for.h>

#include "planner/operation/object/combine.h"
#include "planner/plan/dependence.h"
#include "voxel/scan/image_file.h"

namespace octotomy::planner {
namespace {

/// Colours that people with any colour vision can distinguish, also in grey print (after Okabe and Ito 2008).
constexpr std::array<glm::vec3, 5> accents{{{0.20f, 0.56f, 0.72f},
                                            {0.87f, 0.49f, 0.20f},
                                            {0.16f, 0.60f, 0.47f},
                                            {0.74f, 0.45f, 0.64f},
                                            {0.83f, 0.72f, 0.25f}}};

std::string without_blanks(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c); }),
             text.end());
  return text;
}

/// The names in a union such as `a | b | c`; empty for any other expression.
std::vector<std::string> pieces_of_union(const std::string& expression) {
  const std::string text = without_blanks(expression);
  std::vector<std::string> pieces{""};
  for (const char symbol : text) {
    if (symbol == '|') {
      pieces.emplace_back();
    } else if (std::isalnum(static_cast<unsigned char>(symbol)) || symbol == '_') {
      pieces.back() += symbol;
    } else {
      return {};
    }
  }
  // Repeated names are dropped. More pieces than readers can distinguish are drawn as one object.
  constexpr std::size_t most_pieces = 64;
  std::set<std::string> seen;
  std::erase_if(pieces, [&](const std::string& piece) { return !seen.insert(piece).second; });
  return pieces.size() > 1 && pieces.size() <= most_pieces ? pieces : std::vector<std::string>{};
}

std::vector<std::string> final_pieces(const Plan& plan, const Evaluation& evaluation) {
  for (auto step = plan.steps.rbegin(); step != plan.steps.rend(); ++step)
    if (const auto* combine = step->action.get_if<Combine>())
      if (auto pieces = pieces_of_union(combine->expression); !pieces.empty()) return pieces;
  for (auto object = evaluation.objects.rbegin(); object != evaluation.objects.rend(); ++object)
    if (!object->is_tool && !object->voxel.octree.is_empty()) return {object->id};
  return {};
}

/// The id of the object from which a chain of motions starts.
std::string still_of(const Evaluation& evaluation, std::string id) {
  while (const auto& moved = evaluation.object(id).moved) id = moved->object;
  return id;
}

/// The first object from which a piece was made, if a motion was among the steps between: the piece's own
/// position before its last motion would then not show the patient. Null if there was no motion.
const Object* untouched(const Plan& plan, const Evaluation& evaluation, const std::string& id) {
  const std::set<std::string> needed = needed_for(plan, {id});
  const Object* first = nullptr;
  bool moved = false;
  for (const Object& object : evaluation.objects) {
    if (!needed.contains(object.id) || object.is_tool) continue;
    if (first == nullptr) first = &object;
    moved = moved || object.moved;
  }
  return moved ? first : nullptr;
}

/// Whether a piece is bone that the patient does not have: of a flap, or mirrored.
bool is_added(const Plan& plan, const std::string& id) {
  const std::set<std::string> needed = needed_for(plan, {id});
  return std::any_of(plan.steps.begin(), plan.steps.end(), [&](const Step& step) {
    const std::string& name = step.action.operation().name;
    return needed.contains(step.id) && (name == "flap_scan" || name == "mirror");
  });
}

/// The first object from which a piece was made, except masks.
const Object& origin_of(const Plan& plan, const Evaluation& evaluation, const std::string& id) {
  const std::set<std::string> needed = needed_for(plan, {id});
  for (const Object& object : evaluation.objects)
    if (needed.contains(object.id) && !object.is_tool) return object;
  return evaluation.object(id);
}

struct Frame {
  glm::dvec2 centre_mm{0.0};
  double width_mm = 1.0;
};

/// The smallest square in a view that contains the boxes of all objects.
Frame loose_frame(const std::vector<voxel::DrawnObject>& objects, const voxel::View& view) {
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const voxel::DrawnObject& object : objects) {
    const auto extents = voxel::extents_of(object.octree);
    if (!extents) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p_mm(corner & 1 ? extents->high_mm.x : extents->low_mm.x,
                            corner & 2 ? extents->high_mm.y : extents->low_mm.y,
                            corner & 4 ? extents->high_mm.z : extents->low_mm.z);
      low = glm::min(low, view.project(p_mm));
      high = glm::max(high, view.project(p_mm));
    }
  }
  if (!(low.x <= high.x)) return {};
  return {(low + high) * 0.5, std::max(high.x - low.x, high.y - low.y)};
}

voxel::RenderOptions options_of(const voxel::View& view, const Frame& frame, int size_px) {
  voxel::RenderOptions options;
  options.view = view;
  options.size_px = glm::ivec2(size_px);
  options.centre_mm = frame.centre_mm;
  options.width_mm = frame.width_mm;
  return options;
}

/// A square around the visible parts of the objects, wider by a sixth for scales and letters. Seen from a
/// corner, a box is much larger than its contents, so the objects are first drawn small. The frame is
/// accurate to a pixel of that picture.
Frame frame_of(const std::vector<voxel::DrawnObject>& objects, const voxel::View& view) {
  constexpr int probe_px = 96;
  constexpr double margin = 7.0 / 6.0;
  Frame loose = loose_frame(objects, view);
  const voxel::Picture probe = voxel::render(objects, options_of(view, loose, probe_px));
  glm::ivec2 low(probe_px), high(-1);
  std::size_t pixel = 0;
  for (int y = 0; y < probe_px; ++y)
    for (int x = 0; x < probe_px; ++x)
      if (probe.object[pixel++] >= 0) {
        low = glm::min(low, glm::ivec2(x, y));
        high = glm::max(high, glm::ivec2(x, y));
      }
  if (high.x < 0) return loose;
  const double pixel_mm = loose.width_mm / probe_px;
  const glm::dvec2 middle_px = glm::dvec2(low + high + 1) * 0.5 - 0.5 * probe_px;
  const glm::ivec2 extent_px = high - low + 1;
  return {loose.centre_mm + pixel_mm * glm::dvec2(middle_px.x, -middle_px.y),
          margin * pixel_mm * std::max(extent_px.x, extent_px.y)};
}

}  // namespace

FinalScene final_scene(const Plan& plan, const Evaluation& evaluation) {
  FinalScene scene;
  const std::vector<std::string> pieces = final_pieces(plan, evaluation);
  const bool adds =
      pieces.size() > 1 &&
      std::any_of(pieces.begin(), pieces.end(), [&](const std::string& id) { return is_added(plan, id); }) &&
      !std::all_of(pieces.begin(), pieces.end(), [&](const std::string& id) { return is_added(plan, id); });
  std::size_t next_accent = 0;
  bool bone_taken = false;
  const auto show_before = [&](const Object& first) {
    const bool is_there = std::any_of(scene.before.begin(), scene.before.end(),
                                      [&](const auto& object) { return object.name == first.id; });
    if (!is_there) scene.before.push_back(drawn(first, bone_colour));
    scene.moves = true;
  };
  for (const std::string& id : pieces) {
    const std::string still = still_of(evaluation, id);
    const bool plain = still == id && !bone_taken;
    const glm::vec3 colour = plain ? bone_colour : accents[next_accent++ % accents.size()];
    bone_taken = bone_taken || plain;
    scene.moves = scene.moves || still != id;
    if (adds) {
      if (!is_added(plan, id)) show_before(origin_of(plan, evaluation, id));
    } else if (const Object* first = untouched(plan, evaluation, still)) {
      show_before(*first);
    } else {
      scene.before.push_back(drawn(evaluation.object(still), colour));
    }
    scene.after.push_back(drawn(evaluation.object(id), colour));
  }
  return scene;
}

DrawnView draw_view(const std::vector<voxel::DrawnObject>& objects,
                    const std::vector<voxel::DrawnObject>& framed, const std::string& view,
                    const glm::dmat3& lps_from_head, int size_px) {
  DrawnView drawn;
  drawn.frame.view = view;
  drawn.frame.axes = voxel::parse_view(view);
  if (lps_from_head != glm::dmat3(1.0))
    for (glm::dvec3* axis : {&drawn.frame.axes.look, &drawn.frame.axes.up, &drawn.frame.axes.right})
      *axis = lps_from_head * *axis;
  const Frame frame = frame_of(framed, drawn.frame.axes);
  drawn.frame.centre_mm = frame.centre_mm;
  drawn.frame.width_mm = frame.width_mm;
  drawn.frame.size_px = size_px;
  drawn.pixels = voxel::render(objects, options_of(drawn.frame.axes, frame, size_px));
  return drawn;
}

void draw(PictureGroup& group, const std::vector<std::string>& views,
          const std::vector<voxel::DrawnObject>& framed, int size_px, const glm::dmat3& lps_from_head) {
  if (group.objects.empty()) return;
  std::vector<DrawnView> drawn;
  for (const std::string& name : views)
    drawn.push_back(draw_view(group.objects, framed, name, lps_from_head, size_px));
  tbb::parallel_for(std::size_t{0}, drawn.size(), [&](std::size_t i) {
    drawn[i].frame.png = voxel::encode_image("png", drawn[i].pixels.size_px, drawn[i].pixels.rgb);
  });
  for (DrawnView& view : drawn) group.pictures.push_back(std::move(view.frame));
}

std::vector<std::string> all_views() {
  return {"anterior", "posterior", "left", "right", "superior", "inferior", "35,15", "-35,15"};
}

}  // namespace octotomy::planner
