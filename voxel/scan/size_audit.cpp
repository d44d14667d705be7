// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/size_audit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "voxel/space/printed.h"

namespace octotomy::voxel {

namespace {

// Limits in mm. Scanners: the widest bore in use is 900 mm, with images of up to 820 mm; a whole body is two
// metres long. Pixels of CT: 1000 mm over 256 at the coarsest. Organs: images of an inner ear are at least 40
// mm wide and have 256 pixels a side, or 64 if their resolution was halved twice. The head of a newborn is 90
// mm wide.
constexpr double widest_field_mm = 1000.0, longest_field_mm = 2500.0;
constexpr double coarsest_ct_mm = 5.0, finest_pixel_mm = 0.05;
constexpr double smallest_field_mm = 10.0, smallest_fine_field_mm = 36.0;
constexpr int fine_side_px = 64;
constexpr double smallest_scan_mm = 1.0;
constexpr double smallest_body_mm = 70.0;
constexpr int fine_body_px = 60;

/// The usual width of images of a head, by which the ratio of two units is chosen.
constexpr double usual_field_mm = 250.0;

/// The extent, in pixels along the image's axes, of the samples at or above -300 HU in the middle slice, if
/// air surrounds them. None if these samples touch a side of the image.
std::optional<glm::ivec2> body_px(const Scene& scene) {
  if (scene.meaning != Meaning::Hounsfield) return std::nullopt;
  const glm::ivec3 dims = scene.lattice.dims;
  constexpr double skin = -300.0;
  return std::visit(
      [&](const auto& samples) -> std::optional<glm::ivec2> {
        glm::ivec2 low(dims), high(-1);
        const std::size_t width = static_cast<std::size_t>(dims.x);
        const std::size_t first =
            width * static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(dims.z / 2);
        for (int y = 0; y < dims.y; ++y)
          for (int x = 0; x < dims.x; ++x)
            if (static_cast<double>(
                    samples[first + static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)]) >=
                skin) {
              low = glm::min(low, glm::ivec2(x, y));
              high = glm::max(high, glm::ivec2(x, y));
            }
        const bool is_free = high.x >= 0 && glm::all(glm::greaterThan(low, glm::ivec2(0))) &&
                             glm::all(glm::lessThan(high + 1, glm::ivec2(dims)));
        return is_free ? std::optional(high - low + 1) : std::nullopt;
      },
      scene.samples);
}

/// The ratio of two units (millimetres, centimetres, inches, metres, micrometres) that brings a width nearest
/// to that of a head, among the ratios that produce a pixel size of a scanner.
double factor_to(double width_mm, double pixel_mm) {
  constexpr std::array<double, 12> factors = {1e-4, 1e-3,       1e-2, 1e-1,     10.0, 100.0,
                                              1e3,  1.0 / 25.4, 25.4, 1 / 2.54, 2.54, 1e4};
  const auto cost = [&](double factor) {
    const bool is_pixel = factor * pixel_mm >= finest_pixel_mm && factor * pixel_mm <= coarsest_ct_mm;
    return std::abs(std::log(factor * width_mm / usual_field_mm)) + (is_pixel ? 0.0 : 1e3);
  };
  return *std::min_element(factors.begin(), factors.end(),
                           [&](double a, double b) { return cost(a) < cost(b); });
}

}  // namespace

std::optional<Finding> size_finding(const Scene& scene) {
  const bool is_ct = scene.modality == "CT" || scene.meaning == Meaning::Hounsfield;
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  const glm::ivec3 dims = scene.lattice.dims;
  const glm::dvec3 field_mm = spacing_mm * glm::dvec3(dims);
  const double wide_mm = std::max(field_mm.x, field_mm.y), narrow_mm = std::min(field_mm.x, field_mm.y);
  // A scan without a stated modality may show anything, so only sizes that no scanner produces are doubted.
  // Labels may cover only a part of a scan.
  const bool is_known = scene.meaning != Meaning::Label && (!scene.modality.empty() || is_ct);
  const std::optional<glm::ivec2> body = is_known ? body_px(scene) : std::nullopt;
  std::string doubt;
  double measured_mm = wide_mm;
  if (wide_mm > longest_field_mm || narrow_mm > widest_field_mm) {
    doubt = print("the images are %.3g x %.3g mm, wider than any scanner's field", field_mm.x, field_mm.y);
  } else if (field_mm.z > longest_field_mm) {
    return Finding{
        "plausible_size", Verdict::Warn,
        print("the slices span %.3g mm, more than a person's length: check their distance of %.4g mm",
              field_mm.z, spacing_mm.z)};
  } else if (std::max(wide_mm, field_mm.z) < smallest_scan_mm) {
    doubt = print("the scan is %.3g x %.3g x %.3g mm, smaller than any scan of a person", field_mm.x,
                  field_mm.y, field_mm.z);
  } else if (scene.meaning != Meaning::Label && !is_known) {
    // Such a scan is smaller than any complete scan of a person, but a part cut out of a scan may be as
    // small.
    if (std::max(wide_mm, field_mm.z) >= smallest_fine_field_mm || std::min(dims.x, dims.y) < fine_side_px)
      return std::nullopt;
    doubt = print(
        "the scan is %.3g x %.3g x %.3g mm, smaller than any scan of a person, unless it was cut out of a "
        "larger one",
        field_mm.x, field_mm.y, field_mm.z);
  } else if (!is_known) {
    return std::nullopt;
  } else if (is_ct && std::min(spacing_mm.x, spacing_mm.y) > coarsest_ct_mm) {
    doubt = print("pixels of %.3g mm are coarser than any CT's", spacing_mm.x);
  } else if (wide_mm < smallest_field_mm ||
             (wide_mm < smallest_fine_field_mm && std::min(dims.x, dims.y) >= fine_side_px)) {
    doubt = print("the images are %.3g x %.3g mm, smaller than any organ", field_mm.x, field_mm.y);
  } else if (body && std::min(body->x, body->y) >= fine_body_px) {
    const glm::dvec2 body_mm = glm::dvec2(*body) * glm::dvec2(spacing_mm);
    measured_mm = std::max(body_mm.x, body_mm.y);
    if (measured_mm < smallest_body_mm || std::min(body_mm.x, body_mm.y) > widest_field_mm)
      doubt = print("the body in the air is %.3g x %.3g mm, %s than any head", body_mm.x, body_mm.y,
                    measured_mm < smallest_body_mm ? "smaller" : "larger");
  }
  if (doubt.empty()) return std::nullopt;
  const double factor = factor_to(measured_mm, spacing_mm.x);
  return Finding{
      "plausible_size", Verdict::Warn,
      doubt + print(": it would be %.3g mm wide if the spacing were %.3g mm instead of %.4g mm; check "
                    "the unit that the file's spacing is in",
                    factor * measured_mm, factor * spacing_mm.x, spacing_mm.x)};
}

}  // namespace octotomy::voxel
