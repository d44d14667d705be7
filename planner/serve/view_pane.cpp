// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/serve/view_pane.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "planner/operation/segment.h"
#include "planner/picture/colour.h"
#include "planner/picture/drawn_files.h"
#include "planner/picture/ray_pictures.h"
#include "planner/serve/jpeg.h"
#include "planner/serve/pane_fields.h"
#include "planner/table/field_json.h"
#include "voxel/scan/image_file.h"
#include "voxel/solid/combine.h"
#include "voxel/view/render.h"

namespace octotomy::planner::serve {
namespace {

using Clock = std::chrono::steady_clock;

/// Coarser than this share along each side, a moving picture shows nothing of a plan.
constexpr double least_scale = 0.375;

constexpr const char* overlap_colour = "#e5484d";

double ms_since(const Clock::time_point& start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::string view_text(const Json& view) {
  if (view.is_string()) return view;
  const double azimuth = number_of(view, "azimuth").value_or(0.0);
  const double elevation = number_of(view, "elevation").value_or(0.0);
  return exact(azimuth) + "," + exact(elevation);
}

/// The picture as the operation `render` has it.
Render render_of(const Json& said) {
  Render render;
  const glm::ivec2 size_px = size_px_of(said);
  render.path = "view.png";
  render.size = std::to_string(size_px.x) + "x" + std::to_string(size_px.y);
  if (said.contains("view")) render.view = view_text(said["view"]);
  if (const auto pixel_mm = number_of(said, "pixel_mm")) {
    if (!(*pixel_mm > 0.0)) throw std::runtime_error("pixel_mm: must be above zero");
    render.width_mm = *pixel_mm * size_px.x;
  }
  render.centre_mm = point_of(said, "centre_mm");
  if (said.contains("shading")) render.shading = said["shading"];
  for (const Json& plane : said.value("cut_planes", Json::array())) {
    if (plane.is_string()) {
      render.cut_planes.push_back(plane);
      continue;
    }
    std::string text;
    for (const Json& number : plane) text += (text.empty() ? "" : ",") + exact(number.get<double>());
    render.cut_planes.push_back(text);
  }
  if (!render.cut_planes.empty()) render.cut_face = said.value("cut_face", "plain");
  return render;
}

const Object* find(const Evaluation& evaluation, const std::string& id) {
  for (const Object& object : evaluation.objects)
    if (object.id == id) return &object;
  return nullptr;
}

/// A picture without depths.
Part flat_part(bool is_moving, const glm::ivec2& size_px, const std::vector<std::uint8_t>& rgb) {
  if (is_moving) return {"jpeg", jpeg_of(size_px, rgb)};
  const std::vector<std::uint8_t> png = voxel::encode_image("png", size_px, rgb);
  return {"png", std::string(png.begin(), png.end())};
}

/// The verb's command for one window of a scan as it was read, where the picture is that.
Json command_of(const Plan& plan, const Render& render, const Object* object) {
  const Step* step = nullptr;
  for (const Step& each : plan.steps)
    if (object != nullptr && each.id == object->id) step = &each;
  if (step == nullptr || verb(*step) != "window" || !object->shown) return nullptr;
  const auto scan = plan.scans.find(object->shown->scan);
  if (scan == plan.scans.end()) return nullptr;
  const Json fields = print_fields(step->action.operation().fields, const_cast<void*>(step->action.value()));
  std::string text = "octotomy render '" + scan_path(plan, scan->second).string() +
                     "' -o view.png --window " + exact(object->shown->threshold) + ":" +
                     (fields.contains("high") ? exact(fields["high"].get<double>()) : "");
  if (plan.voxel_mm) text += " --voxel " + exact(*plan.voxel_mm);
  text += " --view=" + render.view + " --size " + render.size;
  if (render.width_mm) text += " --width " + exact(*render.width_mm);
  if (const auto& centre = render.centre_mm)
    text += " --centre=" + exact(centre->x) + "," + exact(centre->y) + "," + exact(centre->z);
  for (const std::string& plane : render.cut_planes) text += " --cut-plane=" + plane;
  if (render.cut_face != "plain") text += " --cut-face " + render.cut_face;
  text += " --shading " + render.shading + " --colour '" + render.colours.front() + "' --opacity " +
          exact(render.opacities.front());
  return text;
}

}  // namespace

/// What is drawn, and how it is said.
struct ViewPane::Drawing {
  Render render;
  voxel::RenderOptions options;
  std::vector<voxel::DrawnObject> objects;
  Json header;
  voxel::Universe universe;
};

voxel::Octree ViewPane::threshold(const Evaluation& evaluation, const Json& window) {
  const auto scan = evaluation.loaded.find(window.value("scan", "ct"));
  if (scan == evaluation.loaded.end()) throw std::runtime_error("window: there is no such scan");
  const std::string text = window.dump();
  if (threshold_of_ != text || !threshold_ || threshold_->universe() != evaluation.universe) {
    SampleWindow samples{number_of(window, "low").value_or(-std::numeric_limits<double>::infinity())};
    samples.high = number_of(window, "high");
    threshold_ = std::make_shared<const voxel::Octree>(
        voxel::combine(evaluation.universe, voxel::Expression(window_on(scan->second->grey, samples))));
    threshold_of_ = text;
  }
  return *threshold_;
}

Message ViewPane::draw(Desk& desk, const Request& request, double most_ms, const std::stop_token& stop) {
  const Json& said = request.said;
  const Clock::time_point start = Clock::now();
  const Snapshot snapshot = desk.snapshot();
  if (!snapshot.evaluation) throw std::runtime_error("no plan is open");
  const bool is_moving = said.value("dragging", false);
  Drawing drawing{render_of(said), {}, {}, Json::object(), snapshot.evaluation->universe};
  const bool is_plain = said.value("preview", Json()).is_null();
  Desk::Preview preview;
  std::string replaced;
  if (!is_plain) {
    const Json& asked = said["preview"];
    replaced = asked.at("object");
    preview = desk.preview(asked.value("of", replaced), asked.at("move"),
                           said.value("overlap", false) ? asked.value("against", std::vector<std::string>{})
                                                        : std::vector<std::string>{},
                           stop);
  }
  Json ids = Json::array();
  bool all_of_plan = true;
  const Object* last = nullptr;
  const auto add = [&](voxel::DrawnObject object, const std::string& id, const Json& entry) {
    const std::string colour = entry.value("colour", text_of_colour(colour_of(drawing.objects.size())));
    const double opacity = number_of(entry, "opacity").value_or(1.0);
    if (!(opacity >= 0.0 && opacity <= 1.0)) throw std::runtime_error("opacity: must be from 0 to 1");
    object.name = id;
    object.colour = need_colour(colour);
    object.opacity = static_cast<float>(opacity);
    drawing.objects.push_back(std::move(object));
    drawing.render.objects.push_back({id});
    drawing.render.colours.push_back(colour);
    drawing.render.opacities.push_back(opacity);
    ids.push_back(id);
  };
  bool has_replaced = false;
  for (const Json& entry : said.value("objects", Json::array())) {
    if (entry.contains("window")) {
      voxel::DrawnObject object{"threshold", threshold(*snapshot.evaluation, entry["window"])};
      if (!entry["window"].contains("high") || entry["window"]["high"].is_null()) {
        object.grey = snapshot.evaluation->loaded.at(entry["window"].value("scan", "ct"))->grey;
        object.threshold = number_of(entry["window"], "low").value_or(0.0);
      }
      all_of_plan = false;
      if (!object.octree.is_empty()) add(std::move(object), "", entry);
      continue;
    }
    const std::string id = entry.at("id");
    const bool is_dragged = preview.evaluation && id == replaced;
    has_replaced = has_replaced || is_dragged;
    const Object* object =
        is_dragged ? find(*preview.evaluation, Desk::Preview::moved) : find(*snapshot.evaluation, id);
    if (object == nullptr || object->voxel.octree.is_empty()) continue;
    last = object;
    add(planner::drawn(*object, glm::vec3(1.0f)), id, entry);
  }
  if (preview.evaluation && !has_replaced) {
    const Object* object = find(*preview.evaluation, Desk::Preview::moved);
    if (object != nullptr && !object->voxel.octree.is_empty())
      add(planner::drawn(*object, glm::vec3(1.0f)), replaced, Json::object());
  }
  if (preview.evaluation) {
    if (const Object* both = find(*preview.evaluation, Desk::Preview::overlap)) {
      drawing.header["overlap_mm3"] = both->voxel.measures.volume_mm3;
      // Drawn as voxels, which lie in both surfaces: nearer than either by what tracing tells apart.
      if (!both->voxel.octree.is_empty())
        add({"overlap", both->voxel.octree}, "", {{"colour", overlap_colour}});
    }
  }
  drawing.header["id"] = request.id;
  drawing.header["pane"] = said.value("pane", 0);
  drawing.header["objects"] = ids;
  if (const auto background = said.find("background"); background != said.end() && background->is_string()) {
    drawing.options.background = need_colour(*background);
    all_of_plan = false;
  }
  const glm::vec3 background = drawing.options.background;
  const Json colour_by = said.value("colour_by", Json());
  if (colour_by.is_object() && !drawing.objects.empty()) {
    const std::string of = colour_by.at("object"), reference = colour_by.at("reference");
    const double range_mm = number_of(colour_by, "range_mm").value_or(5.0);
    const Object* other = find(*snapshot.evaluation, reference);
    if (other == nullptr) throw std::runtime_error("colour_by: '" + reference + "' is not evaluated");
    for (voxel::DrawnObject& object : drawing.objects) {
      if (object.name != of) continue;
      const std::string key = of + " " + reference + " " + exact(range_mm);
      if (scalar_of_ != key || scalar_evaluation_ != snapshot.evaluation)
        scalar_ = std::make_shared<const voxel::SurfaceScalar>(
            voxel::distance_to(other->voxel.octree, object.octree, range_mm));
      scalar_of_ = key;
      scalar_evaluation_ = snapshot.evaluation;
      object.scalar = scalar_;
    }
    drawing.header["legend"] = {{"low_mm", -range_mm},
                                {"high_mm", range_mm},
                                {"definition", "distance of each surface point to the nearest of '" +
                                                   reference + "', positive outside of it"}};
    drawing.render.colour_by = "distance:" + reference;
    drawing.render.range_mm = range_mm;
    if (drawing.objects.front().name != of) all_of_plan = false;
  }
  const glm::ivec2 size_px = size_of(drawing.render);
  if (drawing.objects.empty()) {
    // Nothing to draw is a picture, too.
    const std::vector<std::uint8_t> blank(
        3 * static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y),
        static_cast<std::uint8_t>(std::lround(255.0f * background.x)));
    const voxel::View view = voxel::parse_view(drawing.render.view);
    const voxel::Box box = voxel::bounds(drawing.universe.lattice());
    const double pixel_mm =
        drawing.render.width_mm.value_or(box.high_mm.x - box.low_mm.x) / static_cast<double>(size_px.x);
    drawing.header["view_frame"] =
        view_frame_json(view, drawing.render.centre_mm.value_or(0.5 * (box.low_mm + box.high_mm)), pixel_mm);
    drawing.header["quality"] = is_moving ? "moving" : "rest";
    drawing.header["width"] = size_px.x;
    drawing.header["height"] = size_px.y;
    return packed(drawing.header, {flat_part(is_moving, size_px, blank)});
  }
  if (is_ray_picture(drawing.render)) {
    Timings timings;
    std::vector<voxel::DrawnObject> with_samples;
    for (const voxel::DrawnObject& object : drawing.objects)
      if (object.grey && with_samples.empty()) with_samples.push_back(object);
    const RenderedPicture picture = render_rays(drawing.render, with_samples, timings, stop);
    drawing.header["quality"] = is_moving ? "moving" : "rest";
    drawing.header["width"] = picture.size_px.x;
    drawing.header["height"] = picture.size_px.y;
    const voxel::View view = voxel::parse_view(drawing.render.view);
    drawing.header["view_frame"] = view_frame_json(
        view, view.right * picture.centre_mm.x + view.up * picture.centre_mm.y, picture.pixel_mm);
    return packed(drawing.header, {flat_part(is_moving, picture.size_px, picture.rgb)});
  }
  drawing.options = options_of(drawing.render);
  drawing.options.background = background;
  if (drawing.render.cut_face == "grey") {
    const bool has_samples = std::any_of(drawing.objects.begin(), drawing.objects.end(),
                                         [](const auto& object) { return object.grey.has_value(); });
    if (has_samples)
      drawing.options.cut_tones = cut_tones_of(drawing.render, drawing.objects);
    else
      drawing.render.cut_face = "plain";
  }
  // A piece that is dragged is moved first; what that takes is left out of drawing.
  if (is_moving) return moving(drawing, drawing.header, std::max(0.3 * most_ms, most_ms - ms_since(start)));

  const voxel::Picture picture = voxel::render(drawing.objects, drawing.options);
  if (stop.stop_requested()) throw Stopped("a newer picture of the pane is wanted");
  Json& header = drawing.header;
  header["quality"] = "rest";
  header["width"] = picture.size_px.x;
  header["height"] = picture.size_px.y;
  const voxel::View& view = drawing.options.view;
  const glm::dvec3 wanted = drawing.render.centre_mm.value_or(glm::dvec3(0.0));
  header["view_frame"] = view_frame_json(view,
                                         view.right * picture.centre_mm.x + view.up * picture.centre_mm.y +
                                             view.look * glm::dot(wanted, view.look),
                                         picture.pixel_mm);
  if (all_of_plan && is_plain) {
    const Operation& operation = *find_operation("render");
    Json step{{"do", "render"}};
    step.update(print_fields(operation.fields, &drawing.render));
    header["step"] = step;
    if (drawing.objects.size() == 1) header["command"] = command_of(*snapshot.plan, drawing.render, last);
  }
  std::vector<float> depth(picture.depth_mm.size());
  std::vector<std::uint16_t> object(picture.object.size());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = std::isfinite(picture.depth_mm[i])
                   ? static_cast<float>(picture.depth_mm[i] + picture.nearest_mm)
                   : std::numeric_limits<float>::quiet_NaN();
    object[i] = static_cast<std::uint16_t>(picture.object[i] + 1);
  }
  const std::vector<std::uint8_t> png = voxel::encode_image("png", picture.size_px, picture.rgb);
  return packed(header, {{"png", std::string(png.begin(), png.end())},
                         {"depth", deflated(depth.data(), 4 * depth.size())},
                         {"object", deflated(object.data(), 2 * object.size())}});
}

Message ViewPane::moving(const Drawing& drawing, Json header, double most_ms) {
  voxel::RenderOptions options = drawing.options;
  options.antialias = false;
  const glm::ivec2 full_px = options.size_px;
  // In eighths, so that frames do not change their size all the time.
  const double scale =
      full_frame_ms_ > most_ms
          ? std::max(least_scale, std::floor(8.0 * std::sqrt(most_ms / full_frame_ms_)) / 8.0)
          : 1.0;
  options.size_px = glm::max(glm::ivec2(1), glm::ivec2(glm::round(scale * glm::dvec2(full_px))));
  const Clock::time_point start = Clock::now();
  const voxel::Picture picture = renderer_.frame(drawing.objects, options);
  std::string jpeg = jpeg_of(picture.size_px, picture.rgb);
  const double spent_ms = ms_since(start) / (scale * scale);
  full_frame_ms_ = full_frame_ms_ == 0.0 ? spent_ms : 0.8 * full_frame_ms_ + 0.2 * spent_ms;
  header["quality"] = "moving";
  header["width"] = picture.size_px.x;
  header["height"] = picture.size_px.y;
  const voxel::View& view = options.view;
  header["view_frame"] = view_frame_json(
      view, view.right * picture.centre_mm.x + view.up * picture.centre_mm.y, picture.pixel_mm);
  return packed(std::move(header), {{"jpeg", std::move(jpeg)}});
}

}  // namespace octotomy::planner::serve
