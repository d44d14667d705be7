// SPDX-License-Identifier: AGPL-3.0-or-later
// Whole verbs, run as the program that stands beside this one, and what the kernels need for the same
// answers, called here: `kernels_s` tells their seconds and `ratio` how many times those the verb took.
// Processor seconds are those of the verb's process. `first_s` is when the first pictures can be looked at.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <spawn.h>
#include <stdexcept>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <variant>
#include <vector>

#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/health.h"
#include "convert/surface/isosurface.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/subjects.h"
#include "tests/bench/workspace.h"
#include "verify/phantom/head_phantom.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/build.h"
#include "voxel/tree/grey_octree.h"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX asks for it

namespace octotomy::bench {
namespace {

using Path = std::filesystem::path;

Path program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "octotomy";
}

/// Runs the program to its end, and calls `look` every few milliseconds in the meantime. Returns its exit
/// status, or -1 if it did not start or was killed.
int run_verb(std::vector<std::string> words, rusage& used, const std::function<void()>& look) {
  words.insert(words.begin(), program().string());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  pid_t child = -1;
  const int failed = ::posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return -1;
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::wait4(child, &status, WNOHANG, &used)) == 0) {
    look();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (ended != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double seconds_of(const std::function<void()>& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Verb {
  std::vector<std::string> words;
  std::function<void()> kernels;  ///< the same answers, without what verbs do beside
  Path page = {};                 ///< in a folder of the verb's own: what it shows first, where it does
};

/// `make` prepares the data. If they are missing, it throws std::runtime_error with the reason.
void run(benchmark::State& state, const std::function<Verb()>& make) {
  try {
    if (!std::filesystem::exists(program()))
      throw std::runtime_error(program().string() + " is not built: ninja octotomy");
    const Verb verb = make();
    const double kernels_s = seconds_of(verb.kernels);
    double verb_s = 0.0, first_s = 0.0;
    rusage used{};
    for (auto _ : state) {
      int status = 0;
      if (!verb.page.empty()) std::filesystem::remove_all(verb.page.parent_path());
      const auto start = std::chrono::steady_clock::now();
      first_s = 0.0;
      const auto look = [&] {
        if (first_s == 0.0 && !verb.page.empty() && std::filesystem::exists(verb.page))
          first_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      };
      verb_s += seconds_of([&] { status = run_verb(verb.words, used, look); });
      // Status 1 means a failed certificate, which takes the same time.
      if (status != 0 && status != 1)
        throw std::runtime_error("'" + verb.words.front() + "' ended with status " + std::to_string(status));
    }
    state.counters["kernels_s"] = kernels_s;
    state.counters["ratio"] = verb_s / static_cast<double>(state.iterations()) / kernels_s;
    if (!verb.page.empty()) state.counters["first_s"] = first_s;
    state.counters["cpu_s"] = seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
  }
}

/// The head phantom's scan at 1 mm, interpolated to other dimensions, as a NRRD file. Throws
/// std::runtime_error if the disk has no room for it.
Path fine_head(const glm::ivec3& dims) {
  const Path path = workspace() / ("head_" + std::to_string(dims.x) + "_" + std::to_string(dims.z) + ".nrrd");
  if (std::filesystem::exists(path)) return path;
  const auto bytes = sizeof(std::int16_t) * std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(dims.z);
  if (std::filesystem::space(workspace()).available < 2 * bytes)
    throw std::runtime_error(workspace().string() + ": no room for a scan of " + std::to_string(bytes >> 20) +
                             " MB: set TMPDIR");
  static const voxel::Scene coarse = verify::head_phantom({});
  const auto& samples = std::get<voxel::Int16Samples>(coarse.samples);
  const glm::ivec3 from = coarse.lattice.dims;
  const glm::dvec3 step = glm::dvec3(from - 1) / glm::dvec3(dims - 1),
                   spacing_mm = step * coarse.lattice.spacing_mm(),
                   first_mm = coarse.lattice.lps_mm(glm::dvec3(0.0));
  std::ofstream file(path, std::ios::binary);
  file << "NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: " << dims.x << ' '
       << dims.y << ' ' << dims.z << "\nspace directions: (" << spacing_mm.x << ",0,0) (0," << spacing_mm.y
       << ",0) (0,0," << spacing_mm.z << ")\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
       << "space origin: (" << first_mm.x << ',' << first_mm.y << ',' << first_mm.z << ")\n\n";
  std::vector<std::int16_t> row(static_cast<std::size_t>(dims.x));
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y) {
      for (int x = 0; x < dims.x; ++x) {
        const glm::dvec3 at = glm::dvec3(x, y, z) * step;
        const glm::ivec3 low = glm::min(glm::ivec3(at), from - 2);
        const glm::dvec3 t = at - glm::dvec3(low);
        double value = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
          const glm::ivec3 by(corner & 1, (corner >> 1) & 1, corner >> 2);
          const glm::dvec3 share = glm::mix(1.0 - t, t, glm::dvec3(by));
          const glm::ivec3 p = low + by;
          value += share.x * share.y * share.z *
                   samples[std::size_t(p.x) +
                           std::size_t(from.x) * (std::size_t(p.y) + std::size_t(from.y) * std::size_t(p.z))];
        }
        row[static_cast<std::size_t>(x)] = static_cast<std::int16_t>(std::lround(value));
      }
      file.write(reinterpret_cast<const char*>(row.data()),
                 static_cast<std::streamsize>(sizeof(std::int16_t) * row.size()));
    }
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
  return path;
}

constexpr double beyond = std::numeric_limits<double>::infinity();

/// The surface and the voxels of one window in both kernels.
void window_kernels(const voxel::Scene& scene, const voxel::GreyOctree& grey, double low) {
  benchmark::DoNotOptimize(convert::isosurface(scene, low, beyond).faces.size());
  benchmark::DoNotOptimize(
      voxel::combine(grey.universe(), voxel::Expression(voxel::Window{grey, low})).voxel_count());
}

/// A universe of 1 mm about a scan.
voxel::Universe universe_about(const voxel::Scene& scene) {
  return voxel::universe_around(voxel::bounds(scene.lattice), 1.0);
}

Verb look() {
  const Path scan = fine_head({512, 512, 200});
  return {{"look", scan.string(), "-o", (workspace() / "look").string()},
          [scan] {
            const voxel::Scene scene = voxel::read_scene(scan, {});
            const voxel::GreyOctree grey = voxel::grey_octree_of(universe_about(scene), scene, -1024);
            for (const double low : {300.0, -300.0}) window_kernels(scene, grey, low);
          },
          workspace() / "look/report.html"};
}

/// A skull cut by a mask, its piece moved and joined: seven objects with certificates.
Verb run_plan() {
  const char* const folder = std::getenv("OCTOTOMY_SHARED_DATA");
  const Path scan = Path(folder == nullptr ? "" : folder) / "ct_unc_cthead.nrrd";
  if (folder == nullptr || !std::filesystem::exists(scan))
    throw std::runtime_error("ct_unc_cthead.nrrd is not there: set OCTOTOMY_SHARED_DATA to its folder");
  const Path plan = workspace() / "unc.plan.json";
  std::ofstream(plan) << R"({"octotomy_plan": 1, "name": "Le Fort I", "scans": {"ct": {"path": ")" +
                             scan.string() + R"("}},
  "universe": {"voxel_mm": 1.0}, "steps": [
  {"id": "skull", "do": "window", "scan": "ct", "low": 300},
  {"id": "cut", "do": "mask", "regions": [
    {"view": "anterior", "polygons_mm": [[[-58, 69], [20, 69], [20, 97], [-58, 99]]]},
    {"view": "left", "polygons_mm": [[[-110, 69], [-48, 69], [-48, 93], [-110, 99]]]}]},
  {"id": "piece", "do": "combine", "expression": "skull & cut"},
  {"id": "rest", "do": "combine", "expression": "skull - cut"},
  {"id": "moved", "do": "move", "object": "piece", "translate_mm": [0, -6, 0],
   "rotate": {"degrees": 5, "axis": [1, 0, 0], "about_mm": [-19, -60, 90]}},
  {"id": "result", "do": "combine", "expression": "rest | moved"},
  {"id": "overlap", "do": "combine", "expression": "rest & moved"}]})";
  return {{"run", plan.string(), "-o", (workspace() / "run").string()}, [scan] {
            const voxel::Scene scene = voxel::read_scene(scan, {});
            window_kernels(scene, voxel::grey_octree_of(universe_about(scene), scene, -1024), 300.0);
          }};
}

/// The phantom's bone and its mirror image.
std::pair<Path, Path> bones() {
  const std::pair paths(bone_file(".ply"), workspace() / "reflected.ply");
  if (std::filesystem::exists(paths.second)) return paths;
  brep::Triangles bone = brep::read_triangles(paths.first);
  for (glm::dvec3& p : bone.points_mm) p.x = -p.x;
  for (auto& face : bone.faces) std::swap(face[0], face[1]);
  brep::write_mesh(bone, paths.second);
  return paths;
}

/// Each point's foot on the other surface.
Verb compare() {
  const auto [bone, reflected] = bones();
  return {{"compare", bone.string(), reflected.string()}, [bone = bone, reflected = reflected] {
            const brep::Triangles a = brep::read_triangles(bone), b = brep::read_triangles(reflected);
            benchmark::DoNotOptimize(brep::SurfaceTree(a).feet(b.points_mm).size());
            benchmark::DoNotOptimize(brep::SurfaceTree(b).feet(a.points_mm).size());
          }};
}

/// A surface is read, recognised as a solid, reflected and written.
Verb mirror() {
  const Path bone = bone_file(".ply");
  return {{"mirror", bone.string(), "-o", (workspace() / "mirrored.ply").string()}, [bone] {
            brep::Triangles surface = brep::read_triangles(bone);
            benchmark::DoNotOptimize(brep::health(surface).faces);
            for (glm::dvec3& p : surface.points_mm) p.x = -p.x;
            brep::write_mesh(surface, workspace() / "plainly.ply");
          }};
}

/// A surface's health.
Verb info() {
  const Path stl = bone_file(".stl");
  return {{"info", stl.string()},
          [stl] { benchmark::DoNotOptimize(brep::health(brep::read_triangles(stl)).faces); }};
}

Verb measure() {
  const Path scan = fine_head({1024, 1024, 648});
  return {{"measure", scan.string(), "--window", "300:"}, [scan] {
            const voxel::Scene scene = voxel::read_scene(scan, {});
            const voxel::Universe universe{10, scene.lattice.lps_from_voxel};
            benchmark::DoNotOptimize(voxel::octree_of_window(universe, scene, 300.0, beyond).voxel_count());
            benchmark::DoNotOptimize(convert::isosurface(scene, 300.0, beyond).faces.size());
          }};
}

Verb mesh() {
  const Path scan = fine_head({1024, 1024, 648});
  return {{"mesh", scan.string(), "--window", "300:", "-o", (workspace() / "mesh.stl").string()}, [scan] {
            benchmark::DoNotOptimize(
                convert::isosurface(voxel::read_scene(scan, {}), 300.0, beyond).faces.size());
          }};
}

}  // namespace

void register_verbs() {
  const auto add_verb = [](const std::string& name, Verb (*make)()) {
    benchmark::RegisterBenchmark(name.c_str(), [make](benchmark::State& state) { run(state, make); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->Iterations(1);
  };
  add_verb("verb/look/512x512x200", look);
  add_verb("verb/run/unc", run_plan);
  add_verb("verb/compare/500k", compare);
  add_verb("verb/mirror/500k", mirror);
  add_verb("verb/mesh/1024", mesh);
  add_verb("verb/measure/1024", measure);
  add_verb("verb/info/500k", info);
}

}  // namespace octotomy::bench
