// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 Choose the visible objects: those of the step and, as context, the one that is cut.
// 2 Evaluate the steps that these need.
// 3 Remove the step's objects from the context, so that each voxel is drawn once.
// 4 Draw all views in one frame.
#include "planner/result/report/preview.h"

#include <algorithm>

#include "planner/operation/picture/removed_picture.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/plan/dependence.h"
#include "voxel/scan/image_file.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

constexpr glm::vec3 accent{0.20f, 0.56f, 0.72f};
constexpr glm::vec3 mark{0.87f, 0.30f, 0.20f};
constexpr double ball_mm = 2.0;  ///< radius of the ball that shows a landmark

const Step& step_of(const Plan& plan, const std::string& id) {
  std::vector<std::string> known;
  for (const Step& step : plan.steps) {
    if (step.id == id) return step;
    known.push_back(step.id);
  }
  throw std::runtime_error("the plan has no step called '" + id + "'" + suggestion(id, known));
}

bool is_piece(const Step& step) {
  return step.action.operation().makes == Makes::Object && !step.action.operation().is_tool;
}

/// The id of the first piece from which a step's result is made; empty if there is none.
std::string origin_of(const Plan& plan, const std::string& id) {
  const std::set<std::string> needed = needed_for(plan, {id});
  for (const Step& step : plan.steps)
    if (is_piece(step) && needed.contains(step.id)) return step.id == id ? "" : step.id;
  return "";
}

/// The id of the piece that a mask cuts: the first piece that a later step combines with it, or else the last
/// piece before the mask.
std::string cut_by(const Plan& plan, const std::string& mask) {
  std::string last;
  bool is_before = true;
  for (const Step& step : plan.steps) {
    if (step.id == mask) is_before = false;
    if (is_before && is_piece(step)) last = step.id;
    const std::vector<std::string> used = objects_used(step.action);
    if (is_before || std::find(used.begin(), used.end(), mask) == used.end()) continue;
    for (const std::string& name : used)
      if (is_piece(step_of(plan, name))) return name;
  }
  return last;
}

/// The visible objects: those in colour, and the piece that is drawn pale around them.
struct Seen {
  std::vector<std::string> objects;
  std::string context;
};

Seen seen_of(const Plan& plan, const Step& step) {
  const Operation& operation = step.action.operation();
  switch (operation.makes) {
    case Makes::Object:
      return {{step.id}, operation.is_tool ? cut_by(plan, step.id) : origin_of(plan, step.id)};
    case Makes::Names: {
      const auto first = std::find_if(plan.steps.begin(), plan.steps.end(), is_piece);
      return {{}, first == plan.steps.end() ? "" : first->id};
    }
    default: {
      Seen seen{objects_used(step.action), ""};
      if (!seen.objects.empty()) seen.context = origin_of(plan, seen.objects.front());
      return seen;
    }
  }
}

voxel::DrawnObject part(const Object& object, const voxel::Octree& octree, const glm::vec3& colour) {
  voxel::DrawnObject part = drawn(object, colour);
  part.octree = octree;
  return part;
}

/// The objects to draw: those in colour, and the context without them. The context also lacks them at their
/// positions before a motion.
std::vector<voxel::DrawnObject> scene_of(const Plan& plan, const Step& step, const Seen& seen,
                                         const Evaluation& evaluation) {
  std::vector<voxel::DrawnObject> scene;
  const voxel::Universe& universe = evaluation.universe;
  const bool is_tool = step.action.operation().is_tool;
  if (!seen.context.empty()) {
    const Object& context = evaluation.object(seen.context);
    voxel::Octree rest = context.voxel.octree;
    for (const std::string& name : seen.objects) {
      const Object* object = &evaluation.object(name);
      while (object->moved) object = &evaluation.object(object->moved->object);
      if (is_tool) {
        const voxel::Expression& held = *object->voxel.symbol;
        scene.push_back(part(context, voxel::combine(universe, voxel::Expression(rest) & held), accent));
        rest = voxel::combine(universe, voxel::Expression(rest) - held);
      } else {
        rest = voxel::combine(universe, voxel::Expression(rest) - voxel::Expression(object->voxel.octree));
      }
    }
    scene.insert(scene.begin(), part(context, rest, bone_colour));
  }
  for (const std::string& name : seen.objects)
    if (!is_tool || seen.context.empty())
      scene.push_back(drawn(evaluation.object(name), seen.context.empty() ? bone_colour : accent));
  if (step.action.operation().makes == Makes::Names)
    for (const NamedPoint& landmark : plan.landmarks) {
      Object ball(landmark.name, "landmark", universe);
      ball.voxel.octree = voxel::combine(universe, voxel::Expression(voxel::Sphere{landmark.p_mm, ball_mm}));
      scene.push_back(drawn(ball, mark));
    }
  std::erase_if(scene, [](const voxel::DrawnObject& object) { return object.octree.is_empty(); });
  return scene;
}

/// A picture of the scan before a step, with the samples that the step changes in red.
Preview changes(const Plan& plan, const Step& step, EvaluateOptions options) {
  options.wanted = {step.id};
  options.keep_scans = true;
  options.meshes = options.certify = false;
  Preview made{evaluate(plan, options), {}, {}, {}};
  const auto scene = [&](const std::string& name) -> const voxel::Scene& {
    return made.evaluation.loaded.at(name)->scene();
  };
  const voxel::Scene &before = scene(scans_used(step.action).front()), &after = scene(step.id);
  if (before.lattice != after.lattice || before.samples.index() != 0 || after.samples.index() != 0)
    throw std::runtime_error("'" + step.id +
                             "' makes a scan of other voxels, so that no change can be drawn: preview a step "
                             "that uses it, or draw the scan by octotomy slice");
  const Stopwatch watch(made.evaluation.timings, "render");
  const RemovedPicture picture = removed_picture(before, after);
  made.png = voxel::encode_image("png", picture.size_px, picture.rgb);
  return made;
}

}  // namespace

Preview preview(const Plan& plan, const std::string& id, const PreviewOptions& options) {
  const Step& step = step_of(plan, id);
  if (step.action.operation().makes == Makes::Scan) return changes(plan, step, options.evaluation);
  const Seen seen = seen_of(plan, step);
  EvaluateOptions evaluation = options.evaluation;
  evaluation.wanted = seen.objects;
  if (!seen.context.empty()) evaluation.wanted.push_back(seen.context);
  if (evaluation.wanted.empty())
    throw std::runtime_error("'" + id + "' uses no object, so that there is nothing to draw");
  evaluation.meshes = evaluation.certify = false;
  Preview made{evaluate(plan, evaluation), {}, {}, {}};
  const Stopwatch watch(made.evaluation.timings, "render");
  made.objects = scene_of(plan, step, seen, made.evaluation);
  const int size = options.size_px, count = static_cast<int>(options.views.size());
  std::vector<std::uint8_t> rgb(static_cast<std::size_t>(size) * static_cast<std::size_t>(size * count) * 3,
                                255);
  for (int number = 0; number < count; ++number) {
    const DrawnView view =
        draw_view(made.objects, made.objects, options.views[static_cast<std::size_t>(number)],
                  made.evaluation.objects.lps_from_head, size);
    made.frames.push_back(view.frame);
    const std::size_t row = static_cast<std::size_t>(size) * 3;
    for (std::size_t y = 0; y < static_cast<std::size_t>(size); ++y)
      std::copy_n(
          view.pixels.rgb.begin() + static_cast<std::ptrdiff_t>(y * row), row,
          rgb.begin() + static_cast<std::ptrdiff_t>(
                            (y * static_cast<std::size_t>(count) + static_cast<std::size_t>(number)) * row));
  }
  made.png = voxel::encode_image("png", {size * count, size}, rgb);
  return made;
}

}  // namespace octotomy::planner
