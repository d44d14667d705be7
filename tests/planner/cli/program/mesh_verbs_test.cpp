// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The verbs that make, measure, change and fill surfaces, as scripts see them.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "brep/io/write_mesh.h"
#include "brep/mesh/triangles.h"
#include "tests/brep/shapes.h"
#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::SortedJson;

class MeshVerbs : public tests::CommandLine {};

TEST_F(MeshVerbs, AnOctreeBecomesAMeshByEverySurfaceAndComesBackFromItsCuberille) {
  ASSERT_EQ(
      run("phantom sphere -o " + at("share.octree") + " --voxels 64 --radius 24 --digitise partial").status,
      0);
  ASSERT_EQ(run("phantom sphere -o " + at("ball.octree") + " --voxels 64 --radius 24").status, 0);
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " -o " + at("grey.octree") + " --grey").status, 0);
  const SortedJson smooth =
      SortedJson::parse(run("mesh " + at("share.octree") + " -o " + at("share.ply") + " --json").out);
  EXPECT_NEAR(smooth["volume_mm3"].get<double>() / (4.0 / 3.0 * M_PI * 13824.0), 1.0, 1e-3);
  EXPECT_NEAR(smooth["area_mm2"].get<double>() / (4.0 * M_PI * 576.0), 1.0, 5e-3);
  EXPECT_TRUE(smooth["closed"]);
  const SortedJson cubes = SortedJson::parse(
      run("mesh " + at("ball.octree") + " -o " + at("cubes.off") + " --surface cuberille --json").out);
  const CommandAnswer back = run("voxelise " + at("cubes.off") + " -o " + at("back.octree") + " --like " +
                                 at("ball.octree") + " --json");
  ASSERT_EQ(back.status, 0) << back.errors;
  EXPECT_EQ(SortedJson::parse(back.out)["voxels"].get<double>(), cubes["volume_mm3"].get<double>());
  ASSERT_EQ(run("eval \"a ^ b\" --let a=" + at("back.octree") + " --let b=" + at("ball.octree") + " -o " +
                at("none.octree"))
                .status,
            0);
  EXPECT_EQ(SortedJson::parse(run("info " + at("none.octree") + " --json").out)["voxels"], 0);
  const SortedJson grey = SortedJson::parse(
      run("mesh " + at("grey.octree") + " --window 0: -o " + at("grey.ply") + " --json").out);
  const SortedJson scan =
      SortedJson::parse(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("scan.ply") + " --json").out);
  EXPECT_EQ(grey["faces"], scan["faces"]);
  EXPECT_NEAR(grey["volume_mm3"].get<double>(), scan["volume_mm3"].get<double>(), 1e-6);
  const CommandAnswer fewer =
      run("mesh " + at("grey.octree") + " --window 0: -o " + at("few.ply") + " --faces 400 --smooth --json");
  ASSERT_EQ(fewer.status, 0) << fewer.errors;
  EXPECT_LE(SortedJson::parse(fewer.out)["faces"], 400);
  expect_refused(run("mesh " + at("ball.octree") + " --window 1: -o " + at("p.ply")), "no samples");
}

TEST_F(MeshVerbs, AnOffsetByNothingIsRefusedBeforeTheMeshIsRead) {
  write("no.stl", "broken");
  expect_refused(run("offset " + at("no.stl") + " --by 0 -o " + at("o.stl")),
                 "0 moves nothing: state a distance");
}

TEST_F(MeshVerbs, AShadowGoesAlongTheTypedDirectionToTheObjectsFarEnd) {
  brep::write_mesh(brep::mesh_of(brep::shapes::box({-2, -3, -5}, {2, 3, 5})), folder_ / "box.off");
  // The silhouette's area times half the depth, and half the box: it is its own mirror image about its
  // middle.
  const double silhouette_mm2 = 0.6 * 4 * 10 + 0.8 * 4 * 6, half_depth_mm = 0.5 * (0.6 * 6 + 0.8 * 10);
  const double truth_mm3 = silhouette_mm2 * half_depth_mm + 0.5 * 240.0;
  for (const char* direction : {"0,0.6,0.8", "0,-3,-4"}) {
    const CommandAnswer made =
        run("shadow " + at("box.off") + " --direction=" + direction + " -o " + at("shadow.off") + " --json");
    ASSERT_EQ(made.status, 0) << made.errors;
    const SortedJson json = SortedJson::parse(made.out);
    EXPECT_NEAR(json["volume_mm3"].get<double>(), truth_mm3, 1e-6) << direction;
    EXPECT_NEAR(json["filled_mm3"].get<double>(), truth_mm3 - 240.0, 1e-6) << direction;
    EXPECT_NEAR(json["end_mm"].get<double>(), half_depth_mm, 1e-9) << direction;
  }
  expect_refused(run("shadow " + at("box.off") + " -o " + at("s.off")), "the insertion direction is missing");
}

TEST_F(MeshVerbs, AScansContoursAreTiledToASolidByAnyCost) {
  const SortedJson iso =
      SortedJson::parse(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("i.ply") + " --json").out);
  for (const std::string tiling :
       {"shortest-span", "least-area", "greatest-volume", "least-angle", "overlay"}) {
    const CommandAnswer tiled = run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("t.vtp") +
                                    " --surface contours --tiling " + tiling + " --json");
    ASSERT_EQ(tiled.status, 0) << tiled.errors;
    const SortedJson json = SortedJson::parse(tiled.out);
    EXPECT_TRUE(json["closed"] && json["manifold"] && json["oriented"]) << tiling;
    EXPECT_EQ(json["self_intersections"], 0) << tiling;
    EXPECT_NEAR(json["volume_mm3"].get<double>() / iso["volume_mm3"].get<double>(), 1.0, 0.03) << tiling;
  }
  expect_refused(run("mesh " + at("ball.octree") + " -o " + at("t.ply") + " --surface contours"),
                 "ball.octree");
}

TEST_F(MeshVerbs, ContoursThatCrossAreRefusedByFileAndDrawnSlice) {
  std::ofstream(folder_ / "bow.json")
      << R"({"view": "inferior", "slices": [{"position_mm": 0, "polygons_mm": [[[0, 0], [9, 0], [9, 9]]]},)"
      << R"( {"position_mm": 4, "polygons_mm": [[[0, 0], [9, 9], [9, 0], [0, 9]]]}]})";
  const CommandAnswer bow = run("mesh " + at("bow.json") + " -o " + at("bow.off"));
  expect_refused(bow, "bow.json: the slice at 4 mm: polygon 1 crosses itself");
  EXPECT_NE(bow.errors.find("near [4.5, 4.5] mm: draw one outline"), std::string::npos) << bow.errors;
}

TEST_F(MeshVerbs, ContoursInAnotherUnitAreRefusedAtOnce) {
  const std::string square = R"("polygons_mm": [[[0, 0], [9, 0], [9, 9], [0, 9]]]})";
  std::ofstream(folder_ / "far.json") << R"({"view": "inferior", "slices": [{"position_mm": 0, )" << square
                                      << R"(, {"position_mm": 100000, )" << square << "]}";
  const CommandAnswer far = run("mesh " + at("far.json") + " -o " + at("far.off"));
  expect_refused(far, "far.json: the joined slices span 100000 mm");
  EXPECT_NE(far.errors.find("check that positions are in mm"), std::string::npos) << far.errors;
}

TEST_F(MeshVerbs, AMeshIsAskedForSectionsWaysAnglesWallsAndCurvature) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.off")).status, 0);
  const SortedJson ball = SortedJson::parse(run("measure " + at("ball.off") + " --json").out);
  const double x = ball["centroid_mm"][0], y = ball["centroid_mm"][1], z = ball["centroid_mm"][2];
  const double r = std::cbrt(ball["volume_mm3"].get<double>() * 3.0 / (4.0 * M_PI));
  const auto point = [](double a, double b, double c) {
    return " " + std::to_string(a) + "," + std::to_string(b) + "," + std::to_string(c);
  };
  const CommandAnswer asked =
      run("measure " + at("ball.off") + " --section" + point(x, y, z) + " 1,2,3 --distance 0,0,0 3,4,12 " +
          "--angle 1,0,0 0,0,0 0,2,0 --along" + point(x + r, y, z) + point(x, y + r, z) +
          " --thickness --curvature " + "--to " + at("ball.off") + " -o " + at("walls.vtp") + " --json");
  ASSERT_EQ(asked.status, 0) << asked.errors;
  const SortedJson json = SortedJson::parse(asked.out);
  EXPECT_NEAR(json["section"]["area_mm2"].get<double>(), M_PI * r * r, 0.03 * M_PI * r * r);
  EXPECT_EQ(json["distance_mm"], 13.0);
  EXPECT_EQ(json["angle_deg"], 90.0);
  EXPECT_NEAR(json["along"]["length_mm"].get<double>(), 0.5 * M_PI * r, 0.05 * r);
  for (const auto& off_mm : json["along"]["off_mm"]) EXPECT_LT(off_mm.get<double>(), 0.05 * r);
  EXPECT_EQ(json["gap"]["distance_mm"], 0.0);
  EXPECT_NEAR(json["oriented_box"]["edges_mm"][0].get<double>(), 2 * r, 0.1 * r);
  EXPECT_NEAR(json["thickness"]["ray"]["median_mm"].get<double>(), 2 * r, 0.1 * r);
  // A ball of few triangles is thinner than its diameter, by both kernels.
  EXPECT_NEAR(json["thickness"]["volume"]["mean_mm"].get<double>(), 2 * r, 0.1 * r);
  EXPECT_NEAR(json["thickness"]["wall"]["min_mm"].get<double>(), 2 * r, 0.2 * r);
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --window 0: -o " + at("ball.octree")).status, 0);
  const SortedJson voxels =
      SortedJson::parse(run("measure " + at("ball.octree") + " --thickness --json").out)["thickness"];
  const SortedJson& average = voxels["volume"]["average"];
  EXPECT_NEAR(average["value"].get<double>(), 2 * r, average["half_width"].get<double>() + 0.05 * r);
  EXPECT_NEAR(json["curvature"]["mean"]["mean_per_mm"].get<double>() * r, 1.0, 0.1);
  EXPECT_NEAR(json["inertia_mm5"][0][0].get<double>(), 0.4 * ball["volume_mm3"].get<double>() * r * r,
              0.03 * ball["volume_mm3"].get<double>() * r * r);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "walls.vtp"));
  EXPECT_NE(run("measure " + at("ball.off") + " --curvature").out.find("curvature"), std::string::npos);
  expect_refused(run("measure " + at("ball.nrrd") + " --window 0: --thickness"), "mesh");
  expect_refused(run("measure " + at("ball.off") + " --angle 0,0,0 0,0,0 1,0,0"), "--angle");
  // Typed points need no file. An option that would change nothing is refused.
  const SortedJson typed =
      SortedJson::parse(run("measure --distance 1,2,3 4,6,15 --angle 1,0,0 0,0,0 1,1,0 --json").out);
  EXPECT_DOUBLE_EQ(typed["distance_mm"], 13.0);
  EXPECT_NEAR(typed["angle_deg"].get<double>(), 45.0, 1e-12);
  expect_refused(run("measure --angle 0,0,0 0,0,0 1,0,0"), "--angle");
  expect_refused(run("measure --distance 1,2,3 4,6,15 --voxel 2"), "file is required");
  expect_refused(run("measure"), "file is required");
  expect_refused(run("measure " + at("ball.off") + " -o " + at("p.vtp")), "--thickness");
}

TEST_F(MeshVerbs, AMeshIsMendedOnlyAsAskedAndEachChangeIsListed) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.off") + " --faces 300").status, 0);
  // A triangle turned round, another lost, as the file's last two lines.
  std::ifstream whole(folder_ / "ball.off");
  std::vector<std::string> rows;
  for (std::string row; std::getline(whole, row);) rows.push_back(row);
  std::istringstream last(rows[rows.size() - 2]);
  int sides = 0, a = 0, b = 0, c = 0;
  last >> sides >> a >> b >> c;
  rows[rows.size() - 2] = "3 " + std::to_string(a) + " " + std::to_string(c) + " " + std::to_string(b);
  rows.pop_back();
  rows[2] = rows[2].substr(0, rows[2].find(' ')) + " " +
            std::to_string(rows.size() - 3 - std::stoul(rows[2])) + " 0";
  std::ofstream broken(folder_ / "broken.off");
  for (const std::string& row : rows) broken << row << "\n";
  broken.close();

  expect_refused(run("repair " + at("broken.off") + " -o " + at("mended.off")), "--weld");
  const CommandAnswer mended =
      run("repair " + at("broken.off") + " --orient --holes -o " + at("mended.off") + " --json");
  ASSERT_EQ(mended.status, 0) << mended.errors;
  const SortedJson json = SortedJson::parse(mended.out);
  EXPECT_FALSE(json["before"]["closed"]);
  EXPECT_TRUE(json["health"]["findings"].empty()) << json["health"];
  ASSERT_EQ(json["changes"].size(), 2u) << json["changes"];
  EXPECT_EQ(json["changes"][0]["step"], "orient");
  EXPECT_EQ(json["changes"][1]["step"], "holes");
}

TEST_F(MeshVerbs, ASurfaceIsMirroredAboutAPlaneGivenOrFitted) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.off") + " --faces 600").status, 0);
  const CommandAnswer given =
      run("mirror " + at("ball.off") + " --plane 5,0,0 1,0,0 --exactly -o " + at("image.off") + " --json");
  ASSERT_EQ(given.status, 0) << given.errors;
  const SortedJson ball = SortedJson::parse(run("measure " + at("ball.off") + " --json").out),
                   image = SortedJson::parse(run("measure " + at("image.off") + " --json").out);
  EXPECT_NEAR(ball["centroid_mm"][0].get<double>() + image["centroid_mm"][0].get<double>(), 10.0, 1e-9);
  EXPECT_NEAR(ball["volume_mm3"].get<double>(), image["volume_mm3"].get<double>(), 1e-6);
  const CommandAnswer fitted = run("mirror " + at("ball.off") + " --json");
  ASSERT_EQ(fitted.status, 0) << fitted.errors;
  EXPECT_LT(SortedJson::parse(fitted.out)["rms_mm"].get<double>(), 0.5);
  expect_refused(run("mirror " + at("ball.off") + " --exactly"), "--plane");
}

TEST_F(MeshVerbs, ASolidIsSawnAndItsBooleansAreProvenExactly) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.off") + " --faces 400").status, 0);
  const SortedJson ball = SortedJson::parse(run("measure " + at("ball.off") + " --json").out);
  const double x = ball["centroid_mm"][0], y = ball["centroid_mm"][1], z = ball["centroid_mm"][2];
  const auto point = [](double a, double b, double c) {
    return std::to_string(a) + "," + std::to_string(b) + "," + std::to_string(c);
  };
  const CommandAnswer sawn =
      run("saw " + at("ball.off") + " --line " + point(x - 90, y - 90, z) + " " + point(x + 90, y - 90, z) +
          " --direction 0,1,0 --depth 180 --kerf 1 -o " + at("halves.glb") + " --json");
  ASSERT_EQ(sawn.status, 0) << sawn.errors;
  const SortedJson halves = SortedJson::parse(sawn.out);
  EXPECT_EQ(halves["pieces"].size(), 2u);
  EXPECT_NEAR(halves["sawn_away_mm3"].get<double>() + halves["volume_mm3"].get<double>(),
              ball["volume_mm3"].get<double>(), 1e-6);
  expect_refused(run("saw " + at("ball.off") + " --line 0,0 1,1,1 --direction 0,1,0 -o " + at("p.stl")),
                 "0,0");

  // The same ball smoothed: the surfaces weave through each other.
  ASSERT_EQ(run("smooth " + at("ball.off") + " -o " + at("rough.off") + " --rounds 3").status, 0);
  const CommandAnswer exact = run("boolean " + at("ball.off") + " difference " + at("rough.off") +
                                  " --exact -o " + at("films.ply") + " --json");
  ASSERT_EQ(exact.status, 0) << exact.errors;
  const SortedJson proof = SortedJson::parse(exact.out)["exact"];
  EXPECT_NEAR(proof["a_mm3"].get<double>() + proof["b_mm3"].get<double>(),
              proof["union_mm3"].get<double>() + proof["intersection_mm3"].get<double>(), 1e-6);
  EXPECT_GT(proof["rounded_points"], 0);
}

TEST_F(MeshVerbs, ASolidBecomesADeckOfEveryKindAndABrokenOneOnlyByTheMarkedFallback) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.off") + " --faces 600").status, 0);
  const double truth = SortedJson::parse(run("measure " + at("ball.off") + " --json").out)["volume_mm3"];
  for (const std::string name : {"ball.inp", "ball.feb", "ball.vtu", "ball.msh", "ball.node"}) {
    const CommandAnswer answer = run("tet " + at("ball.off") + " -o " + at(name) + " --json");
    ASSERT_EQ(answer.status, 0) << answer.errors;
    const SortedJson json = SortedJson::parse(answer.out);
    EXPECT_NEAR(json["volume_mm3"].get<double>() / truth, 1.0, 1e-3) << name;
    EXPECT_GT(json["quality"]["min_dihedral_deg"].get<double>(), 1.0) << name;
    EXPECT_EQ(json["fallback"], false) << name;
    EXPECT_TRUE(std::filesystem::exists(folder_ / name)) << name;
  }
  EXPECT_TRUE(std::filesystem::exists(folder_ / "ball.ele"));
  const CommandAnswer stiff = run("tet " + at("ball.off") + " -o " + at("stiff.inp") + " --scan " +
                                  at("ball.nrrd") + " --bins 7 --json");
  ASSERT_EQ(stiff.status, 0) << stiff.errors;
  EXPECT_NE(stiff.errors.find("NOT CALIBRATED"), std::string::npos);
  EXPECT_GE(SortedJson::parse(stiff.out)["materials"], 1);
  write("open.off", "OFF\n4 3 0\n0 0 0\n20 0 0\n0 20 0\n0 0 20\n3 0 2 1\n3 0 1 3\n3 0 3 2\n");
  expect_refused(run("tet " + at("open.off") + " -o " + at("p.inp")), "--fallback");
  const CommandAnswer marked =
      run("tet " + at("open.off") + " -o " + at("open.inp") + " --fallback --voxel 1 --json");
  ASSERT_EQ(marked.status, 0) << marked.errors;
  EXPECT_EQ(SortedJson::parse(marked.out)["fallback"], true);
  EXPECT_NE(marked.out.find("fallback: "), std::string::npos);
  expect_refused(run("tet " + at("ball.off") + " -o " + at("p.stp")), ".feb");
  const CommandAnswer ten = run("tet " + at("ball.off") + " -o " + at("ten.vtu") + " --order 2 --json");
  ASSERT_EQ(ten.status, 0) << ten.errors;
  EXPECT_EQ(SortedJson::parse(ten.out)["order"], 2);
  EXPECT_GT(std::filesystem::file_size(folder_ / "ten.vtu"),
            2 * std::filesystem::file_size(folder_ / "ball.vtu"));
  expect_refused(run("tet " + at("ball.off") + " -o " + at("ten.node") + " --order 2"), "linear");
}

TEST_F(MeshVerbs, ElementsAreFinerAtPointsLandmarksAndAlongMeshesAndStiffnessComesFromBelowTheSurface) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.off") + " --faces 600").status, 0);
  write("plate.off", "OFF\n3 1 0\n-9 -9 0\n9 -9 0\n0 9 0\n3 0 1 2\n");
  write("marks.json", R"({ "landmarks": [ { "name": "apex", "point_mm": [0, 0, 12] } ] })");
  const std::string tet = "tet " + at("ball.off") + " -o " + at("ball.vtu") + " --json";
  const auto tets = [&](const std::string& options) {
    const CommandAnswer answer = run(tet + options);
    EXPECT_EQ(answer.status, 0) << answer.errors;
    return SortedJson::parse(answer.out)["tets"].get<int>();
  };
  const int even = tets("");
  const int at_point = tets(" --finer 0,0,12=0.4");
  EXPECT_GT(at_point, 1.2 * even);
  EXPECT_EQ(tets(" --landmarks " + at("marks.json") + " --finer apex=0.4"), at_point);
  EXPECT_GT(tets(" --finer 0,0,12=0.4 --finer " + at("plate.off") + "=1"), 1.2 * at_point);
  expect_refused(run(tet + " --finer apex=0.4"), "--landmarks");
  expect_refused(run(tet + " --finer 0,0,12"), "--finer: '0,0,12'");

  const auto softest_mpa = [&](const std::string& options) {
    const CommandAnswer answer =
        run("tet " + at("ball.off") + " -o " + at("stiff.inp") + " --scan " + at("ball.nrrd") + options);
    EXPECT_EQ(answer.status, 0) << answer.errors;
    std::ifstream deck(folder_ / "stiff.inp");
    double softest = 1e9;
    for (std::string line; std::getline(deck, line);)
      if (line == "*ELASTIC" && std::getline(deck, line)) softest = std::min(softest, std::stod(line));
    return softest;
  };
  // 1000 HU are 0.8 g/cm3 by the default calibration.
  const double bone_mpa = 6850.0 * std::pow(0.8, 1.49);
  EXPECT_LT(softest_mpa(""), 0.5 * bone_mpa) << "elements at the surface hold air, too";
  EXPECT_GT(softest_mpa(" --surface-depth 2"), 0.95 * bone_mpa);
}

TEST_F(MeshVerbs, OctreesBecomeRegionsOfSmoothElementsThatShareNodesOrTouch) {
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --window 0: -o " + at("ball.octree")).status, 0);
  voxel::write_scene(tests::ball_scene(6.0, 32), folder_ / "core.nrrd");
  ASSERT_EQ(run("octree " + at("core.nrrd") + " --window 0: -o " + at("core.octree")).status, 0);
  const std::string two = "tet " + at("core.octree") + " --region " + at("ball.octree");
  const CommandAnswer shared = run(two + " --size 3 -o " + at("two.inp") + " --json");
  ASSERT_EQ(shared.status, 0) << shared.errors;
  const SortedJson json = SortedJson::parse(shared.out);
  EXPECT_EQ(json["regions"], 2);
  EXPECT_EQ(json["fallback"], false);
  EXPECT_GT(json["quality"]["min_dihedral_deg"].get<double>(), 5.0);
  const CommandAnswer touching = run(two + " --size 3 --contact -o " + at("touch.inp") + " --json");
  ASSERT_EQ(touching.status, 0) << touching.errors;
  EXPECT_GT(SortedJson::parse(touching.out)["nodes"].get<int>(), json["nodes"].get<int>());
  const CommandAnswer voxels = run(two + " -o " + at("voxels.inp") + " --json");
  ASSERT_EQ(voxels.status, 0) << voxels.errors;
  EXPECT_EQ(SortedJson::parse(voxels.out)["fallback"], true);
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.off") + " --faces 600").status, 0);
  expect_refused(run("tet " + at("ball.off") + " --size 3 -o " + at("p.inp")), "voxelise");
}

TEST_F(MeshVerbs, AMeshBecomesAnOctreeAndSaysWhereItHadToGuess) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.off")).status, 0);
  const double truth = SortedJson::parse(run("measure " + at("ball.off") + " --json").out)["volume_mm3"];
  std::map<std::string, SortedJson> made;
  for (const std::string how : {"inside", "touching", "centre", "half", "partial"}) {
    const CommandAnswer answer = run("voxelise " + at("ball.off") + " -o " + at(how + ".octree") +
                                     " --voxel 0.5 --digitise " + how + " --json");
    ASSERT_EQ(answer.status, 0) << answer.errors;
    made[how] = SortedJson::parse(answer.out);
    EXPECT_EQ(made[how]["findings"].size(), made["inside"]["findings"].size()) << how;
  }
  EXPECT_LT(made["inside"]["voxels"], made["half"]["voxels"]);
  EXPECT_LT(made["half"]["voxels"], made["touching"]["voxels"]);
  EXPECT_EQ(made["partial"]["voxels"], made["touching"]["voxels"]);
  const SortedJson partial = SortedJson::parse(run("measure " + at("partial.octree") + " --json").out);
  EXPECT_NEAR(partial["volume_partial_mm3"].get<double>() / truth, 1.0, 1e-6);

  write("open.off", "OFF\n4 3 0\n0 0 0\n20 0 0\n0 20 0\n0 0 20\n3 0 2 1\n3 0 1 3\n3 0 3 2\n");
  const CommandAnswer open = run("voxelise " + at("open.off") + " -o " + at("open.octree") + " --json");
  ASSERT_EQ(open.status, 0) << open.errors;
  EXPECT_NE(open.out.find("winding number"), std::string::npos);
  EXPECT_GT(SortedJson::parse(open.out)["voxels"], 500);
  expect_refused(run("voxelise " + at("open.off") + " -o " + at("p.octree") + " --digitise half"),
                 "not a solid");
  expect_refused(run("voxelise " + at("open.off") + " -o " + at("p.octree") + " --voxel 0.0001"), "--voxel");
}

TEST_F(MeshVerbs, SmoothKeepsTheVolumeWithinItsShareAndWritesNothingWhereItDoesNot) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.stl")).status, 0);
  const CommandAnswer good = run("smooth " + at("ball.stl") + " -o " + at("smooth.stl") + " --json");
  ASSERT_EQ(good.status, 0) << good.errors;
  const SortedJson json = SortedJson::parse(good.out);
  EXPECT_TRUE(json.at("closed").get<bool>());
  EXPECT_LT(std::abs(json.at("volume_change_mm3").get<double>()), 0.01 * json.at("volume_mm3").get<double>());
  expect_refused(
      run("smooth " + at("ball.stl") + " -o " + at("none.stl") + " --rounds 1000 --max-volume-share 1e-9"),
      "volume");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.stl"));
}

TEST_F(MeshVerbs, AMeshThatWasMovedIsRegisteredAndComparedBackToNothing) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.stl")).status, 0);
  write("here.json", R"({"landmarks":[{"name":"a","point_mm":[0,0,0]},{"name":"b","point_mm":[10,0,0]},
      {"name":"c","point_mm":[0,10,0]},{"name":"only here","point_mm":[1,1,1]}]})");
  write("there.json", R"({"landmarks":[{"name":"c","point_mm":[-5,2,3]},{"name":"b","point_mm":[5,12,3]},
      {"name":"a","point_mm":[5,2,3],"weight":2}]})");
  const CommandAnswer points = run("register " + at("here.json") + " " + at("there.json") + " --json");
  ASSERT_EQ(points.status, 0) << points.errors;
  const SortedJson of_points = SortedJson::parse(points.out);
  EXPECT_LT(of_points.at("rms_mm").get<double>(), 1e-12);
  EXPECT_NEAR(of_points.at("transform")[0][1].get<double>(), -1.0, 1e-12);  // a quarter turn about z
  EXPECT_NEAR(of_points.at("transform")[2][3].get<double>(), 3.0, 1e-12);
  EXPECT_EQ(of_points.at("landmarks").at("left_out"), SortedJson::array({"only here"}));

  const std::string landmarks = " --landmarks " + at("here.json") + " " + at("there.json");
  ASSERT_EQ(run("register " + at("ball.stl") + " " + at("ball.stl") + landmarks + " --landmarks-only -o " +
                at("moved.ply"))
                .status,
            0);
  const CommandAnswer back =
      run("register " + at("moved.ply") + " " + at("ball.stl") + " --landmarks " + at("there.json") + " " +
          at("here.json") + " --overlap 1 -o " + at("back.ply") + " --json");
  ASSERT_EQ(back.status, 0) << back.errors;
  EXPECT_LT(SortedJson::parse(back.out).at("rms_mm").get<double>(), 1e-5);

  const CommandAnswer compared = run("compare " + at("back.ply") + " " + at("ball.stl") + " -o " +
                                     at("coloured.ply") + " --picture " + at("difference.png") + " --json");
  ASSERT_EQ(compared.status, 0) << compared.errors;
  const SortedJson json = SortedJson::parse(compared.out);
  EXPECT_LT(json.at("hausdorff_mm").get<double>(), 1e-4);
  EXPECT_GT(json.at("dice").get<double>(), 0.9999);
  EXPECT_TRUE(json.at("definition").contains("hausdorff95_mm"));
  EXPECT_EQ(run("info " + at("coloured.ply")).status, 0);

  const CommandAnswer apart = run("compare " + at("moved.ply") + " " + at("ball.stl") + " --json");
  ASSERT_EQ(apart.status, 0) << apart.errors;
  EXPECT_GT(SortedJson::parse(apart.out).at("hausdorff_mm").get<double>(), 3.0);
  EXPECT_LT(SortedJson::parse(apart.out).at("dice").get<double>(), 0.9);

  write("open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const CommandAnswer open = run("compare " + at("open.off") + " " + at("open.off") + " --json");
  ASSERT_EQ(open.status, 0) << open.errors;
  EXPECT_TRUE(SortedJson::parse(open.out).at("dice").is_null());
  expect_refused(run("register " + at("here.json") + " " + at("ball.stl")), "two files of the same kind");
}

std::string cube_off(int low, int high) {
  std::string text = "OFF\n8 12 0\n";
  for (int i = 0; i < 8; ++i) {
    for (const int bit : {1, 2, 4}) text += std::to_string(i & bit ? high : low) + " ";
    text += "\n";
  }
  return text +
         "3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n3 1 3 "
         "5\n3 3 7 5\n";
}

TEST_F(MeshVerbs, VoxelsHalfFilledNowhereSayWhatTheirSharesHold) {
  brep::write_mesh(brep::mesh_of(brep::shapes::box({0, 0, 0.2}, {20, 20, 0.4})), folder_ / "plate.off");
  ASSERT_EQ(run("voxelise " + at("plate.off") + " -o " + at("plate.octree") + " --digitise partial").status,
            0);
  const SortedJson found = SortedJson::parse(run("measure " + at("plate.octree") + " --json").out);
  EXPECT_EQ(found["volume_mm3"], 0.0);
  EXPECT_EQ(found["volume_half_width_mm3"], found["volume_partial_mm3"]);
  EXPECT_EQ(found["volume"]["half_width"], found["volume_partial_mm3"]);
  ASSERT_EQ(found["findings"].size(), 1U) << found["findings"];
  EXPECT_NE(found["findings"][0].get<std::string>().find("filled shares are 80.0"), std::string::npos)
      << found["findings"];
  const SortedJson kept = SortedJson::parse(
      run("eval a --let a=" + at("plate.octree") + " -o " + at("kept.octree") + " --json").out);
  EXPECT_EQ(kept["volume_counted_mm3"], 0.0);
  EXPECT_NEAR(kept["volume_counted_half_width_mm3"].get<double>(), 80.0, 0.1);
}

TEST_F(MeshVerbs, OptionsThatAMeshHasNoUseForAreRefusedOrTold) {
  write("one.off", cube_off(0, 8));
  expect_refused(run("measure " + at("one.off") + " --window 300:"), "--window");
  expect_refused(run("measure " + at("one.off") + " --voxel 1"), "--voxel");
  EXPECT_NE(run("measure " + at("one.off") + " --frame other.off=RAS").errors.find("other.off=RAS"),
            std::string::npos);
  EXPECT_EQ(run("measure " + at("one.off") + " --frame one.off=RAS").errors.find("one.off=RAS"),
            std::string::npos);
}

TEST_F(MeshVerbs, ShellsThatOverlapAreToldWhereTheirVolumeCountsTwice) {
  using brep::shapes::box;
  using brep::shapes::together;
  const auto findings = [&](const brep::Triangles& triangles) {
    brep::write_mesh(triangles, folder_ / "shells.off");
    const CommandAnswer answer = run("measure " + at("shells.off") + " --json");
    EXPECT_EQ(answer.status, 0) << answer.errors;
    return SortedJson::parse(answer.out)["findings"].dump();
  };
  const brep::Triangles one = box({0, 0, 0}, {8, 8, 8});
  for (const brep::Triangles& other : {box({6, 6, 6}, {14, 14, 14}), one})
    EXPECT_NE(findings(together(one, other)).find("the union of its closed shells was measured"),
              std::string::npos);
  for (const brep::Triangles& sound : {one, together(one, box({9, 0, 0}, {17, 8, 8}))})
    EXPECT_EQ(findings(sound).find("WARN"), std::string::npos);
}

TEST_F(MeshVerbs, SeveralMeshesBecomeALabelMapAndTellWhereTheyOverlap) {
  write("a.off", cube_off(0, 8));
  write("b.off", cube_off(6, 14));
  const CommandAnswer answer =
      run("voxelise " + at("a.off") + " " + at("b.off") + " -o " + at("ab.nrrd") + " --voxel 0.5 --json");
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const SortedJson json = SortedJson::parse(answer.out);
  ASSERT_EQ(json["labels"].size(), 2u);
  EXPECT_EQ(json["labels"][1]["name"], "b");
  EXPECT_NEAR(json["labels"][0]["volume_mm3"].get<double>(), 512, 1e-9);
  EXPECT_NEAR(json["labels"][1]["volume_mm3"].get<double>(), 512, 1e-9);
  EXPECT_EQ(json["overlaps"], 64);
  EXPECT_NE(json["findings"][0].get<std::string>().find("64 voxels lie in several"), std::string::npos);
  // Each part comes back to its place, without the part that the first one shares with the second.
  const SortedJson back =
      SortedJson::parse(run("segment " + at("ab.nrrd") + " --label 2 -o " + at("b.octree") + " --json").out);
  const SortedJson measured = SortedJson::parse(run("measure " + at("b.octree") + " --json").out);
  EXPECT_NEAR(measured["volume_mm3"].get<double>(), 512 - 8, 1e-9) << back;
  EXPECT_GT(measured["centroid_mm"][0].get<double>(), 10.0);
  expect_refused(run("voxelise " + at("a.off") + " " + at("b.off") + " -o " + at("ab.octree")), "label map");
  expect_refused(run("voxelise " + at("a.off") + " -o " + at("a.nrrd") + " --digitise partial"), "shares");
}

TEST_F(MeshVerbs, WhatAMeshFileSaysOfItselfIsShownAndOverriddenByOptions) {
  const brep::Triangles box = brep::shapes::box({10, 30, -5}, {20, 50, 25});
  std::ostringstream obj;
  obj << "# 3D Slicer output. SPACE=RAS\n";
  for (const glm::dvec3& p : box.points_mm) obj << "v " << -p.x << " " << -p.y << " " << p.z << "\n";
  for (const auto& f : box.faces) obj << "f " << f[0] + 1 << " " << f[1] + 1 << " " << f[2] + 1 << "\n";
  write("ras.obj", obj.str());
  const auto line = [](const SortedJson& audit, const std::string& check) -> SortedJson {
    for (const SortedJson& each : audit)
      if (each["check"] == check) return each;
    return nullptr;
  };
  const SortedJson info = SortedJson::parse(run("info " + at("ras.obj") + " --json").out);
  EXPECT_EQ(line(info["audit"], "frame")["verdict"], "PASS");
  EXPECT_EQ(line(info["audit"], "unit")["verdict"], "WARN");
  EXPECT_EQ(line(info["audit"], "writer")["detail"], "3D Slicer output. SPACE=RAS");
  const CommandAnswer measured = run("measure " + at("ras.obj") + " --json");
  EXPECT_EQ(SortedJson::parse(measured.out)["centroid_mm"], SortedJson::parse("[15.0, 40.0, 10.0]"));
  EXPECT_EQ(line(SortedJson::parse(measured.out)["meshes"][0]["audit"], "frame")["verdict"], "PASS");
  EXPECT_NE(measured.errors.find("ras.obj: WARN, unit"), std::string::npos) << measured.errors;
  const CommandAnswer turned = run("measure " + at("ras.obj") + " --json --frame LPS --unit cm");
  EXPECT_EQ(SortedJson::parse(turned.out)["centroid_mm"], SortedJson::parse("[-150.0, -400.0, 100.0]"));
  EXPECT_NE(turned.errors.find("WARN, frame"), std::string::npos) << turned.errors;
  // One result of two files.
  const CommandAnswer both = run("boolean " + at("ras.obj") + " union " + at("ras.obj") + " -o " +
                                 at("u.stl") + " --json --unit ras.obj=cm");
  EXPECT_NEAR(SortedJson::parse(both.out)["volume_mm3"].get<double>(), 6e6, 1.0) << both.errors;
  expect_refused(run("measure " + at("ras.obj") + " --unit ell"), "'ell' is not a unit");
  expect_refused(run("compare " + at("ras.obj") + " " + at("ras.obj") + " --frame up"),
                 "'up' is not a frame");
}

}  // namespace
}  // namespace octotomy::planner
