// SPDX-License-Identifier: AGPL-3.0-or-later
// Registrations of bones and generated bodies from random poses, of which up to 60 % is missing or foreign, and of
// bodies that have nothing in common. A wrong motion must be told, a right one must not be called failed.
// OCTOTOMY_REGISTRATIONS states how many, OCTOTOMY_REGISTRATION the first; the case's number is the seed.
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <iostream>
#include <numeric>
#include <random>

#include "brep/align/cloud_fit.h"
#include "brep/align/register_surfaces.h"
#include "brep/io/read_mesh.h"
#include "brep/mesh/components.h"
#include "brep/mesh/move.h"
#include "brep/mesh/split_fans.h"
#include "tests/brep/shapes.h"
#include "tests/reference_data.h"

namespace octotomy::brep {
namespace {

/// A body and the motions that take it onto itself.
struct Body {
  std::string name;
  Triangles surface;
  std::vector<glm::dmat4> own = {glm::dmat4(1.0)};
};

Triangles of_size_mm(Triangles surface, double size_mm) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const glm::dvec3& p : surface.points_mm) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  for (glm::dvec3& p : surface.points_mm) p = (p - 0.5 * (low + high)) * (size_mm / glm::length(high - low));
  return surface;
}

template <typename Place>
Triangles ball_as(const Place& place) {
  Triangles surface = shapes::sphere({0, 0, 0}, 1, 4);
  for (glm::dvec3& p : surface.points_mm) p = place(p);
  return surface;
}

std::vector<Body> bodies() {
  std::vector<Body> all;
  const auto read = [&](const char* name, double size_mm) {
    all.push_back(
        {name, of_size_mm(joined_surface(read_triangles(tests::reference_data(name))).surface, size_mm)});
  };
  read("meshes_bone/spl_mandible.vtk", 140);
  read("meshes_bone/spl_atlas_C1.vtk", 80);
  read("meshes_bone/spl_hyoid.vtk", 50);
  read("meshes/cgal_femur.off", 200);
  read("meshes/fran_cut.vtk", 250);
  all.push_back({"bent tube", ball_as([](const glm::dvec3& p) {
                   const double r = 6.0 + 2.5 * p.x * p.x + 1.5 * p.x + 0.8 * std::sin(9.0 * p.x);
                   return glm::dvec3(70.0 * p.x, 12.0 * std::sin(2.6 * p.x) + r * p.y,
                                     3.0 * std::cos(3.0 * p.x) + r * (0.8 - 0.2 * p.x) * p.z);
                 })});
  for (const glm::dvec3& bumps : {glm::dvec3(1, 1, 1), glm::dvec3(0.5, -0.7, 1.5)})
    all.push_back({"bumpy ball", ball_as([&](const glm::dvec3& p) {
                     return p * (30.0 + 6.0 * bumps.x * std::sin(3.0 * p.x + 1.0) +
                                 5.0 * bumps.y * std::cos(4.0 * p.y) * p.z + 4.0 * bumps.z * p.x * p.y);
                   })});
  std::vector<glm::dmat4> half_turns = {glm::dmat4(1.0)};
  for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)})
    half_turns.push_back(glm::rotate(glm::dmat4(1.0), std::numbers::pi, axis));
  all.push_back(
      {"box", ball_as([](const glm::dvec3& p) {
         return p / std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) * glm::dvec3(20, 30, 45);
       }),
       half_turns});
  all.push_back(
      {"ellipsoid", ball_as([](const glm::dvec3& p) { return p * glm::dvec3(20, 32, 50); }), half_turns});
  return all;
}

double area_mm2(const Mesh& mesh) {
  double area = 0.0;
  for (const auto f : mesh.faces()) area += mesh.calc_face_area(f);
  return area;
}

/// The mesh without the triangles farthest along a direction that make up a share of the area.
Mesh lacking(const Mesh& mesh, double share, const glm::dvec3& direction) {
  std::vector<std::pair<double, std::uint32_t>> order;
  for (const auto f : mesh.faces()) {
    const Mesh::Point c = mesh.calc_face_centroid(f);
    order.emplace_back(c[0] * direction.x + c[1] * direction.y + c[2] * direction.z, f.idx());
  }
  std::sort(order.begin(), order.end());
  const double most_mm2 = (1.0 - share) * area_mm2(mesh);
  std::vector<std::uint32_t> faces;
  double kept_mm2 = 0.0;
  for (const auto& [along, face] : order) {
    kept_mm2 += mesh.calc_face_area(mesh.face_handle(face));
    if (kept_mm2 > most_mm2) break;
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  return part_of(mesh, faces);
}

enum class Kind { Whole, MovingLacks, FixedLacks, Foreign, BothLack, Unrelated };

int asked(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::atoi(text);
}

TEST(RegistrationTrials, WrongMotionsAreToldAndRightOnesNotCalledFailed) {
  OCTOTOMY_NEEDS_DATA("meshes/fran_cut.vtk");
  const std::vector<Body> all = bodies();
  // The first three, and hard cases: caps of a bumpy ball that fit elsewhere and have no rival
  // (106) or a poor one (286); a hyoid of which 48 % are left, right but matched by few (202).
  std::vector<int> seeds = {0, 1, 2, 106, 202, 286};
  if (const int count = asked("OCTOTOMY_REGISTRATIONS", 0); count > 0) {
    seeds.resize(static_cast<std::size_t>(count));
    std::iota(seeds.begin(), seeds.end(), asked("OCTOTOMY_REGISTRATION", 0));
  }
  int right = 0, right_trusted = 0, right_failed = 0, wrong_told = 0, wrong_untold = 0;
  for (const int i : seeds) {
    std::mt19937_64 random(static_cast<unsigned>(i));
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::normal_distribution<double> normal;
    const auto direction = [&] {
      const double x = normal(random), y = normal(random), z = normal(random);
      return glm::normalize(glm::dvec3(x, y, z));
    };
    const auto number = static_cast<std::size_t>(i);
    const Body& body = all[number % all.size()];
    const auto kind = static_cast<Kind>(number / all.size() % 6);
    const Mesh whole = mesh_of(body.surface);
    const double lost = 0.05 + 0.55 * share(random),
                 noise_mm = share(random) < 0.4 ? 0.0 : 0.3 * share(random);
    const glm::dvec3 side = direction();
    Mesh moving = whole, fixed = whole;
    if (kind == Kind::MovingLacks || kind == Kind::BothLack) moving = lacking(whole, lost, side);
    if (kind == Kind::FixedLacks || kind == Kind::BothLack) fixed = lacking(whole, lost, -side);
    if (kind == Kind::Unrelated) fixed = mesh_of(all[(number + 1 + number / 60) % all.size()].surface);
    for (Mesh* mesh : {&moving, &fixed})
      for (const auto v : mesh->vertices()) {
        const double x = normal(random), y = normal(random), z = normal(random);
        mesh->set_point(v, mesh->point(v) + noise_mm * Mesh::Point(x, y, z));
      }
    if (kind == Kind::Foreign) {  // another body beside or through it, of up to 60 % of the area
      const double foreign = 0.6 * share(random);
      Triangles other = all[std::uniform_int_distribution<std::size_t>(0, 7)(random)].surface;
      const double scale = std::sqrt(foreign / (1.0 - foreign) * area_mm2(moving) / area_mm2(mesh_of(other)));
      const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 6.28 * share(random), direction());
      const glm::dvec3 shift = 40.0 * share(random) * direction();
      for (glm::dvec3& p : other.points_mm) p = glm::dvec3(turn * glm::dvec4(scale * p, 1.0)) + shift;
      moving = mesh_of(shapes::together(triangles_of(moving), other));
    }
    const double angle = 3.14 * share(random), length_mm = 100.0 * share(random);
    const glm::dvec3 way = direction(), axis = direction();
    const glm::dmat4 truth = glm::rotate(glm::translate(glm::dmat4(1.0), length_mm * way), angle, axis);
    const SurfaceFit fit = register_surfaces(moved(moving, glm::inverse(truth)), fixed);

    const Cloud cloud = cloud_of(whole, 500, "whole");
    double error_mm = std::numeric_limits<double>::infinity();
    for (const glm::dmat4& own : body.own) {
      const glm::dmat4 left = fit.fixed_from_moving * glm::inverse(truth) - own;
      double squares = 0.0;
      for (const glm::dvec3& p : cloud.points_mm) {
        const glm::dvec3 step(left * glm::dvec4(p, 1.0));
        squares += glm::dot(step, step);
      }
      error_mm = std::min(error_mm, std::sqrt(squares / static_cast<double>(cloud.points_mm.size())));
    }
    const bool is_right = kind != Kind::Unrelated && error_mm < 0.05 * cloud.spread_mm;
    const FitVerdict verdict = fit.trust.value().verdict;
    right += is_right;
    right_trusted += is_right && verdict == FitVerdict::Right;
    right_failed += is_right && verdict == FitVerdict::Failed;
    wrong_told += !is_right && verdict != FitVerdict::Right;
    wrong_untold += !is_right && verdict == FitVerdict::Right;
    const std::string replay =
        "OCTOTOMY_REGISTRATION=" + std::to_string(i) + " OCTOTOMY_REGISTRATIONS=1: " + body.name +
        ", off by " + std::to_string(error_mm) + " mm, lacks " + std::to_string(lost) + ", matched " +
        std::to_string(fit.trust->matched_share) + " and elsewhere " +
        std::to_string(fit.trust->rival_share) + " within " + std::to_string(fit.trust->tolerance_mm) + " mm";
    EXPECT_TRUE(is_right || verdict != FitVerdict::Right) << replay;
    EXPECT_FALSE(is_right && verdict == FitVerdict::Failed) << replay << ": " << fit.trust->reason;
  }
  std::cout << seeds.size() << " registrations: " << right << " right, " << right_trusted
            << " of them trusted and " << right_failed << " called failed; " << wrong_told
            << " wrong and told, " << wrong_untold << " wrong and trusted\n";
  EXPECT_TRUE(right > 0 || seeds.size() < 3);
}

}  // namespace
}  // namespace octotomy::brep
