// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/light_choice.h"

#include <algorithm>

#include "planner/operation/picture/ray_pictures.h"

namespace octotomy::planner {
namespace {

bool is_lit(const Render& render) {
  static const std::vector<std::string> unlit{"depth",   "silhouette", "outline",
                                              "density", "mip",        "radiograph"};
  return !render.relief && std::find(unlit.begin(), unlit.end(), render.shading) == unlit.end();
}
bool has_gloss(const Render& render) {
  return is_lit(render) && render.shading != "composite";
}
constexpr const char* of_lit =
    "applies only to lit surfaces: choose another 'shading', and leave out 'relief'";
constexpr const char* of_gloss =
    "applies only to mirrored light, which composite pictures do not have: leave it out";

/// A light as the user typed it; the strength is none if the text states none.
struct TypedLight {
  glm::vec3 towards{0.0f};
  std::optional<float> strength;
};

TypedLight typed_light(const std::string& text) {
  const std::vector<double> n = comma_numbers(text);
  if (n.size() != 3 && n.size() != 4)
    throw std::runtime_error(
        "--light: '" + text +
        "' is not a light: write RIGHT,UP,FRONT, for example -1,1,1, or with a strength -1,1,1,0.5");
  TypedLight light{{n[0], n[1], -n[2]}, std::nullopt};
  const float length = glm::length(light.towards);
  if (!(length > 0.0f && length < 1e18f))
    throw std::runtime_error("--light: '" + text +
                             "' has no direction: write RIGHT,UP,FRONT, for example -1,1,1");
  if (n.size() == 4) {
    if (!(n[3] >= 0.0 && n[3] <= 1.0))
      throw std::runtime_error("--light: '" + text + "' has a strength outside of 0 to 1");
    light.strength = static_cast<float>(n[3]);
  }
  return light;
}

}  // namespace

std::vector<Field> light_fields() {
  std::vector<Field> fields;
  fields.push_back(field("lights", &Render::lights,
                         "RIGHT,UP,FRONT or RIGHT,UP,FRONT,STRENGTH: the direction in the picture towards a "
                         "light, and its strength from 0 to 1; may be repeated. Default: two lights, at the "
                         "upper left and the lower right.")
                       .repeated()
                       .to(8)
                       .called("light")
                       .read_if<Render>(is_lit, of_lit));
  fields.push_back(field("ambient", &Render::ambient, "Strength of the ambient light, 0 to 1. Default: 0.06.")
                       .from(0.0)
                       .to(1.0)
                       .read_if<Render>(is_lit, of_lit));
  fields.push_back(field("diffuse", &Render::diffuse,
                         "Share of the first light that a surface facing it scatters, 0 to 1. The second "
                         "default light changes in proportion. Default: 0.9.")
                       .from(0.0)
                       .to(1.0)
                       .read_if<Render>(is_lit, of_lit));
  fields.push_back(field("specular", &Render::specular,
                         "Share of the first light that a surface mirrors, 0 to 1. Default: 0.06.")
                       .from(0.0)
                       .to(1.0)
                       .read_if<Render>(has_gloss, of_gloss));
  fields.push_back(
      field("specular_exponent", &Render::specular_exponent,
            "Sharpness of the highlight: the exponent of the mirrored light, 1 to 1000. Default: 48.")
          .from(1.0)
          .to(1000.0)
          .read_if<Render>(has_gloss, of_gloss)
          .read_if<Render>([](const Render& render) { return render.specular.value_or(1.0) > 0.0; },
                           "applies only to mirrored light, but 'specular' is 0: state a larger 'specular'"));
  return fields;
}

void check_lights(const Render& render) {
  bool has_default_strength = render.lights.empty();
  for (const std::string& light : render.lights)
    has_default_strength = !typed_light(light).strength || has_default_strength;
  if (render.diffuse && !has_default_strength)
    throw std::runtime_error(
        "--diffuse has no effect, because every light states its strength: leave it out");
}

std::vector<voxel::Light> lights_of(const Render& render) {
  check_lights(render);
  if (render.lights.empty() && !render.diffuse) return {};
  std::vector<voxel::Light> lights = voxel::Scenery{}.lights;
  const float first = lights.front().strength;
  const auto diffuse = static_cast<float>(render.diffuse.value_or(first));
  if (render.lights.empty()) {
    for (voxel::Light& light : lights) light.strength *= diffuse / first;
    return lights;
  }
  lights.clear();
  for (const std::string& text : render.lights) {
    const TypedLight light = typed_light(text);
    lights.push_back({light.towards, light.strength.value_or(diffuse)});
  }
  return lights;
}

}  // namespace octotomy::planner
