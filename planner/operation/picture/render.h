// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>

#include "planner/operation/file/picture_frame.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/comma_numbers.h"
#include "planner/operation/table/field.h"
#include "planner/operation/table/object.h"
#include "voxel/view/annotation.h"
#include "voxel/view/cutaway.h"
#include "voxel/view/drawn_object.h"
#include "voxel/view/render.h"

// A picture of objects: its fields, and the functions that all its kinds share.
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
  /// A Boolean expression that is drawn after the objects; empty: none.
  std::string expression;
  // Light (thesis 5.1).
  std::vector<std::string> lights;
  std::optional<double> ambient, diffuse, specular, specular_exponent;
  // Samples along rays (4.4.2.3) and on surfaces (5.2.1.2).
  std::string decide;
  std::optional<double> steeper_per_mm;
  std::optional<int> peel;
  std::vector<std::string> dissolve;
  std::string gradient_opacity;
  std::vector<std::string> density_colours;
  std::optional<int> relief;
  // Of the command only.
  std::vector<std::string> lets;
  std::filesystem::path out;
  SampleWindow window{300.0};
  std::optional<double> voxel_mm;
};

/// A drawn picture, with its results.
struct RenderedPicture {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;
  double pixel_mm = 1.0;
  glm::dvec2 centre_mm{0.0};               ///< only for pictures along rays: position of the picture's middle
                                           ///< in the view's millimetres
  std::optional<PictureFrame> frame = {};  ///< only for pictures in true scale
  nlohmann::ordered_json said = nlohmann::ordered_json::object();
};

/// Reads exactly `Count` finite numbers between commas. Throws std::runtime_error that begins with `what` and
/// states the example.
template <std::size_t Count>
std::array<double, Count> numbers_of(const std::string& what, const std::string& text,
                                     const std::string& example) {
  const std::vector<double> read = comma_numbers(text);
  if (read.size() != Count)
    throw std::runtime_error(what + ": '" + text + "' is not " + std::to_string(Count) +
                             " numbers between commas, for example " + example);
  std::array<double, Count> numbers{};
  std::copy(read.begin(), read.end(), numbers.begin());
  return numbers;
}

/// The view, size, frame, shading and cuts of a picture, without the grey tones of cut faces. Throws
/// std::runtime_error for fields that cannot be read. Precondition: it is no picture along rays.
voxel::RenderOptions options_of(const Render& render);
/// The samples that cut faces show, with the values that are black and white; none if there are no samples.
/// In a plan, `made` has the objects. Each point then shows the sample of the window whose object contains
/// the point, moved with the object. For files `made` is empty. Objects without samples then show those of
/// the first object with samples, at the positions of these samples. Throws std::runtime_error for tones that
/// cannot be read.
std::optional<voxel::CutTones> cut_tones_of(const Render& render,
                                            const std::vector<voxel::DrawnObject>& objects,
                                            const std::vector<const Object*>& made);
/// WxH in pixels.
glm::ivec2 size_of(const Render& render);
/// The planes of the cuts, with unit normals.
std::vector<voxel::Cutaway> cuts_of(const Render& render);
/// Draws the requested grid, whose margin makes the picture larger, and the annotation.
void finish(RenderedPicture& picture, const voxel::ImagePlane& plane, const Render& render,
            const std::optional<voxel::Annotation>& annotation);
/// The title, sides, scale, and a legend of the objects that are visible and not coloured by distance.
voxel::Annotation annotation_of(const Render& render, const std::vector<voxel::DrawnObject>& objects);

}  // namespace octotomy::planner
