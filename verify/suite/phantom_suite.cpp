// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Every case: 1 a solid in a random pose; 2 its voxels and its samples; 3 the mesh of the samples; 4 the
// bounded certificate of voxels and mesh; 5 the closed-form certificate of both against the truth.
//
// A Gaussian blur of deviation b moves the half level of a smooth boundary inward by b^2 times its mean
// curvature. So both kernels lose a volume of b^2 M, M the mean curvature integral. That is no error of a
// kernel.
#include "verify/suite/phantom_suite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "convert/surface/isosurface.h"
#include "convert/surface/partial_surface.h"
#include "verify/certificate/boundary_model.h"
#include "verify/certificate/certify_bounded.h"
#include "verify/phantom/implicit_solid.h"
#include "verify/phantom/phantom_scan.h"
#include "verify/phantom/solid_phantom.h"
#include "verify/witness/witness.h"
#include "voxel/measure/measure.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"

namespace octotomy::verify {
namespace {

constexpr double blur_voxels = 0.7;
constexpr double noise_share = 0.05;  // of the contrast between inside and outside
constexpr double contrast = -2.0 * phantom_low;

struct Kind {
  std::string name;
  const char* solid;   // of solid_phantom(), or null for a plate
  double radius;       // in units of the least spacing
  bool turned = true;  // at random; otherwise along the lattice
  // of a plate, in units of the longest spacing, so that it does not depend on the pose
  double thickness = 0.0;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{{"sphere", "sphere", 9.0},
                                     {"ellipsoid", "ellipsoid", 12.0},
                                     {"torus", "torus", 10.0},
                                     {"box", "box", 9.0, false},
                                     {"box, turned", "box", 9.0},
                                     {"cylinder", "cylinder", 11.0},
                                     {"plate, 1 voxel", nullptr, 9.0, true, 1.0},
                                     {"plate, 2 voxels", nullptr, 9.0, true, 2.0},
                                     {"plate, 3 voxels", nullptr, 9.0, true, 3.0},
                                     {"lens", "lens", 12.0},
                                     {"cut sphere", "cut_sphere", 9.0},
                                     {"shell", "shell", 12.0}};
  return all;
}

double longest(const glm::dvec3& edges_mm) {
  return std::max({edges_mm.x, edges_mm.y, edges_mm.z});
}

/// Returns a solid in a random position and orientation. Its size varies at random within half a voxel. At a
/// largest spacing of five the solid is twice as large, so that it is at least six voxels across along that
/// axis, too.
SolidPhantom posed(const Kind& kind, const glm::dvec3& spacing_mm, Chance& chance) {
  const bool coarse = spacing_mm.z > 2.0;
  SolidPhantomOptions options;
  options.voxels = coarse ? 64 : 32;
  options.radius_voxels = (kind.radius + chance.even()) * (coarse ? 2.0 : 1.0);
  options.spacing_mm = spacing_mm;
  options.centre_mm = glm::dvec3(chance.even(), chance.even(), chance.even()) * spacing_mm;
  if (kind.turned) {
    const glm::dvec3 degrees = 360.0 * glm::dvec3(chance.even(), chance.even(), chance.even());
    options.lps_from_axes = turned(degrees);
  }
  if (kind.solid != nullptr) return solid_phantom(kind.solid, options);
  SolidPhantom plate = solid_phantom("plate", options);
  const double thickness_mm = kind.thickness * longest(spacing_mm);
  const glm::dvec3 half_mm{*options.radius_voxels, 0.75 * *options.radius_voxels, 0.5 * thickness_mm};
  plate.shape = voxel::OrientedBox{options.centre_mm, half_mm, options.lps_from_axes};
  plate.volume_mm3 = 8.0 * half_mm.x * half_mm.y * half_mm.z;
  plate.area_mm2 = 8.0 * (half_mm.x * half_mm.y + half_mm.y * half_mm.z + half_mm.z * half_mm.x);
  return plate;
}

enum class Sampling { Binary, Fractions, Blurred };
struct SamplingName {
  Sampling sampling;
  const char* name;
};
constexpr std::array<SamplingName, 3> samplings{{{Sampling::Binary, "binary"},
                                                 {Sampling::Fractions, "fractions"},
                                                 {Sampling::Blurred, "blurred, noise"}}};
struct SpacingName {
  glm::dvec3 mm;
  const char* name;
};
const std::array<SpacingName, 3> spacings{{{{1, 1, 1}, "1:1:1"}, {{1, 1, 2}, "2:1:1"}, {{1, 1, 5}, "5:1:1"}}};

/// The answers of both kernels for one solid.
struct Answers {
  voxel::Octree octree;
  std::optional<double> shares_mm3;  // the volume by filled shares, if the voxels have shares
  brep::Solid solid;
  double blur_mm2 = 0.0;  // variance of the blur along the coarsest axis
  // both answers are a window of this scan; null: there is no scan
  std::shared_ptr<const voxel::Scene> scan = {};
};

constexpr double half_level = 0.0, highest_sample = 32767.0;

brep::Solid isosurface_of(const voxel::Scene& scan, double high) {
  return brep::trusted_solid(convert::isosurface(scan, half_level, high), brep::Proof::Construction);
}

Answers answers_of(const SolidPhantom& solid, Sampling sampling, Chance& chance) {
  const voxel::PartialOctree partial = digitise_partial(solid);
  if (sampling != Sampling::Blurred) {
    const voxel::Scene scan = phantom_scan(partial, {}, chance);
    Answers answers{voxel::at_least_half(partial), voxel::volume_mm3(partial), isosurface_of(scan, contrast),
                    0.0};
    if (sampling == Sampling::Binary) {
      answers.octree = digitise(solid, voxel::Digitisation::Centre);
      answers.shares_mm3.reset();
    }
    return answers;
  }
  const auto scan =
      std::make_shared<const voxel::Scene>(phantom_scan(partial, {blur_voxels, noise_share}, chance));
  const voxel::GreyOctree grey = voxel::grey_octree_of(solid.universe, *scan, -1000);
  const glm::dvec3 spacing_mm = solid.universe.lattice().spacing_mm();
  const double deviation_mm = blur_voxels * longest(spacing_mm);
  return {voxel::combine(solid.universe, voxel::Window{grey, half_level}), std::nullopt,
          isosurface_of(*scan, highest_sample), deviation_mm * deviation_mm, scan};
}

Certificate bounded_of(const SolidPhantom& solid, const Answers& answers, const PhantomCase& of) {
  BoundInputs inputs;
  inputs.operation = of.solid + ", " + of.spacing + ", " + of.sampling + ", seed " + std::to_string(of.seed);
  inputs.voxel_lineage = of.sampling == samplings[2].name   ? "window on a grey octree of the scan"
                         : of.sampling == samplings[1].name ? "voxels at least half in the closed form"
                                                            : "voxels whose centre is in the closed form";
  inputs.mesh_lineage = "isosurface of the samples";
  inputs.scan_spacing_mm = solid.universe.lattice().spacing_mm();
  if (answers.scan) {
    inputs.scan_box_mm = voxel::bounds(answers.scan->lattice);
    inputs.voxels_are_samples = true;
    inputs.witness = witness_of_window(answers.scan, half_level, highest_sample, solid.universe);
  }
  return certify_bounded(answers.octree, answers.solid, inputs);
}

/// The share of its thickness that a plate loses at the half level of its blurred samples; 1 if no sample
/// reaches the half level. `deviations`: the plate's thickness t in standard deviations of the blur. Across
/// the plate the samples are Phi(x + t / 2) - Phi(x - t / 2), with Phi the normal distribution, and largest
/// in the middle. Noise may raise the level.
double lost_by_blur(double deviations) {
  const auto above_half = [&](double x) {
    const auto phi = [](double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); };
    return phi(x + 0.5 * deviations) - phi(x - 0.5 * deviations) > 0.5 + noise_share;
  };
  if (!above_half(0.0)) return 1.0;
  double inside = 0.0, outside = deviations;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (inside + outside);
    (above_half(middle) ? inside : outside) = middle;
  }
  return std::clamp(1.0 - 2.0 * inside / deviations, 0.0, 1.0);
}

/// Compares both answers with the true measures. `difference_mm3` is that of the voxel kernel.
Certificate closed_form_of(const SolidPhantom& solid, const Answers& answers, const Certificate& bounded,
                           double plate_voxels) {
  const glm::dvec3 spacing_mm = solid.universe.lattice().spacing_mm();
  const double s = longest(spacing_mm);
  const brep::Measures mesh = answers.solid.measures();
  const BoundaryModel model =
      boundary_model(answers.solid, {solid.universe.lattice(), spacing_mm, solid.centroid_mm});
  Certificate certificate;
  certificate.operation = bounded.operation;
  certificate.tier = Tier::ClosedForm;
  certificate.voxel = bounded.voxel;
  certificate.mesh = bounded.mesh;
  const double voxel_mm3 = answers.shares_mm3.value_or(bounded.voxel.volume_mm3);
  certificate.voxel.volume_mm3 = voxel_mm3;
  certificate.difference_mm3 = voxel_mm3 - solid.volume_mm3;
  const double blurred = answers.blur_mm2 * model.curvature_mm;
  // A sample is a mean over its voxel, which adds s^2 / 12 to the variance of the blur. Between samples the
  // mesh interpolates linearly, which adds s^2 / 6 on average.
  const auto thin_of = [&](double variance_mm2) {
    return plate_voxels > 0.0 ? lost_by_blur(plate_voxels * s / std::sqrt(variance_mm2)) : 0.0;
  };
  const double thin = answers.blur_mm2 > 0.0 ? thin_of(answers.blur_mm2 + s * s / 12.0) : 0.0;
  const double thin_mesh = thin_of(answers.blur_mm2 + s * s / 4.0);
  const double lattice_step = std::cbrt(solid.universe.lattice().voxel_mm3());
  if (answers.shares_mm3)
    certificate.terms = {
        {"shares", "Filled shares are found by halving boundary voxels.", "2^-9 h S + 2^-4 h^2 M",
         0x1.0p-9 * lattice_step * model.area_mm2 + 0x1.0p-4 * lattice_step * s * model.curvature_mm}};
  else
    certificate.terms = {
        {"count", "Voxels are counted by their centres, which scatters on curved and oblique boundary.",
         "3 sqrt(sum over k of a(k) / (4 pi^2 |k|^4))", 3.0 * std::sqrt(model.count_mm6)},
        {"flat", "Voxels move flat parts along the lattice to the nearest voxel face.", "h/2 * area",
         std::max(std::abs(model.planes.mm3), model.planes_without_sign.mm3) + model.unsure.mm3 +
             std::abs(model.nearly_planes.mm3)},
        {"bent", "Between samples the surface is a chord.", "0.12 * integral of |s^2 curvature|",
         0.12 * model.bent_without_sign.mm3},
        {"blur", "Blur of deviation b moves the half level of a curved boundary inward.", "b^2 M", blurred},
        {"thin", "A blurred plate loses thickness at the half level, or all of it.",
         "V (1 - 2 w / t), Phi(w + t/2) - Phi(w - t/2) = 1/2", thin * solid.volume_mm3}};
  for (const ToleranceTerm& term : certificate.terms) certificate.tolerance_mm3 += term.value_mm3;
  const double mesh_tolerance_mm3 = 0.33 * std::abs(model.bent.mm3) + 0.12 * model.bent_without_sign.mm3 +
                                    blurred + thin_mesh * solid.volume_mm3 + model.unsure.mm3 +
                                    0.06 * s * std::sqrt(model.area_mm2) * lattice_step;
  add_comparison(certificate,
                 {"voxel volume", "mm3", voxel_mm3, solid.volume_mm3, std::abs(certificate.difference_mm3),
                  certificate.tolerance_mm3, "sum of the terms; the second answer is the truth"});
  add_comparison(certificate, {"mesh volume", "mm3", mesh.volume_mm3, solid.volume_mm3,
                               std::abs(mesh.volume_mm3 - solid.volume_mm3), mesh_tolerance_mm3,
                               "bent + rough + rims + blur + thin + noise; the second answer is the truth"});
  add_comparison(
      certificate,
      {"mesh area", "mm2", mesh.area_mm2, solid.area_mm2, std::abs(mesh.area_mm2 - solid.area_mm2),
       (0.04 + thin_mesh) * solid.area_mm2 + 0.8 * s * model.curvature_mm,
       "0.04 S for ripple, 0.8 s M for edges cut off, thin parts; the second answer is the truth"});
  if (mesh.centroid_mm && bounded.centroid_tolerance_mm)
    add_comparison(certificate, {.quantity = "mesh centroid",
                                 .unit = "mm",
                                 .difference = glm::distance(*mesh.centroid_mm, solid.centroid_mm),
                                 .tolerance = *bounded.centroid_tolerance_mm + blurred / solid.volume_mm3 * s,
                                 .formula = "first moment of the terms / volume",
                                 .statement = "The mesh kernel's centroid is % from the true one"});
  certificate.unresolved = bounded.unresolved;
  return certificate;
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

class Suite {
 public:
  explicit Suite(const PhantomSuiteOptions& options) : options_(options) {
    if (options.poses < 1 || options.poses > 1000)
      throw voxel::InvalidInput("the suite's number of poses must be 1 to 1000, not " +
                                std::to_string(options.poses));
    if (std::none_of(kinds().begin(), kinds().end(), [&](const Kind& kind) { return asked(kind); }))
      throw voxel::InvalidInput("the suite has no solid with the name '" + *options.solid + "': try sphere");
  }

  PhantomSuite run() {
    calibrate();
    run_cases();
    converge();
    state_rules();
    return std::move(suite_);
  }

 private:
  bool asked(const Kind& kind) const { return !options_.solid || *options_.solid == kind.name; }
  /// Seeds of cases are even, those of the calibration odd.
  std::uint64_t seed_of(std::size_t kind, std::size_t spacing, std::size_t sampling, int pose,
                        bool calibration) const {
    const std::uint64_t place = (kind * spacings.size() + spacing) * samplings.size() + sampling;
    return 2 * ((options_.seed * 1024 + place) * 1024 + static_cast<std::uint64_t>(pose)) +
           (calibration ? 1 : 0);
  }

  void calibrate() {
    std::vector<double> counts, bends;
    for (std::size_t k = 0; k < kinds().size(); ++k) {
      options_.progress.at(0.2 * static_cast<double>(k) / static_cast<double>(kinds().size()));
      if (kinds()[k].thickness > 0.0 || !asked(kinds()[k])) continue;
      for (std::size_t s = 0; s < spacings.size(); ++s)
        for (int pose = 0; pose < options_.poses; ++pose) {
          Chance chance(seed_of(k, s, 0, pose, true));
          const SolidPhantom solid = posed(kinds()[k], spacings[s].mm, chance);
          const Answers answers = answers_of(solid, Sampling::Binary, chance);
          const BoundaryModel model =
              boundary_model(answers.solid, {solid.universe.lattice(), spacings[s].mm, solid.centroid_mm});
          const double voxels_mm3 =
              static_cast<double>(answers.octree.voxel_count()) * solid.universe.lattice().voxel_mm3();
          // Solids along the lattice are left out, because these constants do not model the errors at their
          // rims.
          if (kinds()[k].turned)
            counts.push_back(std::abs(voxels_mm3 - solid.volume_mm3) / std::sqrt(model.count_mm6));
          if (kinds()[k].turned)
            bends.push_back((solid.volume_mm3 - brep::volume_mm3(answers.solid)) /
                            model.bent_without_sign.mm3);
        }
    }
    suite_.calibrations = {
        {"count: standard deviations", 3.0, percentile(counts, 0.99), static_cast<int>(counts.size())},
        {"bent and rough: shares of the curvature integral", 0.33 + 0.12, percentile(bends, 0.99),
         static_cast<int>(bends.size())}};
    for (const Calibration& c : suite_.calibrations)
      suite_.checks.push_back(
          {"the constant in use covers 99 of 100 calibration poses and is at most three times the least "
           "constant that does: " +
               c.constant,
           c.p99, c.in_use, c.p99 <= c.in_use && c.in_use <= 3.0 * c.p99});
  }

  void run_cases() {
    for (std::size_t s = 0; s < spacings.size(); ++s)
      for (std::size_t m = 0; m < samplings.size(); ++m) {
        std::vector<double> shares;
        for (std::size_t k = 0; k < kinds().size(); ++k) {
          const auto done = static_cast<double>((s * samplings.size() + m) * kinds().size() + k);
          options_.progress.at(
              0.2 + 0.6 * done / static_cast<double>(kinds().size() * spacings.size() * samplings.size()));
          if (!asked(kinds()[k])) continue;
          for (int pose = 0; pose < options_.poses; ++pose) run_case(k, s, m, pose, shares);
        }
        suite_.tightness.push_back({spacings[s].name, samplings[m].name, static_cast<int>(shares.size()),
                                    percentile(shares, 1.0), percentile(shares, 0.99)});
        const Tightness& tight = suite_.tightness.back();
        suite_.checks.push_back(
            {"the bounded tolerance is at most three times the observed 99th percentile, " + tight.spacing +
                 ", " + tight.sampling,
             1.0 / tight.p99_share, 3.0, tight.p99_share >= 1.0 / 3.0});
      }
  }

  void run_case(std::size_t k, std::size_t s, std::size_t m, int pose, std::vector<double>& shares) {
    PhantomCase one;
    one.solid = kinds()[k].name;
    one.spacing = spacings[s].name;
    one.sampling = samplings[m].name;
    one.seed = seed_of(k, s, m, pose, false);
    Chance chance(one.seed);
    const SolidPhantom solid = posed(kinds()[k], spacings[s].mm, chance);
    const Answers answers = answers_of(solid, samplings[m].sampling, chance);
    one.bounded = bounded_of(solid, answers, one);
    one.closed_form = closed_form_of(solid, answers, one.bounded, kinds()[k].thickness);
    if (kinds()[k].thickness == 0.0) keep_worse(suite_.worst, {one.bounded, answers.octree, answers.solid});
    // The box around a turned plate does not show its thickness, so the known thickness is used.
    if (kinds()[k].thickness > 0.0)
      for (Certificate* certificate : {&one.bounded, &one.closed_form})
        certificate->unresolved = {
            kinds()[k].thickness,
            "the plate is " + voxel::rounded(kinds()[k].thickness) + " voxels thick, six are needed"};
    if (one.bounded.resolved())
      shares.push_back(std::abs(one.bounded.difference_mm3) / one.bounded.tolerance_mm3);
    suite_.cases.push_back(std::move(one));
  }

  /// Errors of one solid's measures in one random pose, in per cent of the truth.
  struct Errors {
    double voxels = 0.0, shares = 0.0, surface = 0.0, area = 0.0;
  };
  Errors errors_of(const char* kind, double radius_voxels, std::uint64_t seed) const {
    Chance chance(seed);
    SolidPhantomOptions options;
    options.voxels = 16;
    while (options.voxels < 2.0 * radius_voxels * 4.0 / 3.0 + 6.0) options.voxels *= 2;
    options.radius_voxels = radius_voxels;
    options.centre_mm = {chance.even(), chance.even(), chance.even()};
    options.lps_from_axes = turned(360.0 * glm::dvec3(chance.even(), chance.even(), chance.even()));
    const SolidPhantom solid = solid_phantom(kind, options);
    const voxel::PartialOctree partial = digitise_partial(solid);
    const auto percent = [](double found, double truth) { return 100.0 * (found / truth - 1.0); };
    const brep::Measures iso =
        brep::measure(brep::mesh_of(convert::isosurface(phantom_scan(partial, {}, chance), 0.0, contrast)));
    const brep::Measures surface = brep::measure(brep::mesh_of(convert::isosurface(partial)));
    return {percent(static_cast<double>(digitise(solid, voxel::Digitisation::Centre).voxel_count()),
                    solid.volume_mm3),
            percent(voxel::volume_mm3(partial), solid.volume_mm3), percent(iso.volume_mm3, solid.volume_mm3),
            percent(surface.area_mm2, solid.area_mm2)};
  }

  void converge() {
    const std::vector<double> radii{4.0, 8.0, 16.0, 32.0};
    std::array<Convergence, 2> found{{{"voxels counted, volume of a sphere", radii, {}, 0.0, 1.5},
                                      {"isosurface of shares, volume of a sphere", radii, {}, 0.0, 1.8}}};
    for (const double radius : radii) {
      options_.progress.at(0.8);
      std::array<double, 2> squares{};
      for (int pose = 0; pose < options_.poses; ++pose) {
        const Errors e = errors_of("sphere", radius, options_.seed * 4096 + static_cast<std::uint64_t>(pose));
        squares[0] += e.voxels * e.voxels;
        squares[1] += e.surface * e.surface;
      }
      for (std::size_t q = 0; q < found.size(); ++q)
        found[q].errors_percent.push_back(std::sqrt(squares[q] / options_.poses));
    }
    for (Convergence& c : found) {
      double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
      const auto n = static_cast<double>(radii.size());
      for (std::size_t i = 0; i < radii.size(); ++i) {
        const double u = std::log(radii[i]), v = std::log(c.errors_percent[i]);
        x += u;
        y += v;
        xx += u * u;
        xy += u * v;
      }
      c.order = -(n * xy - x * y) / (n * xx - x * x);
      suite_.checks.push_back(
          {"order of convergence: " + c.quantity, c.order, c.least_order, c.order >= c.least_order});
      suite_.convergences.push_back(c);
    }
  }

  void state_rules() {
    options_.progress.at(0.9);
    double voxels = 0.0, shares = 0.0, area = 0.0, flat_area = 0.0;
    for (const char* kind : {"sphere", "ellipsoid", "shell"})
      for (int pose = 0; pose < options_.poses; ++pose) {
        const std::uint64_t seed = options_.seed * 8192 + static_cast<std::uint64_t>(pose);
        voxels = std::max(voxels, std::abs(errors_of(kind, 12.0, seed).voxels));
        area = std::max(area, std::abs(errors_of(kind, 6.0, seed).area));
        shares = std::max(shares, std::abs(errors_of(kind, 3.0, seed).shares));
      }
    for (const char* kind : {"box", "cylinder", "cut_sphere"})
      for (int pose = 0; pose < options_.poses; ++pose)
        flat_area = std::max(
            flat_area,
            std::abs(errors_of(kind, 6.0, options_.seed * 8192 + static_cast<std::uint64_t>(pose)).area));
    suite_.checks.push_back(
        {"voxel volume within 1 % from radius 12 voxels (per cent)", voxels, 1.0, voxels <= 1.0});
    suite_.checks.push_back(
        {"fraction volume within 0.2 % from radius 3 voxels (per cent)", shares, 0.2, shares <= 0.2});
    suite_.checks.push_back(
        {"area within 2 % on smooth phantoms from radius 6 voxels (per cent)", area, 2.0, area <= 2.0});
    suite_.area_with_edges_percent = flat_area;
    options_.progress.at(1.0);
  }

  const PhantomSuiteOptions& options_;
  PhantomSuite suite_;
};

}  // namespace

PhantomSuite phantom_suite(const PhantomSuiteOptions& options) {
  return Suite(options).run();
}

}  // namespace octotomy::verify
