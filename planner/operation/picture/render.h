// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "planner/operation/file/picture_frame.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/field.h"
#include "planner/operation/table/object.h"
#include "voxel/view/annotation.h"
#include "voxel/view/cutaway.h"
#include "voxel/view/drawn_object.h"
#include "voxel/view/render.h"

// A picture of objects: what is asked for, and what its ways of drawing have in common.
namespace octotomy::planner {

struct Render {
  std::vector<ObjectName> objects;
  std::filesystem::path path;
  std::string view = "anterior", size = "512x512", algorithm, shading = "partial_volume";
  std::optional<double> width_mm, eye_mm, stereo_deg;
  std::optional<glm::dvec3> centre_mm;
  std::vector<std::string> colours;
  std::vector<double> opacities;
  std::string colour_by;
  std::optional<double> range_mm;
  std::string transfer;
  std::vector<std::string> cut_planes, cut_boxes;
  std::string cut_face = "plain", tones;
  std::vector<std::string> picks;
  bool annotate = false;
  std::string title;
  std::optional<double> grid_mm;
  bool count = false;
  // Of the verb.
  std::filesystem::path out;
  SampleWindow window{300.0};
  std::optional<double> voxel_mm;
};

/// What is drawn and what is told of it.
struct RenderedPicture {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;
  double pixel_mm = 1.0;
  glm::dvec2 centre_mm{0.0};               ///< of pictures along rays, in the view's millimetres
  std::optional<PictureFrame> frame = {};  ///< of pictures in true scale
  nlohmann::ordered_json said = nlohmann::ordered_json::object();
};

/// Finite numbers between commas, just as many; throws std::runtime_error naming what they are of.
template <std::size_t Count>
std::array<double, Count> numbers_of(const std::string& what, const std::string& text,
                                     const std::string& example) {
  std::array<double, Count> numbers{};
  const char* at = text.c_str();
  for (std::size_t i = 0; i < Count; ++i) {
    char* end = nullptr;
    numbers[i] = std::strtod(at, &end);
    if (end == at || !std::isfinite(numbers[i]) || *end != (i + 1 < Count ? ',' : '\0'))
      throw std::runtime_error(std::string(what)
                                   .append(": '")
                                   .append(text)
                                   .append("' is not ")
                                   .append(std::to_string(Count))
                                   .append(" numbers between commas, for example ")
                                   .append(example));
    at = end + 1;
  }
  return numbers;
}

/// View, size, frame, shading and cuts, without the grey tones of cut faces. Throws std::runtime_error for
/// what cannot be read. Precondition: no ray picture.
voxel::RenderOptions options_of(const Render& render);
/// The samples that cut faces show, and what is black and white of them; none if there are no samples. Of a
/// plan, `made` holds the objects: each place shows the samples of the window that owns it, moved with it. Of
/// files it is empty: objects without samples of their own show those of the first with samples, where they
/// lie. Throws std::runtime_error for tones that cannot be read.
std::optional<voxel::CutTones> cut_tones_of(const Render& render,
                                            const std::vector<voxel::DrawnObject>& objects,
                                            const std::vector<const Object*>& made);
/// WxH in pixels.
glm::ivec2 size_of(const Render& render);
/// Normals are made unit.
std::vector<voxel::Cutaway> cuts_of(const Render& render);
/// Writes what is asked for on the pixels: a grid, whose margin makes the picture larger, and the annotation.
void finish(RenderedPicture& picture, const voxel::ImagePlane& plane, const Render& render,
            const std::optional<voxel::Annotation>& annotation);
/// Title, sides, scale, and a legend of the objects that are neither hidden nor coloured by a scalar.
voxel::Annotation annotation_of(const Render& render, const std::vector<voxel::DrawnObject>& objects);

}  // namespace octotomy::planner
