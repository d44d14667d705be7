// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Right answers of both kernels are never contradicted by their witness; errors over the limit that the
// witness prints always are. Errors are made at random in scans of heads, in objects of a window, of a cut
// and of a motion.
#include "verify/certificate/places.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <random>

#include "brep/boolean/boolean.h"
#include "brep/mesh/components.h"
#include "brep/mesh/move.h"
#include "brep/mesh/triangles.h"
#include "brep/shape/prism.h"
#include "convert/surface/isosurface.h"
#include "convert/voxel/voxelise.h"
#include "tests/reference_data.h"
#include "verify/certificate/certify_bounded.h"
#include "verify/phantom/head_phantom.h"
#include "verify/witness/witness.h"
#include "voxel/filter/components.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::verify {
namespace {

using voxel::Expression;
using Scan = std::shared_ptr<const voxel::Scene>;

/// One object by both kernels and its witness.
struct Subject {
  std::string name;
  voxel::Octree octree;
  brep::Solid mesh;
  Witness witness;

  voxel::Octree digitised(const brep::Solid& surface) const {
    return convert::voxelise(octree.universe(), surface.linked());
  }
};

constexpr double infinite = std::numeric_limits<double>::infinity();
const std::vector<std::vector<glm::dvec2>> drawn{{{-31, -46.3}, {37.2, -40}, {30, 21}, {-22.7, 25}}};

brep::Solid prism_of(const DrawnRegion& region) {
  return brep::solid_of(brep::Prism{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, region.polygons_mm, -900, 900});
}

/// The window, the part of it in a region, the rest, and that part moved.
std::vector<Subject> subjects_of(const std::string& name, const Scan& scan, double low, double voxel_mm,
                                 const glm::dvec2& region_middle_mm) {
  const voxel::Universe universe = voxel::universe_around(voxel::bounds(scan->lattice), voxel_mm);
  const voxel::Box box = voxel::bounds(universe.lattice());
  const Expression window = voxel::Window{voxel::grey_octree_of(universe, *scan, -1024).with_scan(scan), low};
  DrawnRegion region{"anterior", drawn};
  for (glm::dvec2& point : region.polygons_mm.front()) point += region_middle_mm;
  const Expression mask = voxel::RegionMask{{{voxel::parse_view(region.view), region.polygons_mm}}};
  const glm::dmat4 motion =
      voxel::moved_from_still({{0.3, -6.1, 2.2}, 5.0, {1, 0.2, 0}, {region_middle_mm.x, 0, 0}});
  const brep::Solid surface =
      brep::trusted_solid(convert::isosurface(*scan, low, infinite), brep::Proof::Construction);
  const Witness whole = witness_of_window(scan, low, infinite, universe), cut = witness_of_regions({region});
  const Witness world = witness_of_box(box);
  const auto digitised = [&](const Expression& expression) { return voxel::combine(universe, expression); };
  const brep::Booleans parts = brep::booleans(surface, prism_of(region), {false, true, true, false});
  std::vector<Subject> subjects;
  subjects.push_back({name + ", window", digitised(window), surface, both(whole, world)});
  subjects.push_back({name + ", piece", digitised(window & mask), *parts.intersection, both(whole, cut)});
  subjects.push_back({name + ", rest", digitised(window - mask), *parts.a_minus_b, without(whole, cut)});
  subjects.push_back({name + ", moved piece", digitised(voxel::moved(window & mask, motion)),
                      brep::moved(*parts.intersection, motion), carried(both(whole, cut), motion)});
  return subjects;
}

Scan phantom() {
  static const Scan scan = [] {
    HeadOptions options;
    options.voxel_mm = 1.5;
    options.noise_sigma_hu = 15.0;
    return std::make_shared<const voxel::Scene>(head_phantom(options));
  }();
  return scan;
}

std::string told(const Places& places) {
  std::string text = std::to_string(places.voxel_count) + " voxels, the largest group " +
                     std::to_string(places.largest_count) + ", stray " + std::to_string(places.stray_mm2) +
                     " mm2; limit " + std::to_string(places.limit.volume_mm3) + " mm3, " +
                     (places.limit.shift_mm ? std::to_string(*places.limit.shift_mm) : "no") + " mm";
  if (places.worst) text += "; " + text_of(*places.worst);
  return text;
}

void expect_right(const Subject& subject) {
  const Places places =
      judge_places(subject.octree, subject.digitised(subject.mesh), subject.mesh, subject.witness);
  EXPECT_EQ(places.voxel_count, 0u) << subject.name << ": " << told(places);
  EXPECT_EQ(places.stray_mm2, 0.0) << subject.name << ": " << told(places);
}

/// An error in one kernel's answer, and how large it is: the volume of the voxels that it changes, or a
/// shift.
struct Spoiled {
  std::string what;
  voxel::Octree octree;
  brep::Solid mesh;
  double volume_mm3 = 0.0;
  double shift_mm = 0.0;
  bool keeps_mesh = false;
};

/// The number of kinds of errors that a Spoiler makes.
constexpr std::uint64_t kinds = 10;

/// Random errors of one subject.
class Spoiler {
 public:
  Spoiler(const Subject& subject, std::uint64_t seed)
      : subject_(subject), boundary_(voxel::voxel_boundary(subject.octree)), random_(seed) {}

  /// Takes the kinds in turn, one for each of `kinds` numbers.
  Spoiled next(std::uint64_t number) {
    switch (number % kinds) {
      case 0:
        return voxels("a bite", here() - ball());
      case 1:
        return voxels("a growth", here() | ball());
      case 2:
        return voxels("a saw cut", here() - slab());
      case 3:
        return voxels("cavities filled", Expression(filled()));
      case 4:
        return lost_part();
      case 5:
        return surface("a shift", moved(shift()), 1.0);
      case 6:
        return surface("a scale", scaled(1.0 + between(-0.02, 0.02)), 0.0);
      case 7:
        return film();
      case 8:
        return surface("a mirror image", mirrored(), 0.0);
      default:
        return surface("a turn", moved(turn()), 0.0);
    }
  }

 private:
  double between(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  glm::dvec3 direction() {
    return glm::normalize(glm::dvec3(between(-1, 1), between(-1, 1), between(-1, 1)) + glm::dvec3(1e-3));
  }
  Expression here() const { return Expression(subject_.octree); }
  glm::dvec3 place_mm() {
    return subject_.octree.universe().lattice().lps_mm(
        glm::dvec3(boundary_[random_() % boundary_.size()].voxel));
  }
  double voxel_mm() const { return subject_.octree.universe().lattice().spacing_mm().x; }
  Expression ball() { return voxel::Sphere{place_mm(), between(1.5, 5.0) * voxel_mm()}; }
  Expression slab() {
    const glm::dvec3 at_mm = place_mm(), reach = glm::dvec3(between(2, 20), between(2, 20), voxel_mm());
    return voxel::Box{at_mm - reach, at_mm + reach};
  }
  voxel::Octree filled() const {
    const voxel::Universe& universe = subject_.octree.universe();
    return voxel::combine(universe,
                          ~Expression(voxel::components_at_faces(voxel::combine(universe, ~here()))));
  }
  glm::dmat4 shift() {
    voxel::Motion motion;
    motion.translate_mm = shift_mm_ * direction();
    return voxel::moved_from_still(motion);
  }
  glm::dmat4 turn() {
    return voxel::moved_from_still({glm::dvec3(0.0), between(0.3, 2.0), direction(), place_mm()});
  }
  brep::Solid scaled(double by) {
    brep::Triangles triangles = brep::triangles_of(subject_.mesh);
    const glm::dvec3 about_mm = place_mm();
    for (glm::dvec3& p : triangles.points_mm) p = about_mm + by * (p - about_mm);
    return brep::trusted_solid(triangles, brep::Proof::Connection);
  }
  brep::Solid mirrored() {
    brep::Triangles triangles = brep::triangles_of(subject_.mesh);
    const brep::Size& size = subject_.mesh.size();
    const glm::dvec3 about_mm = 0.5 * (size.low_mm + size.high_mm), normal = direction();
    for (glm::dvec3& p : triangles.points_mm) p -= 2.0 * glm::dot(p - about_mm, normal) * normal;
    for (auto& face : triangles.faces) std::swap(face[0], face[1]);
    return brep::trusted_solid(triangles, brep::Proof::Connection);
  }
  /// A square sheet through the surface.
  Spoiled film() {
    const glm::dvec3 at_mm = place_mm(), w = direction(),
                     u = glm::normalize(glm::cross(w, glm::dvec3(0.3, 0.5, 0.8))), v = glm::cross(u, w);
    const double reach_mm = between(2.0, 15.0), thickness_mm = between(0.02, 0.3);
    const glm::dvec2 middle(glm::dot(at_mm, u), glm::dot(at_mm, v));
    const double depth_mm = glm::dot(at_mm, w);
    const brep::Solid sheet = brep::solid_of(
        brep::Prism{w,
                    v,
                    u,
                    {{middle + glm::dvec2(-reach_mm, -reach_mm), middle + glm::dvec2(reach_mm, -reach_mm),
                      middle + glm::dvec2(reach_mm, reach_mm), middle + glm::dvec2(-reach_mm, reach_mm)}},
                    depth_mm,
                    depth_mm + thickness_mm});
    brep::Triangles triangles = brep::triangles_of(subject_.mesh);
    const auto first = static_cast<std::uint32_t>(triangles.points_mm.size());
    const brep::Triangles& more = sheet.triangles();
    triangles.points_mm.insert(triangles.points_mm.end(), more.points_mm.begin(), more.points_mm.end());
    for (const auto& face : more.faces)
      triangles.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
    return {"a film", subject_.octree, brep::trusted_solid(triangles, brep::Proof::Connection),
            4.0 * reach_mm * reach_mm * thickness_mm, 0.0};
  }
  brep::Solid moved(const glm::dmat4& motion) { return brep::moved(subject_.mesh, motion); }

  Spoiled voxels(const std::string& what, const Expression& expression) {
    const voxel::Octree made = voxel::combine(subject_.octree.universe(), expression);
    const std::uint64_t changed =
        voxel::combine(made.universe(), voxel::Expression(made) ^ here()).voxel_count();
    const double changed_mm3 = static_cast<double>(changed) * made.universe().lattice().voxel_mm3();
    return {what, made, subject_.mesh, changed_mm3, 0.0, true};
  }
  Spoiled lost_part() {
    const std::vector<brep::Component> pieces = brep::components(subject_.mesh);
    const std::size_t lost = random_() % std::min<std::size_t>(pieces.size(), 8);  // the largest first
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (i != lost) kept.insert(kept.end(), pieces[i].faces.begin(), pieces[i].faces.end());
    std::sort(kept.begin(), kept.end());
    return {"a lost part", subject_.octree,
            brep::trusted_solid(brep::part_of(subject_.mesh, kept), brep::Proof::Connection),
            pieces[lost].volume_mm3, 0.0};
  }
  Spoiled surface(const std::string& what, brep::Solid mesh, double shifts) {
    return {what, subject_.octree, std::move(mesh), infinite, shifts * shift_mm_};
  }

  const Subject& subject_;
  std::vector<voxel::VoxelFace> boundary_;
  std::mt19937_64 random_;
  double shift_mm_ = between(0.02, 0.5);
};

/// Every error over the limit must be found. Returns how many of each kind were over it.
void expect_errors_found(const Subject& subject, std::uint64_t seeds, std::map<std::string, int>& over) {
  const voxel::Octree digitised = subject.digitised(subject.mesh);
  const Places right = judge_places(subject.octree, digitised, subject.mesh, subject.witness);
  ASSERT_TRUE(right.limit.shift_mm) << subject.name;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    Spoiler spoiler(subject, seed);
    const Spoiled spoiled = spoiler.next(seed);
    if (spoiled.volume_mm3 <= right.limit.volume_mm3) continue;
    if (spoiled.shift_mm > 0.0 && spoiled.shift_mm <= *right.limit.shift_mm) continue;
    ++over[spoiled.what];
    const Places places =
        contradicted_places(spoiled.octree, spoiled.keeps_mesh ? digitised : subject.digitised(spoiled.mesh),
                            spoiled.mesh, subject.witness);
    EXPECT_TRUE(places.voxel_count > 0 || places.stray_mm2 > 0.0)
        << subject.name << ", seed " << seed << ": " << spoiled.what << " of " << spoiled.volume_mm3
        << " mm3, " << spoiled.shift_mm << " mm passes; " << told(right);
  }
}

/// More with OCTOTOMY_ERRORS in the environment.
std::uint64_t errors_of_each() {
  const char* wanted = std::getenv("OCTOTOMY_ERRORS");
  return wanted != nullptr ? std::strtoull(wanted, nullptr, 10) : kinds;
}

/// A box of which the mesh kernel's interpolation leaves out a layer, from x = 19 to 22 mm.
TEST(Places, OfPartsAKernelThatKeepsACertainWordIsRight) {
  voxel::Universe universe;
  universe.depth = 5;
  const auto box = [](double high_x) {
    return Expression(voxel::Box{glm::dvec3(8.5), {high_x, 20.5, 20.5}});
  };
  const brep::Solid surface = brep::solid_of(brep::Prism{
      {0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {{{8.5, 8.5}, {18.5, 8.5}, {18.5, 20.5}, {8.5, 20.5}}}, -20.5, -8.5});
  const voxel::Octree voxels = voxel::combine(universe, box(22.5)),
                      fewer = voxel::combine(universe, box(18.5));
  const Witness whole = [](const glm::dvec3& p_mm, double) -> Reading {
    const auto depth = [&](double high_x) {
      const glm::dvec3 inward = glm::min(p_mm - 8.5, glm::dvec3(high_x, 20.5, 20.5) - p_mm);
      return std::min({inward.x, inward.y, inward.z});
    };
    if (std::abs(depth(18.5)) < 0.01) return {on_surface, on_surface, 3};
    return {depth(22.5) > 0.0 ? certainly_in : certainly_out,
            depth(18.5) > 0.0 ? certainly_in : certainly_out};
  };
  const auto contradicted = [&](const Witness& witness, const voxel::Octree& octree,
                                const brep::Solid& mesh) {
    return judge_places(octree, convert::voxelise(universe, mesh.linked()), mesh, witness).voxel_count;
  };
  EXPECT_EQ(contradicted(whole, voxels, surface), 0U);
  EXPECT_EQ(contradicted(witness_of_parts(whole), voxels, surface), 0U);
  EXPECT_EQ(contradicted(witness_of_parts(whole), fewer, surface), 0U) << "the layer may be a part left out";
  EXPECT_GT(contradicted(witness_of_parts(whole), voxels, brep::Solid()), 1000U) << "one has lost the part";
}

/// Crumbs of 26 voxels and of 27 that the mesh has left out, and a bite of eight.
TEST(Places, OfPartsACrumbThatNoFaceHoldsIsChanceAndABiteIsNone) {
  voxel::Universe universe;
  universe.depth = 5;
  const auto box = [](const glm::dvec3& low, const glm::dvec3& high) {
    return Expression(voxel::Box{low, high});
  };
  const Expression body = box(glm::dvec3(8.5), glm::dvec3(20.5)),
                   crumb = box(glm::dvec3(24.5), glm::dvec3(27.5)),
                   corner = box(glm::dvec3(26.5), glm::dvec3(27.5)),
                   bite = box(glm::dvec3(18.5), glm::dvec3(20.5));
  const brep::Solid surface = brep::solid_of(brep::Prism{
      {0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {{{8.5, 8.5}, {20.5, 8.5}, {20.5, 20.5}, {8.5, 20.5}}}, -20.5, -8.5});
  const Witness whole = [](const glm::dvec3& p_mm, double) -> Reading {
    const auto depth = [&](double low, double high) {
      const glm::dvec3 inward = glm::min(p_mm - low, high - p_mm);
      return std::min({inward.x, inward.y, inward.z});
    };
    if (std::abs(depth(8.5, 20.5)) < 0.01) return {on_surface, on_surface, 3};
    const AllowedSides allowed =
        std::max(depth(8.5, 20.5), depth(24.5, 27.5)) > 0.0 ? certainly_in : certainly_out;
    return {allowed, allowed};
  };
  const auto contradicted = [&](const Expression& octree) {
    return judge_places(voxel::combine(universe, octree), convert::voxelise(universe, surface.linked()),
                        surface, witness_of_parts(whole))
        .voxel_count;
  };
  EXPECT_EQ(contradicted(body), 0U);
  EXPECT_EQ(contradicted(body | (crumb - corner)), 0U);
  EXPECT_EQ(contradicted(body | crumb), 27U);
  EXPECT_EQ(contradicted(body - bite), 8U);
}

/// A lump that the mesh has left out, beside a body, and a neck of so many voxels between them.
TEST(Places, OfPartsALumpBeyondAThinNeckIsABridgeAndBeyondAThickOneOrNoneAnError) {
  voxel::Universe universe;
  universe.depth = 5;
  const brep::Solid surface = brep::solid_of(brep::Prism{
      {0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {{{8.5, 8.5}, {20.5, 8.5}, {20.5, 20.5}, {8.5, 20.5}}}, -20.5, -8.5});
  const auto judged = [&](double low_x, int across, bool is_open = false) {
    const voxel::Box body{glm::dvec3(8.5), glm::dvec3(20.5)},
        neck{{low_x, 11.5, 11.5}, {24.5, 11.5 + across, 11.5 + across}},
        lump{{24.5, 9.5, 9.5}, {30.5, 19.5, 19.5}};
    const Witness whole = [=](const glm::dvec3& p_mm, double) -> Reading {
      const auto depth = [&](const voxel::Box& box) {
        const glm::dvec3 inward = glm::min(p_mm - box.low_mm, box.high_mm - p_mm);
        return std::min({inward.x, inward.y, inward.z});
      };
      // Interpolation may close the neck where it leaves the body.
      const bool is_within_neck = std::min(p_mm.y, p_mm.z) > 11.5 && std::max(p_mm.y, p_mm.z) < 11.5 + across;
      if (std::abs(depth(body)) < 0.01 && (is_open || low_x > 20.5 || !is_within_neck))
        return {on_surface, on_surface, 3};
      const bool inside =
          std::max({depth(body), depth(neck), depth(lump)}) > 0.0 || std::abs(depth(body)) < 0.01;
      return {inside ? certainly_in : certainly_out, inside ? certainly_in : certainly_out};
    };
    const voxel::Octree voxels =
        voxel::combine(universe, Expression(body) | Expression(neck) | Expression(lump));
    return judge_places(voxels, convert::voxelise(universe, surface.linked()), surface,
                        witness_of_parts(whole));
  };
  const Places thin = judged(20.5, 2), thick = judged(20.5, 5), apart = judged(22.5, 2),
               interpolated = judged(20.5, 5, true);
  EXPECT_EQ(interpolated.voxel_count, 0U);
  ASSERT_EQ(interpolated.open.size(), 1U);
  EXPECT_EQ(interpolated.open.front().bridge.volume_mm3, 6.0 * 10.0 * 10.0 + 4.0 * 5.0 * 5.0);
  EXPECT_EQ(thin.voxel_count, 0U);
  ASSERT_EQ(thin.open.size(), 1U);
  EXPECT_EQ(thin.open.front().bridge.volume_mm3, 6.0 * 10.0 * 10.0 + 4.0 * 2.0 * 2.0);
  EXPECT_LT(glm::distance(thin.open.front().bridge.at_mm, glm::dvec3(21.0, 12.5, 12.5)), 2.0);
  for (const Places* error : {&thick, &apart}) {
    EXPECT_GE(error->voxel_count, 600U);
    EXPECT_TRUE(error->open.empty());
  }
}

/// A body with a lump beyond a neck that passes between the voxels' centres.
class LumpOnAThread : public testing::Test {
 protected:
  LumpOnAThread() { universe_.depth = 5; }
  static double depth(const voxel::Box& box, const glm::dvec3& p_mm) {
    const glm::dvec3 inward = glm::min(p_mm - box.low_mm, box.high_mm - p_mm);
    return std::min({inward.x, inward.y, inward.z});
  }
  Witness whole(bool with_thread) const {
    return [=, this](const glm::dvec3& p_mm, double) -> Reading {
      if (std::abs(depth(body_, p_mm)) < 0.01) return {on_surface, on_surface, 3};
      const double inside =
          std::max({depth(body_, p_mm), depth(lump_, p_mm), with_thread ? depth(thread_, p_mm) : -1.0});
      const AllowedSides allowed = inside > 0.0 ? certainly_in : certainly_out;
      return {allowed, allowed};
    };
  }
  Places judged(const Expression& voxels, const brep::Solid& mesh, const Witness& witness) const {
    return judge_places(voxel::combine(universe_, voxels), convert::voxelise(universe_, mesh.linked()), mesh,
                        witness);
  }
  /// The parts that the voxels chose contain the lump, those that the mesh chose do not.
  ChosenParts chosen(std::vector<glm::dvec3> decided_mm = {}) const {
    return {voxel::combine(universe_, Expression(body_) | Expression(lump_)), body_mesh_,
            std::move(decided_mm)};
  }

  voxel::Universe universe_;
  voxel::Box thread_{{20.1, 12.1, 12.1}, {25.1, 12.4, 12.4}};
  const voxel::Box body_{glm::dvec3(8.5), glm::dvec3(20.5)};
  voxel::Box lump_{{24.5, 9.5, 9.5}, {30.5, 19.5, 19.5}};
  const brep::Solid body_mesh_ = brep::solid_of(brep::Prism{
      {0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {{{8.5, 8.5}, {20.5, 8.5}, {20.5, 20.5}, {8.5, 20.5}}}, -20.5, -8.5});
};

TEST_F(LumpOnAThread, IsABridgeAndWithoutTheThreadAnError) {
  const Expression both_parts = Expression(body_) | Expression(lump_);
  const Places held = judged(both_parts, body_mesh_, witness_of_parts(whole(true))),
               loose = judged(both_parts, body_mesh_, witness_of_parts(whole(false)));
  EXPECT_EQ(held.voxel_count, 0U);
  ASSERT_EQ(held.open.size(), 1U);
  EXPECT_EQ(held.open.front().bridge.volume_mm3, 600.0);
  EXPECT_LT(glm::distance(held.open.front().bridge.at_mm, glm::dvec3(20.0, 12.0, 12.0)), 2.0);
  EXPECT_EQ(loose.voxel_count, 600U);
}

TEST_F(LumpOnAThread, StaysOpenInWhatIsCutFromTheChosenPartsAndMoved) {
  const voxel::Box region{{22.2, 5.2, 5.2}, {31.2, 25.2, 25.2}};
  const Expression lump_alone = Expression(lump_) & Expression(region);
  const Witness carried_on = both(witness_of_parts(whole(true), chosen()), witness_of_box(region)),
                unknown = both(witness_of_parts(whole(true)), witness_of_box(region));
  EXPECT_TRUE(judged(lump_alone, brep::Solid(), carried_on).open.size() == 1U);
  EXPECT_EQ(judged(lump_alone, brep::Solid(), carried_on).voxel_count, 0U);
  EXPECT_EQ(judged(lump_alone, brep::Solid(), unknown).voxel_count, 600U) << "nobody knows that it was open";
  const glm::dmat4 motion = voxel::moved_from_still({{-6.3, 1.4, 0.6}, 10.0, {1, 0.2, 0}, {27, 15, 15}});
  const Places moved = judged(voxel::moved(lump_alone, motion), brep::Solid(), carried(carried_on, motion));
  EXPECT_EQ(moved.voxel_count, 0U);
  ASSERT_EQ(moved.open.size(), 1U);
  // The choices agree on the body, so nothing about it is uncertain.
  const Places lost = judged(Expression(body_), brep::Solid(), witness_of_parts(whole(true), chosen()));
  EXPECT_GT(lost.voxel_count, 1000U);
}

// The thread passes between the points at which the reading is followed, a quarter of a voxel apart.
TEST_F(LumpOnAThread, IsABridgeWhereTheMeshAloneShowsTheThread) {
  thread_ = {{20.1, 12.05, 12.05}, {25.1, 12.2, 12.2}};
  const auto prism = [](const voxel::Box& box) {
    const glm::dvec3 &a = box.low_mm, &b = box.high_mm;
    return brep::solid_of(brep::Prism{
        {0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {{{a.x, a.y}, {b.x, a.y}, {b.x, b.y}, {a.x, b.y}}}, -b.z, -a.z});
  };
  const auto with = [](const brep::Solid& a, const brep::Solid& b) {
    return brep::boolean(a, brep::Operation::Union, b).solid;
  };
  const brep::Solid apart = with(body_mesh_, prism(lump_)), joined = with(apart, prism(thread_));
  ASSERT_EQ(joined.components().size(), 1U);
  const voxel::Octree body = voxel::combine(universe_, Expression(body_));
  const auto judged_with = [&](const brep::Solid& mesh) {
    return judged(Expression(body_), mesh, witness_of_parts(whole(true), {body, mesh}));
  };
  const Places held = judged_with(joined);
  EXPECT_EQ(held.voxel_count, 0U);
  ASSERT_EQ(held.open.size(), 1U);
  EXPECT_EQ(held.open.front().bridge.volume_mm3, 600.0);
  EXPECT_LT(glm::distance(held.open.front().bridge.at_mm, glm::dvec3(20.5, 12.0, 12.0)), 2.0);
  const Places loose = judged_with(apart);
  EXPECT_EQ(loose.voxel_count, 600U);
  EXPECT_TRUE(loose.open.empty());
}

// The certificate says that a part of its limit's size could be wrong anywhere, so a lump up to it is listed alone.
TEST_F(LumpOnAThread, LowersTheVerdictAboveTheLimitAndIsListedBelowIt) {
  for (const int side : {3, 9}) {
    lump_ = {{24.5, 11.5, 11.5}, glm::dvec3(24.5, 11.5, 11.5) + static_cast<double>(side)};
    BoundInputs inputs;
    inputs.witness = witness_of_parts(whole(true), chosen());
    const Certificate certificate =
        certify_bounded(voxel::combine(universe_, Expression(body_) | Expression(lump_)), body_mesh_, inputs);
    ASSERT_EQ(certificate.bridges.size(), 1U) << side;
    ASSERT_TRUE(certificate.limit) << side;
    const bool is_warned =
        std::any_of(certificate.reasons.begin(), certificate.reasons.end(),
                    [](const std::string& reason) { return reason.find("An ambiguous bridge") == 0; });
    EXPECT_EQ(certificate.bridges.front().volume_mm3 > certificate.limit->volume_mm3, side == 9) << side;
    EXPECT_EQ(is_warned, side == 9) << testing::PrintToString(certificate.reasons);
  }
}

TEST_F(LumpOnAThread, IsAnErrorWhereThePlanHasDecided) {
  const Places open =
      judged(Expression(body_) | Expression(lump_), body_mesh_, witness_of_parts(whole(true), chosen()));
  ASSERT_EQ(open.open.size(), 1U);
  const voxel::Box region{{22.2, 5.2, 5.2}, {31.2, 25.2, 25.2}};
  const Witness decided =
      both(witness_of_parts(whole(true), chosen({open.open.front().bridge.at_mm})), witness_of_box(region));
  EXPECT_EQ(judged(Expression(lump_) & Expression(region), brep::Solid(), decided).voxel_count, 600U);
}

TEST(Places, OfErrorsOverTheLimitAreAlwaysFound) {
  std::map<std::string, int> over;
  for (const double voxel_mm : {1.0, 2.0})
    for (const Subject& subject : subjects_of("phantom", phantom(), 300.0, voxel_mm, {0, -30}))
      expect_errors_found(subject, errors_of_each(), over);
  for (const char* kind :
       {"a bite", "a growth", "a saw cut", "a shift", "a scale", "a turn", "a film", "a mirror image"})
    EXPECT_GT(over[kind], 0) << kind << " was never over the limit";
}

/// A scan of a head, and the middle of a region of its bone in the anterior view.
struct RealHead {
  std::string name, file;
  glm::dvec2 middle_mm;
};
const std::vector<RealHead> real_heads{{"UNC", "ct_unc_cthead.nrrd", {0, 90}},
                                       {"cranium", "ct_invesalius_cranium.nii.gz", {125, 76}}};

Scan scan_of(const RealHead& head) {
  return std::make_shared<const voxel::Scene>(voxel::read_scene(tests::reference_data(head.file)));
}

/// At 1 mm; at 2 mm, too, where more errors are wanted.
TEST(Places, OfErrorsInRealHeadsOverTheLimitAreAlwaysFound) {
  for (const RealHead& head : real_heads) OCTOTOMY_NEEDS_DATA(head.file);
  std::map<std::string, int> over;
  for (const RealHead& head : real_heads)
    for (const double voxel_mm : {1.0, 2.0}) {
      if (voxel_mm > 1.0 && errors_of_each() <= kinds) continue;
      for (const Subject& subject : subjects_of(head.name, scan_of(head), 300.0, voxel_mm, head.middle_mm))
        expect_errors_found(subject, errors_of_each(), over);
    }
  EXPECT_GT(over["a lost part"], 0);
}

TEST(Places, OfRightAnswersOnAPhantomAreNeverContradicted) {
  for (const Subject& subject : subjects_of("phantom", phantom(), 300.0, 1.3, {0, -30}))
    expect_right(subject);
}

TEST(Places, OfRightAnswersOnRealHeadsAreNeverContradicted) {
  for (const RealHead& head : real_heads) OCTOTOMY_NEEDS_DATA(head.file);
  // Noise about metal lies at the higher bound.
  for (const RealHead& head : real_heads)
    for (const Subject& subject : subjects_of(head.name, scan_of(head), 1200.0, 2.0, head.middle_mm))
      expect_right(subject);
}

TEST(Witness, SaysOfTheMeshAloneAndOfWordsAloneWhatItSaysOfAll) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> at(-70.0, 70.0);
  std::size_t near = 0;
  std::vector<Subject> subjects = subjects_of("phantom", phantom(), 300.0, 1.5, {0, 0});
  subjects.push_back(
      {"expression", subjects[0].octree, subjects[0].mesh,
       loosened(witness_of_expression(
                    "a ^ b", [&](const std::string& name) { return subjects[name == "a" ? 1 : 2].witness; }),
                0.05)});
  // Names that occur twice, complements, and operands of every cost.
  subjects.push_back(
      {"nested", subjects[0].octree, subjects[0].mesh,
       witness_of_expression("(a - b) | (b & ~(a & c)) | (c ^ a) - b", [&](const std::string& name) {
         return subjects[name == "a" ? 0 : name == "b" ? 1 : 2].witness;
       })});
  subjects.push_back({"parts", subjects[0].octree, subjects[0].mesh,
                      witness_of_filled(witness_of_parts(subjects[3].witness))});
  for (const Subject& subject : subjects) {
    std::vector<glm::dvec3> points(500);
    for (glm::dvec3& p : points) p = {at(random), at(random), at(random)};
    const std::vector<glm::dvec3>& vertices = subject.mesh.triangles().points_mm;
    for (std::size_t i = 0; i < 500; ++i) points.push_back(vertices[random() % vertices.size()]);
    for (const glm::dvec3& p : points) {
      const Reading both = subject.witness(p, 0.0), mesh = subject.witness.of_mesh(p);
      ASSERT_EQ(mesh.mesh, both.mesh) << subject.name << " at " << p.x << ", " << p.y << ", " << p.z;
      ASSERT_EQ(mesh.surfaces, both.surfaces) << subject.name << " at " << p.x << ", " << p.y << ", " << p.z;
      const Reading allowed_sides = subject.witness.allowed_sides(p);
      ASSERT_EQ(allowed_sides.mesh, both.mesh) << subject.name << " at " << p.x << ", " << p.y << ", " << p.z;
      ASSERT_EQ(allowed_sides.voxel, both.voxel)
          << subject.name << " at " << p.x << ", " << p.y << ", " << p.z;
      ASSERT_EQ(subject.witness.mesh_sides(p), both.mesh) << subject.name << " at " << p.x << ", " << p.y;
      near += both.mesh.near ? 1 : 0;
    }
  }
  EXPECT_GT(near, 1000u);
}

}  // namespace
}  // namespace octotomy::verify
