// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/view_pane.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "planner/browser/server/jpeg.h"
#include "planner/browser/server/pane_fields.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/picture/drawn_files.h"
#include "planner/operation/picture/ray_pictures.h"
#include "planner/operation/table/field_json.h"
#include "voxel/scan/image_file.h"
#include "voxel/solid/combine.h"
#include "voxel/view/render.h"
#include "voxel/view/surface_scalar.h"

namespace octotomy::planner::serve {
namespace {

using Clock = std::chrono::steady_clock;

/// The smallest scale of a moving picture, relative to the pane. With fewer pixels nothing can be recognised.
constexpr double least_scale = 0.375;

/// Largest number of cached distance fields of a pane: two objects, and a few ranges of each.
constexpr std::size_t most_scalars = 8;
/// Number of colours in the legend.
constexpr int legend_colours = 9;

double ms_since(const Clock::time_point& start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::string view_text(const Json& view) {
  if (view.is_string()) return view;
  const double azimuth = number_of(view, "azimuth").value_or(0.0);
  const double elevation = number_of(view, "elevation").value_or(0.0);
  return exact(azimuth) + "," + exact(elevation);
}

/// The request as fields of the operation `render`.
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

/// A picture without depths. At rest its PNG states its frame, as pictures of `octotomy render` do.
Part flat_part(bool is_moving, const glm::ivec2& size_px, const std::vector<std::uint8_t>& rgb,
               const std::optional<PictureFrame>& frame = {}) {
  if (is_moving) return {"jpeg", jpeg_of(size_px, rgb)};
  const std::vector<std::uint8_t> png = voxel::encode_image("png", size_px, rgb, image_text(frame));
  return {"png", std::string(png.begin(), png.end())};
}

/// The command line that draws the same picture. Null unless the picture shows only a window on a scan that
/// no step has changed.
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

/// Adds a picture's quality, size and frame to its header.
void set_frame(Json& header, bool is_moving, const glm::ivec2& size_px, const voxel::View& view,
               const glm::dvec3& centre_mm, double pixel_mm) {
  header["quality"] = is_moving ? "moving" : "rest";
  header["width"] = size_px.x;
  header["height"] = size_px.y;
  header["view_frame"] = view_frame_json(view, centre_mm, pixel_mm);
}

/// Combines the grey pictures of both eyes: the left one in red, the right one in cyan.
std::vector<std::uint8_t> red_and_cyan(const std::vector<std::uint8_t>& left,
                                       const std::vector<std::uint8_t>& right) {
  // Luma of ITU-R BT.601 in 256ths; the weights add up to 256.
  const auto grey = [](const std::uint8_t* rgb) {
    return static_cast<std::uint8_t>((77 * rgb[0] + 150 * rgb[1] + 29 * rgb[2] + 128) >> 8);
  };
  std::vector<std::uint8_t> rgb(left.size());
  for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) {
    rgb[i] = grey(&left[i]);
    rgb[i + 1] = rgb[i + 2] = grey(&right[i]);
  }
  return rgb;
}

/// The point at a position of a view, on the plane through the origin.
glm::dvec3 on_plane(const voxel::View& view, const glm::dvec2& p_mm) {
  return view.right * p_mm.x + view.up * p_mm.y;
}

}  // namespace

/// Everything needed to draw one picture: its objects, its settings and its header.
struct ViewPane::Drawing {
  Snapshot snapshot;
  Render render;
  glm::vec3 background{1.0f};
  bool is_moving = false;
  Access access = Access::Edit;      ///< of the window that requested the picture
  bool is_of_plan = true;            ///< whether a step `render` of a plan can draw the same picture
  std::optional<double> stereo_deg;  ///< angle between the eyes, for red and cyan glasses
  std::vector<voxel::DrawnObject> objects;
  std::vector<const Object*> of_plan;      ///< those that are drawn
  const Object* last = nullptr;            ///< the last of them
  std::shared_ptr<const Evaluation> held;  ///< owns the objects of a preview while they are drawn
  Json header = Json::object();

  /// Adds an object with the colour and opacity of its entry in the request. An empty object is not drawn.
  void add(voxel::DrawnObject object, const std::string& id, const Json& entry) {
    if (object.octree.is_empty()) return;
    const std::string colour = entry.value("colour", text_of_colour(colour_of(objects.size())));
    const double opacity = number_of(entry, "opacity").value_or(1.0);
    if (!(opacity >= 0.0 && opacity <= 1.0)) throw std::runtime_error("opacity: must be from 0 to 1");
    object.name = id;
    object.colour = need_colour(colour);
    object.opacity = static_cast<float>(opacity);
    objects.push_back(std::move(object));
    render.objects.push_back({id});
    render.colours.push_back(colour);
    render.opacities.push_back(opacity);
    header["objects"].push_back(id);
  }

  /// A picture of the background only, for a request without objects to draw.
  Message blank() {
    const glm::ivec2 size_px = size_of(render);
    const glm::ivec3 colour(glm::round(255.0f * background));
    std::vector<std::uint8_t> rgb;
    for (int pixel = 0; pixel < size_px.x * size_px.y; ++pixel)
      for (int channel = 0; channel < 3; ++channel) rgb.push_back(static_cast<std::uint8_t>(colour[channel]));
    const voxel::Box box = voxel::bounds(snapshot.evaluation->universe.lattice());
    set_frame(header, is_moving, size_px, voxel::parse_view(render.view),
              render.centre_mm.value_or(0.5 * (box.low_mm + box.high_mm)),
              render.width_mm.value_or(box.high_mm.x - box.low_mm.x) / size_px.x);
    return packed(header, {flat_part(is_moving, size_px, rgb)});
  }

  /// A picture of values along rays through the samples of the first object that has samples. Its sides have
  /// `scale` times the pane's pixels.
  Message along_rays(double scale, const std::stop_token& stop) {
    Timings timings;
    const auto first = std::find_if(objects.begin(), objects.end(),
                                    [](const auto& object) { return object.grey.has_value(); });
    if (first == objects.end()) throw std::runtime_error("shading: no object that is shown has samples");
    Render drawn = render;
    const glm::ivec2 size_px =
        glm::max(glm::ivec2(1), glm::ivec2(glm::round(scale * glm::dvec2(size_of(render)))));
    drawn.size = std::to_string(size_px.x) + "x" + std::to_string(size_px.y);
    const RenderedPicture picture = render_rays(drawn, {*first}, timings, stop);
    const voxel::View view = voxel::parse_view(render.view);
    set_frame(header, is_moving, picture.size_px, view, on_plane(view, picture.centre_mm), picture.pixel_mm);
    return packed(header, {flat_part(is_moving, picture.size_px, picture.rgb, picture.frame)});
  }

  voxel::RenderOptions options() {
    std::optional<voxel::CutTones> tones;
    if (render.cut_face == "grey") tones = cut_tones_of(render, objects, of_plan);
    if (!tones) render.cut_face = "plain";
    voxel::RenderOptions made = options_of(render);
    made.background = background;
    made.cut_tones = std::move(tones);
    return made;
  }

  /// A picture for red and cyan glasses. `eye` draws the picture of one eye. The depths and objects of the
  /// frame remain those of the view between the eyes, from which positions under the pointer are computed.
  template <typename Eye>
  std::vector<std::uint8_t> in_stereo(voxel::RenderOptions made, const Eye& eye) const {
    std::array<std::vector<std::uint8_t>, 2> rgb;
    const std::array<voxel::View, 2> views = voxel::stereo_pair(made.view, *stereo_deg);
    for (std::size_t i = 0; i < views.size(); ++i) {
      made.view = views[i];
      if (render.centre_mm) made.centre_mm = made.view.project(*render.centre_mm);
      rgb[i] = eye(made);
    }
    return red_and_cyan(rgb[0], rgb[1]);
  }

  Message at_rest() {
    voxel::Picture picture = voxel::render(objects, options());
    if (stereo_deg)
      picture.rgb = in_stereo(options(), [&](const auto& made) { return voxel::render(objects, made).rgb; });
    const voxel::View& view = picture.view;
    set_frame(header, false, picture.size_px, view,
              on_plane(view, picture.centre_mm) +
                  view.look * glm::dot(render.centre_mm.value_or(glm::dvec3(0.0)), view.look),
              picture.pixel_mm);
    if (is_of_plan) {
      header["step"] = {{"do", "render"}};
      header["step"].update(print_fields(find_operation("render")->fields, &render));
      // A command names the scan's folder, which windows that only show the plan must not see.
      if (objects.size() == 1 && access == Access::Edit)
        header["command"] = command_of(*snapshot.plan, render, last);
    }
    std::vector<float> depth(picture.depth_mm.size());
    std::vector<std::uint16_t> object(picture.object.size());
    for (std::size_t i = 0; i < depth.size(); ++i) {
      depth[i] = std::isfinite(picture.depth_mm[i])
                     ? static_cast<float>(picture.depth_mm[i] + picture.nearest_mm)
                     : std::numeric_limits<float>::quiet_NaN();
      object[i] = static_cast<std::uint16_t>(picture.object[i] + 1);
    }
    return packed(header, {flat_part(false, picture.size_px, picture.rgb, frame_of(picture.plane())),
                           {"depth", deflated(depth.data(), 4 * depth.size())},
                           {"object", deflated(object.data(), 2 * object.size())}});
  }
};

voxel::DrawnObject ViewPane::threshold(Session& session, const Snapshot& snapshot, const Json& window) {
  const std::string name = window.value("scan", "ct");
  const auto scan = snapshot.evaluation->loaded.find(name);
  if (scan == snapshot.evaluation->loaded.end()) throw std::runtime_error("window: there is no such scan");
  const voxel::GreyOctree grey =
      window.value("alone", false) ? session.alone(snapshot, name) : scan->second->grey;
  const std::string text = window.dump();
  SampleWindow samples{number_of(window, "low").value_or(-std::numeric_limits<double>::infinity())};
  samples.high = number_of(window, "high");
  if (threshold_of_ != text || !threshold_ || threshold_->universe() != grey.universe()) {
    threshold_ = std::make_shared<const voxel::Octree>(
        voxel::combine(grey.universe(), voxel::Expression(window_on(grey, samples))));
    threshold_of_ = text;
  }
  voxel::DrawnObject object{"", *threshold_};
  if (!samples.high && std::isfinite(samples.low)) object.grey = grey;
  if (object.grey) object.threshold = samples.low;
  return object;
}

void ViewPane::add_objects(Session& session, const Json& said, Drawing& drawing,
                           const std::stop_token& stop) {
  const Evaluation& evaluation = *drawing.snapshot.evaluation;
  Session::Preview preview;
  std::string dragged;
  const Json asked = said.value("preview", Json());
  if (!asked.is_null()) {
    dragged = asked.at("object");
    const auto against = asked.value("against", std::vector<std::string>{});
    preview =
        session.preview(asked, said.value("overlap", false) ? against : std::vector<std::string>{}, stop);
    drawing.is_of_plan = false;
  }
  const Object* moved = preview.evaluation ? find(*preview.evaluation, Session::Preview::moved) : nullptr;
  const Json difference = difference_json(asked, preview);
  // The parts of the difference are drawn in place of the piece and the other object.
  if (!difference.is_null()) moved = nullptr;
  const auto is_in_parts = [&](const std::string& id) {
    return !difference.is_null() && (id == dragged || id == difference["to"]);
  };
  for (const Json& entry : said.value("objects", Json::array())) {
    if (entry.contains("window")) {
      drawing.is_of_plan = false;
      drawing.add(threshold(session, drawing.snapshot, entry.at("window")), "", entry);
      continue;
    }
    const std::string id = entry.at("id");
    if (is_in_parts(id)) continue;
    const bool is_dragged = moved != nullptr && id == dragged;
    if (const Object* object = is_dragged ? std::exchange(moved, nullptr) : find(evaluation, id)) {
      drawing.last = object;
      drawing.of_plan.push_back(object);
      drawing.add(planner::drawn(*object, glm::vec3(1.0f)), id, entry);
    }
  }
  if (!preview.evaluation) return;
  Session::describe(preview, drawing.header);
  if (moved != nullptr) {
    drawing.of_plan.push_back(moved);
    Json entry = Json::object();
    if (asked.contains("colour")) entry["colour"] = asked["colour"];
    drawing.add(planner::drawn(*moved, glm::vec3(1.0f)), dragged, entry);
  }
  if (!difference.is_null()) {
    drawing.header["difference"] = difference;
    for (const DifferencePart& part : difference_parts)
      drawing.add({part.id, preview.evaluation->object(part.id).voxel.octree},
                  part.id == Session::Preview::only_other ? difference["to"].get<std::string>() : dragged,
                  {{"colour", part.colour}});
  }
  if (const Object* both = find(*preview.evaluation, Session::Preview::overlap)) {
    drawing.header["overlap_mm3"] = both->voxel.measures.volume_mm3;
    drawing.add({"overlap", both->voxel.octree}, "", {{"colour", text_of_colour(interference_colour())}});
  }
  drawing.held = preview.evaluation;
}

void ViewPane::colour(const Json& colour_by, Drawing& drawing) {
  const std::string of = colour_by.at("object"), reference = colour_by.at("reference");
  const double range_mm = number_of(colour_by, "range_mm").value_or(5.0);
  if (!(range_mm > 0.0)) throw std::runtime_error("range_mm: must be above zero");
  const bool is_mutual = colour_by.value("mutual", false);
  if (scalar_evaluation_ != drawing.snapshot.evaluation || scalars_.size() > most_scalars) scalars_.clear();
  scalar_evaluation_ = drawing.snapshot.evaluation;
  const auto by = [&](const std::string& coloured, const std::string& to) {
    const Object* other = find(*drawing.snapshot.evaluation, to);
    if (other == nullptr) throw std::runtime_error("colour_by: '" + to + "' is not evaluated");
    for (voxel::DrawnObject& object : drawing.objects) {
      if (object.name != coloured) continue;
      auto& scalar = scalars_[coloured + " " + to + " " + exact(range_mm)];
      if (!scalar)
        scalar = std::make_shared<const voxel::SurfaceScalar>(
            voxel::distance_to(other->voxel.octree, object.octree, range_mm));
      object.scalar = scalar;
    }
  };
  by(of, reference);
  if (is_mutual) by(reference, of);
  Json colours = Json::array();
  for (const glm::vec3& each : voxel::diverging_colours(legend_colours))
    colours.push_back(text_of_colour(each));
  drawing.header["legend"] = {
      {"low_mm", -range_mm},
      {"high_mm", range_mm},
      {"colours", colours},
      {"definition", "distance of each surface point to the nearest of '" + reference + "'" +
                         (is_mutual ? ", and the reverse" : "") + ", positive outside of it"}};
  drawing.render.colour_by = "distance:" + reference;
  drawing.render.range_mm = range_mm;
  // `render` colours only its first object, so it could not draw this picture.
  if (is_mutual || drawing.objects.front().name != of) drawing.is_of_plan = false;
}

Message ViewPane::draw(Session& session, const Request& request, double most_ms,
                       const std::stop_token& stop) {
  const Json& said = request.said;
  const Clock::time_point start = Clock::now();
  Drawing drawing;
  drawing.snapshot = session.snapshot();
  drawing.render = render_of(said);
  if (!drawing.snapshot.evaluation) throw std::runtime_error("no plan is open");
  drawing.is_moving = said.value("dragging", false);
  drawing.access = request.access;
  drawing.stereo_deg = number_of(said, "stereo_deg");
  if (drawing.stereo_deg) {
    if (!(*drawing.stereo_deg >= 0.1 && *drawing.stereo_deg <= 30.0))
      throw std::runtime_error("stereo_deg: must be from 0.1 to 30");
    if (is_ray_picture(drawing.render)) throw std::runtime_error("stereo_deg: needs a shading of surfaces");
    drawing.is_of_plan = false;
  }
  drawing.header = {{"id", request.id}, {"pane", said.value("pane", 0)}, {"objects", Json::array()}};
  if (const auto background = said.find("background"); background != said.end() && background->is_string()) {
    drawing.background = need_colour(*background);
    drawing.is_of_plan = false;
  }
  add_objects(session, said, drawing, stop);
  if (drawing.objects.empty()) return drawing.blank();
  if (is_ray_picture(drawing.render)) return along_rays(drawing, most_ms, stop);
  if (const Json colour_by = said.value("colour_by", Json()); colour_by.is_object())
    colour(colour_by, drawing);
  if (stop.stop_requested()) throw Stopped("stopped before the picture was drawn");
  if (!drawing.is_moving) return drawing.at_rest();
  // The time that the preview took is subtracted from the time for drawing.
  return moving(drawing, std::max(0.3 * most_ms, most_ms - ms_since(start)));
}

/// A multiple of 1/8, so that the size of frames does not change with every frame.
double ViewPane::scale_within(double most_ms) const {
  return full_frame_ms_ > most_ms
             ? std::max(least_scale, std::floor(8.0 * std::sqrt(most_ms / full_frame_ms_)) / 8.0)
             : 1.0;
}

void ViewPane::learn_frame_time(const Clock::time_point& start, double scale) {
  const double spent_ms = ms_since(start) / (scale * scale);
  full_frame_ms_ = full_frame_ms_ == 0.0 ? spent_ms : 0.8 * full_frame_ms_ + 0.2 * spent_ms;
}

Message ViewPane::along_rays(Drawing& drawing, double most_ms, const std::stop_token& stop) {
  if (!drawing.is_moving) return drawing.along_rays(1.0, stop);
  // Before the first frame, the time of a frame is unknown, so the smallest scale is used.
  const double scale = full_frame_ms_ == 0.0 ? least_scale : scale_within(most_ms);
  const Clock::time_point start = Clock::now();
  Message message = drawing.along_rays(scale, stop);
  learn_frame_time(start, scale);
  return message;
}

Message ViewPane::moving(Drawing& drawing, double most_ms) {
  voxel::RenderOptions options = drawing.options();
  options.antialias = false;
  const double scale = scale_within(most_ms);
  options.size_px = glm::max(glm::ivec2(1), glm::ivec2(glm::round(scale * glm::dvec2(options.size_px))));
  const Clock::time_point start = Clock::now();
  voxel::Picture picture = renderer_.frame(drawing.objects, options);
  if (drawing.stereo_deg)
    picture.rgb = drawing.in_stereo(
        options, [&](const auto& made) { return renderer_.frame(drawing.objects, made).rgb; });
  const Part jpeg = flat_part(true, picture.size_px, picture.rgb);
  learn_frame_time(start, scale);
  set_frame(drawing.header, true, picture.size_px, picture.view, on_plane(picture.view, picture.centre_mm),
            picture.pixel_mm);
  return packed(drawing.header, {jpeg});
}

}  // namespace octotomy::planner::serve
