// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/renderer.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "voxel/view/layer.h"

namespace octotomy::voxel {
namespace {

bool same_samples(const std::optional<GreyOctree>& a, const std::optional<GreyOctree>& b) {
  // Grey octrees are immutable and shared, so the same storage means the same samples. If equal octrees are
  // stored twice, the only cost is an unnecessary trace.
  return a.has_value() == b.has_value() && (!a || &a->universe() == &b->universe());
}

// The comparisons bind every field by name, so that code with a new field does not compile until the field is
// compared here.

bool same_expression(const std::optional<Expression>& a, const std::optional<Expression>& b) {
  return a.has_value() == b.has_value() && (!a || &a->term() == &b->term());
}

/// Whether two objects have the same surface, in any colour.
bool same_shape(const DrawnObject& a, const DrawnObject& b) {
  const auto& [name, octree, colour, grey, threshold, moved_from_still, opacity, counted_in_grey, inside,
               scalar, unbuilt] = a;
  return octree == b.octree && same_expression(unbuilt, b.unbuilt) && same_samples(grey, b.grey) &&
         threshold == b.threshold && moved_from_still == b.moved_from_still;
}

/// Whether two objects of the same shape have the same colour, opacity and scalar.
bool same_look(const DrawnObject& a, const DrawnObject& b) {
  return a.colour == b.colour && a.opacity == b.opacity && a.scalar == b.scalar;
}

bool same_cut(const Cutaway& a, const Cutaway& b) {
  if (a.index() != b.index()) return false;
  if (const auto* plane = std::get_if<HalfSpace>(&a))
    return plane->normal == std::get<HalfSpace>(b).normal &&
           plane->offset_mm == std::get<HalfSpace>(b).offset_mm;
  return std::get<Box>(a).low_mm == std::get<Box>(b).low_mm &&
         std::get<Box>(a).high_mm == std::get<Box>(b).high_mm;
}
bool same_cuts(const std::vector<Cutaway>& a, const std::vector<Cutaway>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_cut);
}

bool same_lights(const std::vector<Light>& a, const std::vector<Light>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Light& one, const Light& other) {
    return one.towards == other.towards && one.strength == other.strength;
  });
}

bool same_tones(const std::optional<CutTones>& a, const std::optional<CutTones>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->samples.is_same(b->samples) && a->black == b->black && a->white == b->white;
}

bool same_densities(const std::optional<Densities>& a, const std::optional<Densities>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return same_tones(a->tones, b->tones) &&
         std::equal(a->colours.begin(), a->colours.end(), b->colours.begin(), b->colours.end(),
                    [](const DensityColour& one, const DensityColour& other) {
                      return one.low == other.low && one.high == other.high && one.colour == other.colour;
                    });
}

/// Whether two sets of options lead from the same layers to the same picture.
bool same_style(const RenderOptions& a, const RenderOptions& b) {
  const auto& [view, size_px, centre_mm, width_mm, eye_mm, algorithm, shading, background, cuts, cut_tones,
               lights, occlusion, count, antialias, ambient, gloss, exponent, densities] = a;
  return shading == b.shading && background == b.background && occlusion == b.occlusion &&
         antialias == b.antialias && same_lights(lights, b.lights) && same_tones(cut_tones, b.cut_tones) &&
         ambient == b.ambient && gloss == b.gloss && exponent == b.exponent &&
         same_densities(densities, b.densities);
}

bool same_view(const View& a, const View& b) {
  const auto& [look, up, right] = a;
  return look == b.look && up == b.up && right == b.right;
}

/// Whether two pictures have the same plane and algorithm.
bool same_plane(const Picture& a, const Picture& b) {
  // Within one universe and view, the eye's distance determines the eye.
  const auto eye_mm = [](const Picture& picture) { return picture.eye ? picture.eye->distance_mm : 0.0; };
  return eye_mm(a) == eye_mm(b) && a.size_px == b.size_px && a.pixel_mm == b.pixel_mm &&
         a.centre_mm == b.centre_mm && a.nearest_mm == b.nearest_mm && a.algorithm == b.algorithm &&
         same_view(a.view, b.view);
}

}  // namespace

/// The cached layers and the last picture, for each size.
class Renderer::Stages {
 public:
  Tally tally;

  /// Whether all layers of the full picture are cached.
  bool has_all_layers(const std::vector<DrawnObject>& objects, const RenderOptions& options) {
    const Stage& stage = stages_.back();
    if (!is_of(stage, blank_picture(objects, options), options.cuts)) return false;
    return std::all_of(objects.begin(), objects.end(), [&](const DrawnObject& object) {
      return object.opacity <= 0.0f || find(stage, as_shaded(object, options.shading)) != nullptr;
    });
  }

  /// Draws the picture of a size; the last size is the full one. Throws Stopped.
  Picture draw(std::size_t number, const std::vector<DrawnObject>& objects, RenderOptions options,
               const Progress& progress) {
    Stage& stage = stages_[number];
    if (number + 1 < stages_.size()) {
      const int step = 2 << (stages_.size() - 2 - number);
      // All sizes have the frame of the full picture, so that the picture does not jump.
      const Picture whole = blank_picture(objects, options);
      options.centre_mm = whole.centre_mm;
      options.width_mm = whole.pixel_mm * whole.size_px.x;
      options.size_px = (options.size_px + (step - 1)) / step;
      options.antialias = false;
    }
    const Picture blank = blank_picture(objects, options);
    if (!is_of(stage, blank, options.cuts)) stage = Stage{blank, options.cuts, {}, {}};
    const ImagePlane plane = plane_of(objects, blank);
    bool all_kept = stage.last && same_style(options, stage.last->options) &&
                    objects.size() == stage.last->objects.size();
    std::vector<Kept> layers;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      progress.at(static_cast<double>(i) / static_cast<double>(objects.size()));
      const DrawnObject object = as_shaded(objects[i], options.shading);
      all_kept = all_kept && same_shape(object, as_shaded(stage.last->objects[i], options.shading)) &&
                 same_look(object, stage.last->objects[i]);
      layers.push_back(layer_of(stage, object, plane, options, blank.algorithm));
      // The layer is stored at once, so that the next frame can use it if this frame is stopped.
      if (layers.back().layer && find(stage, object) == nullptr) stage.layers.push_back(layers.back());
    }
    progress.at(1.0);
    if (all_kept) {
      ++tally.pictures_kept;
      return stage.last->picture;
    }
    Picture picture = blank;
    shade(objects, layers, plane, options, picture);
    ++tally.pictures_shaded;
    // Only this frame's layers are kept. These include the layers of hidden objects, because users often hide
    // objects and show them again.
    std::erase_if(layers, [](const Kept& kept) { return kept.layer == nullptr; });
    stage.layers = std::move(layers);
    stage.last = Last{objects, options, picture};
    return picture;
  }

  static std::size_t last() { return stage_count - 1; }

 private:
  static constexpr std::size_t stage_count = 3;

  /// An object's layer.
  struct Kept {
    DrawnObject shape;
    DrawnObject left;                    ///< `shape` without the parts that the cuts remove
    std::shared_ptr<const Layer> layer;  ///< null: the object is hidden and was not traced yet
  };
  struct Last {
    std::vector<DrawnObject> objects;
    RenderOptions options;
    Picture picture;
  };
  struct Stage {
    std::optional<Picture> blank;  ///< a picture with the plane and algorithm of the layers
    std::vector<Cutaway> cuts;     ///< of the layers
    std::vector<Kept> layers;
    std::optional<Last> last;  ///< the last finished picture of these layers
  };

  static bool is_of(const Stage& stage, const Picture& blank, const std::vector<Cutaway>& cuts) {
    return stage.blank && same_plane(blank, *stage.blank) && same_cuts(cuts, stage.cuts);
  }

  static const Kept* find(const Stage& stage, const DrawnObject& object) {
    const auto kept = std::find_if(stage.layers.begin(), stage.layers.end(),
                                   [&](const Kept& each) { return same_shape(each.shape, object); });
    return kept != stage.layers.end() ? &*kept : nullptr;
  }

  Kept layer_of(const Stage& stage, const DrawnObject& object, const ImagePlane& plane,
                const RenderOptions& options, Algorithm algorithm) {
    if (const Kept* kept = find(stage, object)) {
      tally.layers_kept += object.opacity > 0.0f ? 1 : 0;
      return *kept;
    }
    Kept kept{object, object, nullptr};
    if (object.opacity <= 0.0f) return kept;
    kept.left = to_trace({object}, options, algorithm).front();
    kept.layer = std::make_shared<const Layer>(draw_layer({kept.left}, plane, options.cuts, algorithm));
    ++tally.layers_drawn;
    return kept;
  }

  /// The cut object with the current colour, opacity and scalar.
  static DrawnObject looking(const Kept& kept, const DrawnObject& object) {
    DrawnObject left = kept.left;
    left.colour = object.colour;
    left.opacity = object.opacity;
    left.scalar = object.scalar;
    return left;
  }

  static void shade(const std::vector<DrawnObject>& objects, const std::vector<Kept>& layers,
                    const ImagePlane& plane, const RenderOptions& options, Picture& picture) {
    std::vector<DrawnObject> opaque;
    std::vector<const Layer*> opaque_layers;
    std::vector<std::int16_t> numbers;
    std::vector<Translucent> translucent;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const auto number = static_cast<std::int16_t>(i);
      const DrawnObject object = looking(layers[i], objects[i]);
      if (object.opacity >= 1.0f) {
        opaque.push_back(object);
        opaque_layers.push_back(layers[i].layer.get());
        numbers.push_back(number);
      } else if (object.opacity > 0.0f) {
        translucent.push_back({layers[i].layer->image,
                               shade_layer(*layers[i].layer, {object}, plane, options), number,
                               object.opacity});
      }
    }
    Layer layer = opaque.empty() ? empty_layer(plane.size_px) : nearest_of(opaque_layers);
    std::vector<std::uint8_t> rgb = shade_layer(layer, opaque.empty() ? objects : opaque, plane, options);
    number_objects(layer.image, numbers);
    lay_together(std::move(layer.image), std::move(rgb), std::move(translucent), picture);
  }

  std::array<Stage, stage_count> stages_;
};

Renderer::Renderer() : stages_(std::make_unique<Stages>()) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

const Renderer::Tally& Renderer::tally() const {
  return stages_->tally;
}

namespace {

void refuse_counting(const RenderOptions& options) {
  if (options.count)
    throw std::invalid_argument("a Renderer cannot count visits, because it keeps layers: use render()");
}

}  // namespace

Picture Renderer::frame(const std::vector<DrawnObject>& objects, const RenderOptions& options) {
  refuse_counting(options);
  return stages_->draw(Stages::last(), objects, options, {});
}

void Renderer::refine(const std::vector<DrawnObject>& objects, const RenderOptions& options,
                      const std::function<void(const Picture&)>& show, const Progress& progress) {
  refuse_counting(options);
  const std::size_t first = stages_->has_all_layers(objects, options) ? Stages::last() : 0;
  for (std::size_t number = first; number <= Stages::last(); ++number)
    show(stages_->draw(number, objects, options, progress));
}

}  // namespace octotomy::voxel
