// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <limits>

#include "planner/cli/numbers.h"
#include "planner/cli/octree_out.h"
#include "planner/file/region_file.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct MaskText {
  fs::path out, slices, like, edit;
  std::vector<std::string> regions;
  std::optional<double> voxel_mm;
};

voxel::Region region_of(const std::string& text) {
  const auto colon = text.find(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size())
    throw CLI::ValidationError("--region",
                               "'" + text + "' is no region: give VIEW:FILE.json, as anterior:cut.json");
  try {
    return read_region(voxel::parse_view(text.substr(0, colon)), text.substr(colon + 1));
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--region", error.what());
  }
}

/// The mask's bounds along the patient's axes, from views along them.
class Bounds {
 public:
  void add(const glm::dvec3& direction, double low_mm, double high_mm) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(direction[axis]) != 1.0) continue;
      box_.low_mm[axis] = std::max(box_.low_mm[axis], direction[axis] > 0 ? low_mm : -high_mm);
      box_.high_mm[axis] = std::min(box_.high_mm[axis], direction[axis] > 0 ? high_mm : -low_mm);
    }
  }
  void add(const voxel::View& view, const std::vector<std::vector<glm::dvec2>>& polygons_mm) {
    glm::dvec2 low(std::numeric_limits<double>::infinity());
    glm::dvec2 high = -low;
    for (const auto& polygon : polygons_mm)
      for (const glm::dvec2& point : polygon) {
        low = glm::min(low, point);
        high = glm::max(high, point);
      }
    add(view.right, low.x, high.x);
    add(view.up, low.y, high.y);
  }
  voxel::Box box() const {
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(box_.high_mm[axis] - box_.low_mm[axis]) || box_.high_mm[axis] <= box_.low_mm[axis])
        throw std::runtime_error(
            "the regions do not bound the mask along x, y and z: draw it in another view too, or say whose "
            "voxels it has with --like FILE");
    return box_;
  }

 private:
  static constexpr double far = std::numeric_limits<double>::infinity();
  voxel::Box box_{glm::dvec3(-far), glm::dvec3(far)};
};

voxel::Universe universe_of_file(const fs::path& path, const std::optional<double>& voxel_mm) {
  if (is_octree(path)) return voxel::universe(voxel::read_octree(path));
  return universe_of(voxel::read_scene(path).lattice, voxel_mm);
}

/// The universe about what regions and slices enclose.
voxel::Universe universe_around(const voxel::RegionMask& regions,
                                const std::optional<voxel::SliceMask>& slices, double voxel_mm) {
  Bounds bounds;
  for (const voxel::Region& region : regions.regions) bounds.add(region.view, region.polygons_mm);
  if (slices) {
    const auto& all = slices->slices;
    std::vector<std::vector<glm::dvec2>> drawn;
    for (const auto& slice : all)
      drawn.insert(drawn.end(), slice.polygons_mm.begin(), slice.polygons_mm.end());
    bounds.add(slices->view, drawn);
    const std::size_t last = all.size() - 1;
    bounds.add(slices->view.look, all[0].position_mm - 0.5 * (all[1].position_mm - all[0].position_mm),
               all[last].position_mm + 0.5 * (all[last].position_mm - all[last - 1].position_mm));
  }
  return voxel::universe_around(bounds.box(), voxel_mm);
}

int mask(const Program& program, const MaskText& text) {
  need_octree_extension(text.out);
  need_folder_of(text.out);
  if (text.regions.empty() && text.slices.empty())
    throw CLI::ValidationError("--region", "a mask needs --region VIEW:FILE.json or --slices FILE.json");
  Timings timings;
  voxel::RegionMask regions;
  std::optional<voxel::SliceMask> slices;
  std::optional<voxel::Expression> expression;
  std::optional<voxel::Universe> universe;
  {
    const Stopwatch watch(timings, "read");
    for (const std::string& region : text.regions) regions.regions.push_back(region_of(region));
    if (!text.slices.empty()) slices = read_slices(text.slices);
    if (!text.like.empty()) universe = universe_of_file(text.like, text.voxel_mm);
    if (!text.edit.empty()) {
      const voxel::OctreeFile old = voxel::read_octree(text.edit);
      const auto* octree = std::get_if<voxel::Octree>(&old.tree);
      if (octree == nullptr)
        throw std::runtime_error(text.edit.string() + ": only a binary octree is a mask that can be edited");
      if (!universe) universe = octree->universe();
      expression = *octree;
    }
  }
  const auto also = [&](const voxel::Expression& part) {
    expression = expression ? *expression & part : part;
  };
  if (!regions.regions.empty()) also(regions);
  if (slices) also(*slices);
  if (!universe) universe = universe_around(regions, slices, text.voxel_mm.value_or(1.0));
  voxel::OctreeFile file{voxel::Octree::empty(*universe), text.out.stem().string(), ""};
  {
    const Stopwatch watch(timings, "combine");
    file.tree = voxel::combine(*universe, *expression);
  }
  std::vector<std::string> findings;
  if (std::get<voxel::Octree>(file.tree).is_empty())
    findings.emplace_back("the mask holds no voxel: its regions do not overlap, or lie outside the universe");
  Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION}, {"regions", text.regions}};
  if (slices) made["slices"] = text.slices.filename().string();
  if (!text.edit.empty()) made["edited"] = text.edit.filename().string();
  file.metadata = made.dump();
  return write_and_say(program, file, text.out, timings, findings);
}

}  // namespace

void add_mask(Program& program) {
  const auto text = std::make_shared<MaskText>();
  CLI::App& verb = program.verb(
      "mask", "Makes a volume of interest from regions drawn in views or on parallel slices",
      "octotomy mask -o cut.octree --region anterior:front.json --region left:side.json --like head.nrrd\n"
      "  octotomy mask -o less.octree --edit cut.octree --region 35,15:oblique.json\n"
      "A region's file: {\"polygons_mm\": [[[-40,-60],[40,-60],[40,-25],[-40,-25]]]}",
      [&program, text] { return mask(program, *text); });
  verb.add_option("-o,--out", text->out, "An .octree file")->required();
  verb.add_option("--region", text->regions,
                  "VIEW:FILE.json, repeated: the mask is what all of their back-projections enclose")
      ->type_name("VIEW:FILE")
      ->expected(1)
      ->take_all();
  verb.add_option("--slices", text->slices,
                  "FILE.json of regions on parallel slices: {\"view\": \"inferior\", \"slices\": "
                  "[{\"position_mm\": -40, \"polygons_mm\": [...]}, ...]}")
      ->check(CLI::ExistingFile);
  verb.add_option("--edit", text->edit, "A mask's .octree that the regions cut further")
      ->check(CLI::ExistingFile);
  verb.add_option("--like", text->like, "A scan or .octree whose voxels the mask has")
      ->check(CLI::ExistingPath);
  verb.add_option("--voxel", text->voxel_mm,
                  "Edge of a voxel, mm, around a scan or the regions; default: the scan's, or 1")
      ->check(above_zero());
}

}  // namespace octotomy::planner::cli
