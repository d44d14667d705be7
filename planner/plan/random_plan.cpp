// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/random_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "verify/phantom/head_phantom.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

using verify::Random;
using verify::random_int;
using verify::random_real;

/// A scan of random waves no shorter than a third of its sides. A term that grows outside of an ellipsoid is
/// subtracted, so that positive samples do not reach the border.
voxel::Scene waves(Random& random, const glm::ivec3& dims, const glm::dvec3& spacing_mm) {
  voxel::Scene scene;
  scene.meaning = voxel::Meaning::Raw;
  scene.lattice = voxel::axis_aligned_lattice(dims, spacing_mm, -0.5 * glm::dvec3(dims - 1) * spacing_mm);
  const glm::dvec3 half_mm = 0.5 * glm::dvec3(dims) * spacing_mm;
  struct Wave {
    glm::dvec3 per_mm{0.0};
    double phase = 0.0;
  };
  std::array<Wave, 12> all;
  const double shortest_mm = 2.0 * std::min({half_mm.x, half_mm.y, half_mm.z}) / 3.0;
  for (Wave& wave : all) {
    const double z = random_real(random, -1.0, 1.0), turn = random_real(random, 0.0, 2.0 * M_PI);
    const double flat = std::sqrt(1.0 - z * z);
    const double length_mm = shortest_mm * random_real(random, 1.0, 3.0);
    wave = {glm::dvec3(flat * std::cos(turn), flat * std::sin(turn), z) * (2.0 * M_PI / length_mm),
            random_real(random, 0.0, 2.0 * M_PI)};
  }
  voxel::Int16Samples samples;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) {
        const glm::dvec3 p_mm = scene.lattice.lps_mm({x, y, z});
        double sum = 0.0;
        for (const Wave& wave : all) sum += std::cos(glm::dot(wave.per_mm, p_mm) + wave.phase);
        const double beyond = glm::length(p_mm / half_mm) - 0.75;
        samples.push_back(static_cast<std::int16_t>(
            std::lround(std::clamp(250.0 * sum - 8000.0 * std::max(beyond, 0.0), -3000.0, 3000.0))));
      }
  scene.samples = std::move(samples);
  scene.source = "random waves";
  return scene;
}

Json point(const glm::dvec2& p) {
  return Json::array({p.x, p.y});
}
Json point(const glm::dvec3& p) {
  return Json::array({p.x, p.y, p.z});
}

glm::dvec3 random_vector(Random& random, double reach) {
  const double x = random_real(random, -reach, reach), y = random_real(random, -reach, reach);
  return {x, y, random_real(random, -reach, reach)};
}

/// A polygon whose corners are sorted by their angle about a point, so that its sides do not cross.
Json region(Random& random, double size_mm) {
  constexpr std::array<const char*, 8> views{"anterior", "posterior", "left",  "right",
                                             "superior", "inferior",  "30,20", "-50,35"};
  const double u = random_real(random, -0.3, 0.3) * size_mm, v = random_real(random, -0.3, 0.3) * size_mm;
  Json polygon = Json::array();
  if (random_int(random, 0, 1) == 0) {
    const double half_u = random_real(random, 0.1, 0.5) * size_mm,
                 half_v = random_real(random, 0.1, 0.5) * size_mm;
    for (const glm::dvec2& corner : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
      polygon.push_back(point(glm::dvec2(u + half_u * corner.x, v + half_v * corner.y)));
  } else {
    const int corners = random_int(random, 3, 8);
    for (int i = 0; i < corners; ++i) {
      const double turn = 2.0 * M_PI * (i + random_real(random, 0.1, 0.9)) / corners;
      const double radius_mm = random_real(random, 0.15, 0.5) * size_mm;
      polygon.push_back(point(glm::dvec2(u + radius_mm * std::cos(turn), v + radius_mm * std::sin(turn))));
    }
  }
  return {{"view", views[static_cast<std::size_t>(random_int(random, 0, 7))]},
          {"polygons_mm", Json::array({polygon})}};
}

/// Makes the steps of a random plan one after the other.
class Author {
 public:
  Author(Random& random, const std::vector<RandomScan>& scans)
      : random_(random),
        scan_(scans[static_cast<std::size_t>(random_int(random, 0, static_cast<int>(scans.size()) - 1))]) {
    plan_.scans[scan_.name] = {{"path", scan_.path.string()}};
    size_mm_ = scan_.name == "head" ? 200.0 : 30.0;
  }

  std::string window() {
    const double low = std::round(random_real(random_, scan_.low_from, scan_.low_to));
    return add({{"do", "window"}, {"scan", scan_.name}, {"low", low}});
  }
  std::string mask() {
    Json regions = Json::array();
    for (int i = random_int(random_, 1, 2); i > 0; --i) regions.push_back(region(random_, size_mm_));
    return add({{"do", "mask"}, {"regions", regions}});
  }
  std::string move(const std::string& object) {
    Json step{{"do", "move"}, {"object", object}};
    step["translate_mm"] = point(random_vector(random_, 0.15 * size_mm_));
    if (random_int(random_, 0, 2) > 0)
      step["rotate"] = {{"degrees", random_real(random_, -40.0, 40.0)},
                        {"axis", point(random_vector(random_, 1.0) + glm::dvec3(0, 0, 1.5))},
                        {"about_mm", point(random_vector(random_, 0.3 * size_mm_))}};
    return add(step);
  }
  std::string combine(const std::vector<std::string>& operands, int leaves) {
    verify::RandomTreeOptions options;
    options.leaves = leaves;
    options.names = static_cast<int>(operands.size());
    options.xors = 1;
    const std::string id = add({{"do", "combine"}});
    plan_.steps.back().tree = verify::random_tree(random_, options);
    plan_.steps.back().operands = operands;
    return id;
  }
  RandomPlan plan() { return std::move(plan_); }
  bool chance(int of) { return random_int(random_, 1, of) == 1; }

 private:
  std::string add(const Json& step) {
    const std::string id = std::string(1, static_cast<char>('a' + plan_.steps.size()));
    Json with{{"id", id}};
    with.update(step);
    plan_.steps.push_back({with, {}, {}});
    return id;
  }

  Random& random_;
  const RandomScan& scan_;
  RandomPlan plan_;
  double size_mm_ = 0.0;
};

/// Removes the operands that an expression does not use, and numbers its leaves anew.
void drop_unused(RandomStep& step) {
  std::vector<int> number(step.operands.size(), -1);
  std::vector<std::string> used;
  const auto visit = [&](const auto& self, verify::ExpressionTree& tree) -> void {
    for (verify::ExpressionTree& part : tree.parts) self(self, part);
    if (!tree.parts.empty()) return;
    int& at = number[static_cast<std::size_t>(tree.leaf)];
    if (at < 0) {
      at = static_cast<int>(used.size());
      used.push_back(step.operands[static_cast<std::size_t>(tree.leaf)]);
    }
    tree.leaf = at;
  };
  visit(visit, step.tree);
  step.operands = used;
}

std::string id_of(const RandomStep& step) {
  return step.json.at("id").get<std::string>();
}

/// The plan without its step i, a motion. Later steps use the object that it moved.
RandomPlan without_motion(const RandomPlan& plan, std::size_t i) {
  const std::string gone = id_of(plan.steps[i]), still = plan.steps[i].json.at("object").get<std::string>();
  RandomPlan simple = plan;
  simple.steps.erase(simple.steps.begin() + static_cast<std::ptrdiff_t>(i));
  for (RandomStep& step : simple.steps) {
    std::replace(step.operands.begin(), step.operands.end(), gone, still);
    if (step.json.contains("object") && step.json["object"] == gone) step.json["object"] = still;
  }
  return simple;
}

}  // namespace

std::vector<RandomScan> write_random_scans(const std::filesystem::path& folder) {
  std::vector<RandomScan> scans;
  const auto add = [&](const std::string& name, const voxel::Scene& scene, double from, double to) {
    scans.push_back({name, folder / (name + ".nrrd"), from, to});
    voxel::write_scene(scene, scans.back().path);
  };
  Random random(1989);
  add("waves", waves(random, {32, 32, 32}, glm::dvec3(1.0)), -300.0, 300.0);
  add("ripples", waves(random, {40, 40, 40}, glm::dvec3(0.8)), -300.0, 300.0);
  add("oblong", waves(random, {40, 40, 20}, glm::dvec3(0.8, 0.8, 1.6)), -300.0, 300.0);
  verify::HeadOptions head;
  head.voxel_mm = 6.0;
  add("head", verify::head_phantom(head), 200.0, 400.0);
  return scans;
}

RandomPlan random_plan(Random& random, const std::vector<RandomScan>& scans) {
  Author author(random, scans);
  std::vector<std::string> objects{author.window()};
  if (author.chance(3)) objects.push_back(author.window());
  if (author.chance(2)) objects.push_back(author.mask());
  if (author.chance(3)) objects.push_back(author.mask());
  const std::vector<std::string> still = objects;
  for (const std::string& object : still)
    if (objects.size() < 5 && (objects.size() < 2 || author.chance(2)))
      objects.push_back(author.move(object));
  const std::string result = author.combine(objects, 6);
  if (author.chance(4)) author.combine({author.move(result), objects.front(), objects.back()}, 3);
  return author.plan();
}

std::string text(const RandomPlan& plan) {
  Json json{{"octotomy_plan", 1}, {"name", "random"}, {"scans", plan.scans}, {"steps", Json::array()}};
  for (const RandomStep& step : plan.steps) {
    Json with = step.json;
    if (with["do"] == "combine")
      with["expression"] =
          verify::text(step.tree, [&](int leaf) { return step.operands[static_cast<std::size_t>(leaf)]; });
    json["steps"].push_back(with);
  }
  return json.dump(2);
}

RandomPlan up_to(const RandomPlan& plan, const std::string& id) {
  std::set<std::string> needed{id};
  RandomPlan part;
  part.scans = plan.scans;
  for (auto step = plan.steps.rbegin(); step != plan.steps.rend(); ++step) {
    if (!needed.contains(id_of(*step))) continue;
    RandomStep kept = *step;
    if (!kept.operands.empty()) drop_unused(kept);
    needed.insert(kept.operands.begin(), kept.operands.end());
    if (kept.json.contains("object")) needed.insert(kept.json["object"].get<std::string>());
    part.steps.insert(part.steps.begin(), std::move(kept));
  }
  return part;
}

std::vector<RandomPlan> simpler(const RandomPlan& plan) {
  std::vector<RandomPlan> all;
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    const RandomStep& step = plan.steps[i];
    for (verify::ExpressionTree& tree : verify::simpler(step.tree)) {
      RandomPlan simple = plan;
      simple.steps[i].tree = std::move(tree);
      all.push_back(up_to(simple, id_of(plan.steps.back())));
    }
    if (step.json["do"] == "move" && i + 1 < plan.steps.size()) all.push_back(without_motion(plan, i));
    if (step.json["do"] == "move" && step.json.contains("rotate")) {
      RandomPlan simple = plan;
      simple.steps[i].json.erase("rotate");
      all.push_back(std::move(simple));
    }
    if (step.json["do"] == "mask" && step.json["regions"].size() > 1)
      for (std::size_t k = 0; k < step.json["regions"].size(); ++k) {
        RandomPlan simple = plan;
        simple.steps[i].json["regions"].erase(k);
        all.push_back(std::move(simple));
      }
  }
  return all;
}

}  // namespace octotomy::planner
