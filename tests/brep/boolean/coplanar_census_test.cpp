// SPDX-License-Identifier: AGPL-3.0-or-later
// Booleans of operands whose faces are coplanar, nearly coplanar, touching or identical, turned as one to a
// random pose, against volumes in closed form of the pose before: boxes, prisms, sets of voxels, and a bone
// with a piece of it. A result has to be right to 1e-9 of the larger operand, or to what its findings allow.
// The long run, beside Manifold where OCTOTOMY_MANIFOLD names the folder of npm's manifold-3d: ninja
// coplanar_booleans.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <unistd.h>
#include <vector>

#include "brep/boolean/boolean.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/move.h"
#include "brep/mesh/split_fans.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using Random = std::mt19937_64;
double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
/// A whole number from `low` to `high`.
int whole(Random& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<std::uint64_t>(high - low + 1));
}

struct Pair {
  Triangles a, b;
  double a_mm3 = 0.0, b_mm3 = 0.0, common_mm3 = 0.0;
};

// ---- boxes

struct Box {
  glm::dvec3 low{0.0}, high{0.0};
  double volume_mm3() const {
    const glm::dvec3 size = glm::max(high - low, glm::dvec3(0.0));
    return size.x * size.y * size.z;
  }
};

Pair of_boxes(const Box& a, const Box& b) {
  const Box common{glm::max(a.low, b.low), glm::min(a.high, b.high)};
  return {shapes::box(a.low, a.high), shapes::box(b.low, b.high), a.volume_mm3(), b.volume_mm3(),
          common.volume_mm3()};
}

/// A box whose planes have few whole numbers, so that faces of two boxes share planes.
Box box_on_planes(Random& random) {
  Box box;
  for (int k = 0; k < 3; ++k) {
    const int low = whole(random, 0, 3);
    box.low[k] = 10.0 * low;
    box.high[k] = 10.0 * whole(random, low + 1, 4);
  }
  return box;
}

Pair flush_boxes(Random& random) {
  return of_boxes(box_on_planes(random), box_on_planes(random));
}

/// Flush but for 1e-3 to 1e-14 of their size.
Pair nearly_flush_boxes(Random& random) {
  const Box a = box_on_planes(random);
  Box b = box_on_planes(random);
  const double apart = std::pow(10.0, -uniform(random, 2.0, 13.0));
  for (int k = 0; k < 3; ++k) {
    const double by = apart * whole(random, -1, 1);
    b.low[k] += by;
    b.high[k] += by;
  }
  return of_boxes(a, b);
}

/// The boxes touch on a face, an edge or a corner.
Pair touching_boxes(Random& random) {
  const Box a = box_on_planes(random);
  Box b = box_on_planes(random);
  const int axes = whole(random, 1, 3), first = whole(random, 0, 2);
  for (int i = 0; i < axes; ++i) {
    const int k = (first + i) % 3;
    const double size = b.high[k] - b.low[k];
    if (random() % 2 == 0) {
      b.low[k] = a.high[k];
      b.high[k] = b.low[k] + size;
    } else {
      b.high[k] = a.low[k];
      b.low[k] = b.high[k] - size;
    }
  }
  return of_boxes(a, b);
}

/// The same box with other diagonals.
Pair identical_boxes(Random& random) {
  const Box a = box_on_planes(random);
  Pair pair = of_boxes(a, a);
  if (random() % 2 == 0)
    for (std::size_t f = 0; f + 1 < pair.b.faces.size(); f += 2) {
      const auto one = pair.b.faces[f], other = pair.b.faces[f + 1];  // (p, q, r), (p, r, s)
      pair.b.faces[f] = {one[0], one[1], other[2]};
      pair.b.faces[f + 1] = {one[1], one[2], other[2]};
    }
  return pair;
}

/// Flush boxes, in single precision as STL files are.
Pair boxes_of_files(Random& random) {
  return flush_boxes(random);
}

// ---- prisms

using Polygon = std::vector<glm::dvec2>;  // convex, counter-clockwise

double area_mm2(const Polygon& polygon) {
  long double twice = 0.0L;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    twice += static_cast<long double>(p.x) * q.y - static_cast<long double>(p.y) * q.x;
  }
  return static_cast<double>(twice / 2.0L);
}

/// Sutherland and Hodgman, "Reentrant polygon clipping", CACM 1974.
Polygon clipped(Polygon polygon, const Polygon& by) {
  for (std::size_t i = 0; i < by.size() && !polygon.empty(); ++i) {
    const glm::dvec2 from = by[i], along = by[(i + 1) % by.size()] - from;
    const auto side = [&](const glm::dvec2& p) {
      return along.x * (p.y - from.y) - along.y * (p.x - from.x);
    };
    Polygon kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const glm::dvec2 p = polygon[k], q = polygon[(k + 1) % polygon.size()];
      const double of_p = side(p), of_q = side(q);
      if (of_p >= 0.0) kept.push_back(p);
      if ((of_p > 0.0 && of_q < 0.0) || (of_p < 0.0 && of_q > 0.0))
        kept.push_back(p + (q - p) * (of_p / (of_p - of_q)));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

Triangles prism(const Polygon& base, double low, double high) {
  Triangles t;
  const auto n = static_cast<std::uint32_t>(base.size());
  for (const double z : {low, high})
    for (const glm::dvec2& p : base) t.points_mm.emplace_back(p, z);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    t.faces.push_back({i, j, n + j});
    t.faces.push_back({i, n + j, n + i});
    if (i > 0 && j > 0) {
      t.faces.push_back({0, j, i});
      t.faces.push_back({n, n + i, n + j});
    }
  }
  return t;
}

Polygon regular(Random& random) {
  const int corners = whole(random, 3, 12);
  const double radius = uniform(random, 8.0, 20.0), turn = uniform(random, 0.0, 6.28);
  Polygon polygon;
  for (int i = 0; i < corners; ++i) {
    const double angle = turn + 2.0 * std::numbers::pi * i / corners;
    polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return polygon;
}

Pair of_prisms(const Polygon& a, glm::dvec2 a_z, const Polygon& b, glm::dvec2 b_z) {
  const double common = std::max(0.0, std::min(a_z.y, b_z.y) - std::max(a_z.x, b_z.x));
  const Polygon both = clipped(a, b);
  return {prism(a, a_z.x, a_z.y), prism(b, b_z.x, b_z.y), area_mm2(a) * (a_z.y - a_z.x),
          area_mm2(b) * (b_z.y - b_z.x), common > 0.0 ? area_mm2(both) * common : 0.0};
}

/// One base, or one grown from a corner so that two sides stay flush; heights of a few whole numbers.
Pair flush_prisms(Random& random) {
  const Polygon a = regular(random);
  Polygon b = a;
  if (random() % 2 == 0) {
    const double share = 0.25 * whole(random, 1, 6);
    for (glm::dvec2& p : b) p = a.front() + share * (p - a.front());
  }
  const int a_low = whole(random, 0, 3), b_low = whole(random, 0, 3);
  return of_prisms(a, {5.0 * a_low, 5.0 * whole(random, a_low + 1, 4)}, b,
                   {5.0 * b_low, 5.0 * whole(random, b_low + 1, 4)});
}

/// The same prism twice, shifted by 1e-3 to 1e-14 of its size.
Pair nearly_identical_prisms(Random& random) {
  const Polygon a = regular(random);
  Polygon b = a;
  const double apart = std::pow(10.0, -uniform(random, 2.0, 13.0));
  const glm::dvec2 by = apart * glm::dvec2(uniform(random, -1, 1), uniform(random, -1, 1));
  for (glm::dvec2& p : b) p += by;
  const double up = apart * whole(random, -1, 1);
  return of_prisms(a, {-10.0, 10.0}, b, {-10.0 + up, 10.0 + up});
}

// ---- sets of voxels

using Voxels = std::vector<std::uint8_t>;  // of a cube of `edge`
constexpr int edge = 5;
constexpr double voxel_mm = 3.0;

bool is_in(const Voxels& set, int x, int y, int z) {
  return x >= 0 && y >= 0 && z >= 0 && x < edge && y < edge && z < edge &&
         set[static_cast<std::size_t>(x + edge * (y + edge * z))] != 0;
}

/// The exposed faces. Where voxels meet at an edge or corner only, the surface is pinched.
Triangles cuberille(const Voxels& set) {
  Triangles t;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto number = [&](const std::array<int, 3>& corner) {
    const auto [at, is_new] = known.try_emplace(corner, static_cast<std::uint32_t>(t.points_mm.size()));
    if (is_new) t.points_mm.push_back(voxel_mm * glm::dvec3(corner[0], corner[1], corner[2]));
    return at->second;
  };
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x)
        for (int k = 0; k < 3 && is_in(set, x, y, z); ++k)
          for (const int up : {0, 1}) {
            std::array<int, 3> at{x, y, z}, beside = at;
            beside[static_cast<std::size_t>(k)] += up ? 1 : -1;
            if (is_in(set, beside[0], beside[1], beside[2])) continue;
            at[static_cast<std::size_t>(k)] += up;
            std::array<std::array<int, 3>, 4> corners{at, at, at, at};
            const auto u = static_cast<std::size_t>((k + 1) % 3), v = static_cast<std::size_t>((k + 2) % 3);
            ++corners[1][u], ++corners[2][u], ++corners[2][v], ++corners[3][v];
            if (!up) std::swap(corners[1], corners[3]);
            const std::array<std::uint32_t, 4> n{number(corners[0]), number(corners[1]), number(corners[2]),
                                                 number(corners[3])};
            t.faces.push_back({n[0], n[1], n[2]});
            t.faces.push_back({n[0], n[2], n[3]});
          }
  return joined_surface(std::move(t)).surface;
}

double volume_mm3(const Voxels& set) {
  return static_cast<double>(std::count(set.begin(), set.end(), 1)) * voxel_mm * voxel_mm * voxel_mm;
}

Pair of_voxels(const Voxels& a, const Voxels& b) {
  Voxels both(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) both[i] = a[i] & b[i];
  return {cuberille(a), cuberille(b), volume_mm3(a), volume_mm3(b), volume_mm3(both)};
}

/// Unions of a few boxes of voxels.
Voxels blocks(Random& random) {
  Voxels set(edge * edge * edge, 0);
  for (int box = whole(random, 1, 3); box > 0; --box) {
    std::array<int, 3> low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = whole(random, 0, edge - 2);
      high[k] = whole(random, low[k] + 1, edge - 1);
    }
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) set[static_cast<std::size_t>(x + edge * (y + edge * z))] = 1;
  }
  return set;
}

Voxels noise(Random& random) {
  Voxels set(edge * edge * edge, 0);
  const double share = uniform(random, 0.2, 0.6);
  for (std::uint8_t& voxel : set) voxel = uniform(random, 0, 1) < share;
  set.front() = 1;
  return set;
}

Pair cuberilles(Random& random) {
  return of_voxels(blocks(random), blocks(random));
}
Pair pinched_cuberilles(Random& random) {
  return of_voxels(noise(random), noise(random));
}
Pair identical_cuberilles(Random& random) {
  const Voxels set = random() % 2 == 0 ? blocks(random) : noise(random);
  return of_voxels(set, set);
}

// ---- a bone and its own piece

/// A bumpy shaft with a head, star-shaped.
Solid bone() {
  Triangles surface = shapes::sphere({0, 0, 0}, 1.0, 4);
  for (glm::dvec3& p : surface.points_mm) {
    const double bumps = 1.0 + 0.05 * std::cos(7.0 * p.x + 1.0) + 0.06 * std::cos(9.0 * p.y + 5.0 * p.z);
    p *= bumps * (8.0 + 16.0 * p.z * p.z);
  }
  return solid_of(surface);
}

/// A bone, and the piece that a box or a prism cuts out of it. The piece is an operand here and not an answer
/// under test, and its volume is the truth for all three operations.
Pair bone_and_piece(Random& random) {
  static const Solid whole_bone = bone();
  const Polygon base = regular(random);
  const double low = uniform(random, -15.0, 10.0);
  const Solid tool = solid_of(prism(base, low, low + uniform(random, 2.0, 15.0)));
  const Solid piece = boolean(whole_bone, Operation::Intersection, tool).solid;
  return {whole_bone.triangles(), piece.triangles(), brep::volume_mm3(whole_bone), brep::volume_mm3(piece),
          brep::volume_mm3(piece)};
}

// ---- the census

struct Kind {
  const char* name;
  Pair (*pair)(Random&);
  bool is_float = false;
};

constexpr std::array kinds{Kind{"boxes, flush", flush_boxes},
                           Kind{"boxes, nearly flush", nearly_flush_boxes},
                           Kind{"boxes, touching", touching_boxes},
                           Kind{"boxes, identical", identical_boxes},
                           Kind{"boxes, flush, of floats", boxes_of_files, true},
                           Kind{"prisms, flush", flush_prisms},
                           Kind{"prisms, nearly identical", nearly_identical_prisms},
                           Kind{"cuberilles", cuberilles},
                           Kind{"cuberilles, pinched", pinched_cuberilles},
                           Kind{"cuberilles, identical", identical_cuberilles},
                           Kind{"a bone and its piece", bone_and_piece}};

glm::dmat4 any_pose(Random& random) {
  glm::dvec3 axis(0.0);
  while (glm::length(axis) < 0.1)
    axis = {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
  const glm::dvec3 shift(uniform(random, -100, 100), uniform(random, -100, 100), uniform(random, -100, 100));
  return glm::rotate(glm::translate(glm::dmat4(1.0), shift), uniform(random, 0.1, 6.2), glm::normalize(axis));
}

/// The volume error that the findings allow: each such sentence ends in "changes a volume by at most X mm3".
double stated_mm3(const std::vector<std::string>& findings) {
  double stated = 0.0;
  for (const std::string& finding : findings) {
    const std::string words = "changes a volume by at most ";
    if (const auto at = finding.find(words); at != std::string::npos)
      stated += std::strtod(finding.c_str() + at + words.size(), nullptr);
  }
  return stated;
}

struct Question {
  std::size_t kind = 0;
  int operation = 0;
  Solid a, b;
  double truth_mm3 = 0.0, larger_mm3 = 0.0;
  double given_mm3 = 0.0;  ///< what the points of the operands leave open themselves
};

Question question(std::uint64_t number) {
  Random random(number);
  Question asked;
  asked.kind = number % kinds.size();
  asked.operation = whole(random, 0, 2);
  const Pair pair = kinds[asked.kind].pair(random);
  const glm::dmat4 pose = any_pose(random);
  const auto posed = [&](Triangles t) {
    t = moved(t, pose);
    if (kinds[asked.kind].is_float)
      for (glm::dvec3& p : t.points_mm) p = glm::dvec3(glm::vec3(p));
    return trusted_solid(std::move(t), Proof::Rounded);
  };
  asked.a = posed(pair.a);
  asked.b = posed(pair.b);
  asked.larger_mm3 = std::max(pair.a_mm3, pair.b_mm3);
  asked.truth_mm3 = asked.operation == 0   ? pair.a_mm3 + pair.b_mm3 - pair.common_mm3
                    : asked.operation == 1 ? pair.common_mm3
                                           : pair.a_mm3 - pair.common_mm3;
  if (kinds[asked.kind].is_float) {
    double reach_mm = 0.0;
    for (const Solid* solid : {&asked.a, &asked.b})
      for (const glm::dvec3& p : {solid->size().low_mm, solid->size().high_mm})
        reach_mm = std::max({reach_mm, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    asked.given_mm3 = std::numeric_limits<float>::epsilon() * reach_mm *
                      (asked.a.size().area_mm2 + asked.b.size().area_mm2);
  }
  return asked;
}

struct Row {
  int count = 0, refused = 0, unfit = 0, over = 0, over_stated = 0, stating = 0;
  double worst = 0.0;
  int peer_refused = 0, peer_over = 0;
  double peer_worst = 0.0;
};

std::filesystem::path manifold_folder() {
  const char* named = std::getenv("OCTOTOMY_MANIFOLD");
  return named == nullptr ? std::filesystem::path() : std::filesystem::absolute(named);
}

void append(std::ofstream& out, const Triangles& surface) {
  const auto put = [&](auto value) { out.write(reinterpret_cast<const char*>(&value), sizeof value); };
  put(static_cast<std::uint32_t>(surface.points_mm.size()));
  put(static_cast<std::uint32_t>(surface.faces.size()));
  for (const glm::dvec3& p : surface.points_mm)
    for (int axis = 0; axis < 3; ++axis) put(p[axis]);
  for (const auto& face : surface.faces)
    for (const std::uint32_t corner : face) put(corner);
}

/// Manifold's volumes for all questions; none if it refuses.
std::vector<std::optional<double>> manifold_volumes(const std::filesystem::path& questions) {
  const std::string command = "node '" OCTOTOMY_SOURCE_DIR "/tests/brep/boolean/manifold_volumes.mjs' '" +
                              manifold_folder().string() + "' '" + questions.string() + "'";
  std::vector<std::optional<double>> volumes;
  std::FILE* said = ::popen(command.c_str(), "r");
  std::array<char, 64> line{};
  while (said != nullptr && std::fgets(line.data(), line.size(), said) != nullptr)
    volumes.push_back(line[0] == 'r' ? std::nullopt : std::optional(std::strtod(line.data(), nullptr)));
  if (said != nullptr) ::pclose(said);
  return volumes;
}

/// Tests 66 Booleans, or the number in OCTOTOMY_COPLANAR; a single one with OCTOTOMY_COPLANAR_ONE=number.
TEST(CoplanarCensus, VolumesAreRightOrTheErrorIsStatedInEveryPose) {
  const char *count_text = std::getenv("OCTOTOMY_COPLANAR"), *one = std::getenv("OCTOTOMY_COPLANAR_ONE");
  const int first = one ? std::atoi(one) : 0;
  const int last = one ? first + 1 : count_text ? std::atoi(count_text) : 66;
  const bool has_peer = !manifold_folder().empty();
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("coplanar-" + std::to_string(::getpid()) + ".bin");
  std::ofstream out;
  if (has_peer) out.open(file, std::ios::binary);
  std::array<Row, kinds.size()> rows;
  std::vector<std::array<double, 3>> truths;
  for (int i = first; i < last; ++i) {
    const Question asked = question(static_cast<std::uint64_t>(i));
    Row& row = rows[asked.kind];
    const std::string what = std::string(kinds[asked.kind].name) + ", operation " +
                             std::to_string(asked.operation) +
                             ": replay with OCTOTOMY_COPLANAR_ONE=" + std::to_string(i);
    ++row.count;
    if (has_peer) {
      const auto operation = static_cast<std::uint32_t>(asked.operation);
      out.write(reinterpret_cast<const char*>(&operation), sizeof operation);
      append(out, asked.a.triangles());
      append(out, asked.b.triangles());
      truths.push_back({asked.truth_mm3, asked.larger_mm3, asked.given_mm3});
    }
    constexpr std::array operations{Operation::Union, Operation::Intersection, Operation::Difference};
    std::optional<BooleanResult> result;
    try {
      result = boolean(asked.a, operations[static_cast<std::size_t>(asked.operation)], asked.b);
    } catch (const Error& error) {
      ++row.refused;
      ADD_FAILURE() << what << ": " << error.what();
      continue;
    }
    std::string findings;
    for (const std::string& finding : result->findings) findings += "\n  " + finding;
    if (!result->solid.empty()) {
      const Health found = health(result->solid.triangles());
      if (found.self_intersections + found.degenerate_faces + found.boundary_edges > 0) {
        ++row.unfit;
        ADD_FAILURE() << what << ": " << found.findings.front() << findings;
      }
    }
    const double volume = result->solid.empty() ? 0.0 : brep::volume_mm3(result->solid);
    const double error = std::abs(volume - asked.truth_mm3), stated = stated_mm3(result->findings);
    row.stating += stated > 0.0;
    row.worst = std::max(row.worst, error / asked.larger_mm3);
    const double allowed = 1e-9 * asked.larger_mm3 + asked.given_mm3;
    row.over += error > allowed && !(stated > 0.0);
    row.over_stated += stated > 0.0 && error > allowed + stated;
    EXPECT_LE(error, allowed + stated)
        << what << ": " << volume << " mm3, " << asked.truth_mm3 << " is right" << findings;
  }
  if (has_peer) {
    out.close();
    const std::vector<std::optional<double>> volumes = manifold_volumes(file);
    std::filesystem::remove(file);
    ASSERT_EQ(volumes.size(), truths.size()) << "Manifold did not answer all";
    for (std::size_t i = 0; i < volumes.size(); ++i) {
      Row& row = rows[(static_cast<std::size_t>(first) + i) % kinds.size()];
      if (!volumes[i]) {
        ++row.peer_refused;
        continue;
      }
      const auto& [truth_mm3, larger_mm3, given_mm3] = truths[i];
      const double error = std::abs(*volumes[i] - truth_mm3);
      row.peer_over += error > 1e-9 * larger_mm3 + given_mm3;
      row.peer_worst = std::max(row.peer_worst, error / larger_mm3);
    }
  }
  std::printf("%-26s %6s %8s %9s %9s %8s %10s %9s | %8s %8s %9s\n", "operands", "count", "refused",
              "no solid", "over 1e-9", "stated", "over that", "worst", "Manifold", "over 1e-9", "worst");
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const Row& row = rows[k];
    std::printf("%-26s %6d %8d %9d %9d %8d %10d %9.1e | %8d %9d %9.1e\n", kinds[k].name, row.count,
                row.refused, row.unfit, row.over, row.stating, row.over_stated, row.worst, row.peer_refused,
                row.peer_over, row.peer_worst);
  }
}

}  // namespace
}  // namespace octotomy::brep
