// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The verbs that draw, segment and prepare scans, as scripts see them.
#include "tests/file_bytes.h"
#include "tests/planner/cli/program/command_line.h"
#include "tests/planner/ct_scene.h"
#include "tests/reference_data.h"

namespace octotomy::planner {
namespace {

using tests::SortedJson;

class ScanVerbs : public tests::CommandLine {
 protected:
  SortedJson json(const std::string& arguments) const {
    const tests::CommandAnswer answer = run(arguments + " --json");
    EXPECT_EQ(answer.status, 0) << arguments << '\n' << answer.errors;
    return SortedJson::parse(answer.out, nullptr, false);
  }
};

TEST_F(ScanVerbs, SlicesAreInTrueScaleAndSayWhereTheyLie) {
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --window 0: -o " + at("ball.octree")).status, 0);
  const SortedJson axial = json("slice " + at("ball.nrrd") + " --axial 5 --pixel 0.5 --octree " +
                                at("ball.octree") + " --level 0,2000 -o " + at("axial.png"));
  EXPECT_EQ(axial["plane"], "axial");
  EXPECT_EQ(axial["position_mm"], 5.0);
  EXPECT_EQ(axial["size_px"], SortedJson({64, 64}));
  EXPECT_EQ(axial["window"], SortedJson({-1000.0, 1000.0}));
  EXPECT_EQ(axial["letters"], SortedJson({{"left", "R"}, {"right", "L"}, {"top", "A"}, {"bottom", "P"}}));
  EXPECT_EQ(axial["scale_bar_mm"], 5.0);
  // Pixel (0, 0) is at the patient's right front.
  EXPECT_EQ(axial["lps_from_pixel"][0], SortedJson({0.5, 0.0, 0.0, -15.75}));
  EXPECT_EQ(axial["lps_from_pixel"][1], SortedJson({0.0, 0.5, 0.0, -15.75}));
  EXPECT_EQ(axial["lps_from_pixel"][2][3], 5.0);
  EXPECT_NEAR(axial["outlines"][0]["area_mm2"].get<double>() / (M_PI * (144.0 - 25.0)), 1.0, 0.04);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "axial.png"));

  const SortedJson coronal = json("slice " + at("ball.octree") + " --coronal middle -o " + at("coronal.png"));
  EXPECT_EQ(coronal["letters"]["top"], "S");
  EXPECT_EQ(coronal["values"], SortedJson({0.0, 1.0}));
  const SortedJson sagittal =
      json("slice " + at("ball.nrrd") + " --sagittal -3 --plain -o " + at("sagittal.png"));
  EXPECT_EQ(sagittal["letters"]["left"], "A");
  EXPECT_TRUE(sagittal["scale_bar_mm"].is_null());
  const SortedJson oblique =
      json("slice " + at("ball.nrrd") + " --oblique 0,0,0 0,1,1 -o " + at("oblique.png"));
  EXPECT_EQ(oblique["position_mm"], 0.0);
  EXPECT_EQ(oblique["letters"]["right"], "L");
}

TEST_F(ScanVerbs, AnExpressionIsDrawnAsTheOctreeThatEvalMakesOfIt) {
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --window 0: -o " + at("a.octree")).status, 0);
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --window 500: -o " + at("b.octree")).status, 0);
  const std::string lets = " --let a=" + at("a.octree") + " --let b=" + at("b.octree");
  for (const std::string expression : {"a - b", "a & b", "a ^ ~b"}) {
    ASSERT_EQ(run("eval \"" + expression + "\" -o " + at("e.octree") + lets).status, 0);
    const std::string frame = " --size 90x90 --width 40 --centre 0,0,0 --view 35,15 -o " + at("e.png");
    const SortedJson made = json("render " + at("e.octree") + frame);
    const std::string pixels = tests::bytes_of(folder_ / "e.png");
    const SortedJson unmade = json("render --expression \"" + expression + "\"" + lets + frame);
    EXPECT_EQ(made["lit_pixels"], unmade["lit_pixels"]) << expression;
    EXPECT_GT(made["lit_pixels"].get<int>(), 500) << expression;
    EXPECT_EQ(tests::bytes_of(folder_ / "e.png"), pixels) << expression;
  }
  const std::string rest = " -o " + at("e.png");
  expect_refused(run("render --expression \"a - c\"" + lets + rest), "'c'");
  expect_refused(run("render --expression a" + lets + rest), "--let b");
  expect_refused(run("render --expression a --let a" + rest), "NAME=FILE");
  expect_refused(run("render --expression \"a -\" --let a=" + at("a.octree") + rest), "expected");
  expect_refused(run("render " + at("a.octree") + " --let a=" + at("a.octree") + rest), "--expression");
  expect_refused(run("render" + rest), "expression");
  expect_refused(run("render " + at("ball.nrrd") + " --window 0: --decide gradient --steeper 5" + rest),
                 "--window");
  expect_refused(run("render " + at("a.octree") + " --decide range" + rest), "samples");
  expect_refused(run("render " + at("a.octree") + " --shading density" + rest), "samples");
}

TEST_F(ScanVerbs, ACurveIsGivenAsPointsOrAsAFile) {
  write("curve.json", R"({"points_mm": [[-10, 5, 0], [0, -8, 0], [10, 5, 0]]})");
  const std::string rest = " --height 20 --pixel 0.5 -o " + at("curve.png");
  const SortedJson points = json("slice " + at("ball.nrrd") + " --curve=-10,5,0 0,-8,0 10,5,0" + rest);
  const SortedJson file = json("slice " + at("ball.nrrd") + " --curve " + at("curve.json") + rest);
  EXPECT_EQ(points["plane"], "curved");
  EXPECT_EQ(points["size_px"], SortedJson({static_cast<int>(std::ceil(2 * std::hypot(10, 13) / 0.5)), 40}));
  EXPECT_TRUE(points["lps_from_pixel"].is_null());
  for (const char* key : {"size_px", "values", "inside_pixels", "letters"})
    EXPECT_EQ(points[key], file[key]) << key;
}

TEST_F(ScanVerbs, SlicesThatCannotBeDrawnAreRefused) {
  const std::string out = " -o " + at("x.png");
  const std::string ball = "slice " + at("ball.nrrd");
  expect_refused(run(ball + " --axial 17" + out), "misses the scan");
  expect_refused(run(ball + " --axial 1 --coronal 2" + out), "one of");
  expect_refused(run(ball + " --axial top" + out), "top");
  expect_refused(run(ball + " --oblique 0,0,0 0,0,0" + out), "no length");
  expect_refused(run(ball + " --oblique 0,0 0,0,1" + out), "X,Y,Z");
  expect_refused(run(ball + " --curve 1,2,3" + out), "1,2,3");
  expect_refused(run(ball + " --level 5" + out), "CENTRE,WIDTH");
  expect_refused(run(ball + " --window bonne" + out), "did you mean 'bone'");
  expect_refused(run(ball + " --pixel 0.001" + out), "larger pixels");
  write("curve.json", R"({"points": [1]})");
  expect_refused(run(ball + " --curve " + at("curve.json") + out), "points_mm");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.png"));
}

TEST_F(ScanVerbs, ATissueIsAWindowOfHounsfieldUnitsEverywhere) {
  const SortedJson named = json("measure " + at("ball.nrrd") + " --window skin");
  EXPECT_EQ(named["window"], SortedJson({-300.0, nullptr}));
  EXPECT_EQ(named["volume_mm3"], json("measure " + at("ball.nrrd") + " --window=-300:")["volume_mm3"]);
  EXPECT_EQ(named["tissues"]["skin"]["low"], -300.0);
  EXPECT_FALSE(json("measure " + at("ball.nrrd") + " --window=-300:").contains("tissues"));
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --grey -o " + at("grey.octree")).status, 0);
  // Bone is the same window in every verb, requested or by default, and its numbers are reported with each
  // use.
  EXPECT_EQ(json("measure " + at("ball.nrrd") + " --window bone")["window"], SortedJson({300.0, nullptr}));
  EXPECT_NE(run("mesh " + at("ball.nrrd") + " -o " + at("d.stl")).errors.find("bone (from 300 HU)"),
            std::string::npos);
  const tests::CommandAnswer segmented =
      run("segment " + at("ball.nrrd") + " --window bone -o " + at("s.octree") + " --json");
  EXPECT_EQ(SortedJson::parse(segmented.out)["tissues"]["bone"]["low"], 300.0);
  EXPECT_NE(segmented.errors.find("bone (from 300 HU)"), std::string::npos) << segmented.errors;
  for (const std::string& verb :
       {"octree " + at("ball.nrrd") + " --window bone -o " + at("a.octree"),
        "render " + at("ball.nrrd") + " --window bone -o " + at("a.png"),
        "mesh " + at("ball.nrrd") + " --window bone -o " + at("a.stl"),
        "slice " + at("ball.nrrd") + " --window bone -o " + at("a.png"),
        "eval g --let g=" + at("grey.octree") + " --window g=bone -o " + at("b.octree")})
    EXPECT_EQ(run(verb).status, 0) << verb;
  voxel::Scene raw = tests::ball_scene(12.0, 32);
  raw.meaning = voxel::Meaning::Raw;
  raw.modality = "MR";
  voxel::write_scene(raw, folder_ / "raw.nrrd");
  for (const char* verb :
       {"measure", "octree -o x.octree", "mesh -o x.stl", "render -o x.png", "slice -o x.png"})
    expect_refused(run(std::string(verb) + " " + at("raw.nrrd") + " --window bone"), "Hounsfield");
}

TEST_F(ScanVerbs, ConvertToDicomTellsWhoseSeriesItWritesAndWhatItRounds) {
  const tests::CommandAnswer ball = run("convert " + at("ball.nrrd") + " --dicom -o " + at("ball_dicom"));
  EXPECT_EQ(ball.status, 0) << ball.errors;
  EXPECT_NE(ball.errors.find("'Anonymous', in a new study"), std::string::npos) << ball.errors;
  EXPECT_EQ(ball.errors.find("rounded"), std::string::npos) << ball.errors;
  voxel::Scene wide = tests::ball_scene(12.0, 32);
  voxel::FloatSamples samples;
  for (const std::int16_t sample : std::get<voxel::Int16Samples>(wide.samples))
    samples.push_back(1000.25f * static_cast<float>(sample));
  wide.samples = std::move(samples);
  voxel::write_scene(wide, folder_ / "wide.nrrd");
  const tests::CommandAnswer rounded = run("convert " + at("wide.nrrd") + " --dicom -o " + at("wide_dicom"));
  EXPECT_NE(rounded.errors.find("values are rounded by up to"), std::string::npos) << rounded.errors;
}

TEST_F(ScanVerbs, VoxelsThatPassOverAThinObjectSayHowMuchTheyMiss) {
  voxel::Scene thin = tests::ball_scene(12.0, 32);
  thin.lattice = voxel::axis_aligned_lattice({32, 32, 32}, {0.001, 10, 10}, {0, 0, 0});
  voxel::write_scene(thin, folder_ / "thin.nrrd");
  const SortedJson found = json("measure " + at("thin.nrrd") + " --window 0:");
  EXPECT_GT(found["volume_isosurface_mm3"], 500.0);
  EXPECT_EQ(found["volume_half_width_mm3"].get<double>(),
            std::abs(found["volume_isosurface_mm3"].get<double>() - found["volume_mm3"].get<double>()));
  EXPECT_EQ(found["volume_half_width_terms"].back()["name"], "isosurface");
  EXPECT_NE(run("measure " + at("thin.nrrd") + " --window 0:").out.find("choose smaller voxels"),
            std::string::npos);
  // Samples that voxels meet well have one finding: the sum of the samples sees more than a threshold.
  const SortedJson ball = json("measure " + at("ball.nrrd") + " --window 0:");
  ASSERT_EQ(ball["findings"].size(), 1U) << ball["findings"];
  EXPECT_NE(ball["findings"][0].get<std::string>().find("outside of both kernels' answers"),
            std::string::npos)
      << ball["findings"];
  EXPECT_NEAR(ball["volume"]["value"].get<double>(), tests::ball_mm3(12.0),
              ball["volume"]["half_width"].get<double>());
}

// Two balls of 900 and a cube of 300 in air, on voxels of 1 x 1 x 2 mm.
class Segments : public ScanVerbs {
 protected:
  Segments() {
    const auto value = [](const glm::ivec3& /*at*/, const glm::dvec3& p) {
      const bool ball =
          glm::distance(p, glm::dvec3(-12, 0, 0)) < 9 || glm::distance(p, glm::dvec3(10, 0, 0)) < 6;
      const bool cube = p.y > 10 && p.y < 18 && std::abs(p.x) < 10 && std::abs(p.z) < 8;
      return ball ? 900 : cube ? 300 : -1000;
    };
    voxel::write_scene(tests::ct_scene({48, 40, 20}, {1, 1, 2}, {-23.5, -19.5, -19}, value),
                       folder_ / "scan.nrrd");
  }
  std::string segment(const std::string& out) const {
    return "segment " + at("scan.nrrd") + " -o " + at(out) + " ";
  }
  static double ball(double radius) { return 4.0 / 3.0 * M_PI * radius * radius * radius; }
};

TEST_F(Segments, ChoosePartsByWindowSizeSeedAndRegion) {
  const auto volume = [](const SortedJson& said) { return said["objects"][0]["volume_mm3"].get<double>(); };
  EXPECT_NEAR(volume(json(segment("a.nrrd") + "--window cortical_bone")), ball(9) + ball(6), 160);
  EXPECT_NEAR(volume(json(segment("a.nrrd") + "--window cortical_bone --largest")), ball(9), 120);
  const SortedJson both = json(segment("a.nrrd") + "--window 600: --components 2");
  EXPECT_NEAR(volume(both), ball(9) + ball(6), 160);
  EXPECT_NEAR(volume(json(segment("a.nrrd") + "--window 600: --seed 10,0,0")), ball(6), 60);
  EXPECT_NEAR(volume(json(segment("a.nrrd") + "--window 600: --at-least 2000")), ball(9), 120);
  // Grown from a seed through samples like its own, from the cube's: 20 x 8 x 16 mm, half a voxel unsure.
  EXPECT_NEAR(volume(json(segment("a.nrrd") + "--seed 0,14,0 --tolerance 20")), 20 * 8 * 14, 350);
  write("left.json", R"({"view": "inferior", "slices": [
      {"position_mm": -19, "polygons_mm": [[[0,-19],[23,-19],[23,19],[0,19]]]},
      {"position_mm": 19, "polygons_mm": [[[0,-19],[23,-19],[23,19],[0,19]]]}]})");
  EXPECT_NEAR(volume(json(segment("a.nrrd") + "--window 600: --regions " + at("left.json"))), ball(6), 60);
  // On the octree's voxels of 1 mm, half-way between a ball and air lies in it; what was done is kept in the
  // file.
  const SortedJson octree = json(segment("a.octree") + "--window=-50: --seed 10,0,0");
  EXPECT_NEAR(volume(octree), ball(6), 150);
  const SortedJson told = json("info " + at("a.octree"));
  EXPECT_EQ(told["kind"], "octree");
  EXPECT_EQ(told["metadata"]["steps"].size(), 2u);
}

TEST_F(Segments, OtsuFindsTheThreeClassesAndMakesTheBrightest) {
  const SortedJson only = json("segment " + at("scan.nrrd") + " --otsu 3");
  const std::vector<double> thresholds = only["suggestion"]["thresholds"];
  ASSERT_EQ(thresholds.size(), 2u);
  EXPECT_GT(thresholds[0], -1000);
  EXPECT_LE(thresholds[0], 300);
  EXPECT_GT(thresholds[1], 300);
  EXPECT_LE(thresholds[1], 900);
  EXPECT_EQ(only["suggestion"]["histogram"]["counts"].size(), 256u);
  const SortedJson bright = json(segment("a.nrrd") + "--otsu 3");
  const SortedJson middle = json(segment("b.nrrd") + "--otsu 3 --class 2");
  EXPECT_EQ(bright["labels"][0]["samples"],
            json(segment("c.nrrd") + "--window 900:")["labels"][0]["samples"]);
  EXPECT_EQ(middle["labels"][0]["samples"], 20 * 8 * 8);
}

TEST_F(Segments, LabelMapsHoldSeveralObjectsAndGiveThemBack) {
  for (const char* name : {"map.nrrd", "map.nii.gz", "map.mha"}) {
    const SortedJson map = json(segment(name) + "--window 600: --window 200:600");
    ASSERT_EQ(map["labels"].size(), 2u) << name;
    EXPECT_EQ(map["overlaps"], 0);
    EXPECT_EQ(map["labels"][1]["samples"], 20 * 8 * 8);
    const SortedJson back = json("segment " + at(name) + " --label 2 -o " + at("back.nrrd"));
    EXPECT_EQ(back["labels"][0]["samples"], 20 * 8 * 8) << name;
  }
  // Octrees become a label map on the scan's lattice, and overlap is reported.
  ASSERT_EQ(run(segment("a.octree") + "--window 600:").status, 0);
  ASSERT_EQ(run(segment("b.octree") + "--window 200:").status, 0);
  const SortedJson again =
      json(segment("again.nrrd") + "--object " + at("a.octree") + " --object " + at("b.octree"));
  EXPECT_EQ(again["overlaps"], again["labels"][0]["samples"]);
  EXPECT_EQ(again["labels"][1]["samples"], 20 * 8 * 8);
  ASSERT_EQ(again["findings"].size(), 2u);
  EXPECT_NE(again["findings"][1].dump().find("again.tsv"), std::string::npos) << again["findings"];
  EXPECT_EQ(tests::bytes_of(folder_ / "again.tsv"), "index\tname\n1\ta\n2\tb\n");
  // Made again from other objects, the map has their names; it is refused if somebody else wrote the table.
  EXPECT_EQ(run(segment("again.nrrd") + "--object " + at("b.octree")).status, 0);
  EXPECT_EQ(tests::bytes_of(folder_ / "again.tsv"), "index\tname\n1\tb\n");
  EXPECT_EQ(json("segment " + at("again.nrrd") + " --named b -o " + at("back.nrrd"))["labels"][0]["samples"],
            again["labels"][0]["samples"].get<int>() + 20 * 8 * 8);
  write("again.tsv", "name\tindex\nmine\t1\n");
  expect_refused(run(segment("again.nrrd") + "--object " + at("a.octree")), "again.tsv");
}

TEST_F(Segments, AnOctreeAndALabelMapAreOneSetOnSlicesOfAnyDistance) {
  const auto voxels_of = [&](const std::string& how) {
    EXPECT_EQ(run("segment " + at("thick.nrrd") + " -o " + at("set.octree") + how).status, 0);
    const SortedJson octree = json("segment " + at("thick.nrrd") + " -o " + at("set.octree") + how);
    const SortedJson map = json("segment " + at("thick.nrrd") + " -o " + at("set.nrrd") + how);
    const SortedJson &one = octree["objects"][0], &other = map["objects"][0];
    EXPECT_EQ(other["octree"]["volume_mm3"], one["volume_mm3"]) << how;
    EXPECT_EQ(other["steps"], one["steps"]) << how;
    EXPECT_EQ(other["voxels"], map["labels"][0]["samples"]) << how;
    EXPECT_EQ(json("segment " + at("thick.nrrd") + " -o " + at("again.nrrd") + " --object " +
                   at("set.octree"))["overlaps"],
              0);
    return std::pair(std::get<voxel::Int16Samples>(voxel::read_scene(folder_ / "set.nrrd").samples),
                     std::get<voxel::Int16Samples>(voxel::read_scene(folder_ / "again.nrrd").samples));
  };
  // Three balls whose rims take several millimetres, as a scanner's do.
  for (const double slice_mm : {3.0, 2.7}) {
    voxel::Scene scene;
    scene.lattice = voxel::axis_aligned_lattice({48, 40, 14}, {1, 1, slice_mm}, {-23.5, -19.5, -20});
    scene.meaning = voxel::Meaning::Hounsfield;
    scene.modality = "CT";
    voxel::Int16Samples samples;
    std::uint64_t in_window = 0;
    for (int z = 0; z < 14; ++z)
      for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 48; ++x) {
          const glm::dvec3 p = scene.lattice.lps_mm({x, y, z});
          const double out = std::min(glm::distance(p, glm::dvec3(-12, 0, 0)) - 9,
                                      std::min(glm::distance(p, glm::dvec3(10, 2, 0)) - 7,
                                               glm::distance(p, glm::dvec3(0, -14, 12)) - 4));
          samples.push_back(static_cast<std::int16_t>(std::lround(300 - 200 * std::clamp(out, -5.0, 5.0))));
          in_window += samples.back() >= 300 ? 1 : 0;
        }
    const voxel::Int16Samples values = samples;
    scene.samples = std::move(samples);
    voxel::write_scene(scene, folder_ / "thick.nrrd");
    const auto [all, of_octree] = voxels_of(" --window 300:");
    for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i] != 0, values[i] >= 300) << i;
    EXPECT_GT(in_window, 500U);
    for (const char* how : {" --window 300: --largest", " --window 300: --largest --fill",
                            " --window 300: --open 2", " --seed -12,0,0 --tolerance 600"}) {
      const auto [map, sampled] = voxels_of(how);
      std::size_t differ = 0;
      for (std::size_t i = 0; i < map.size(); ++i) differ += map[i] != sampled[i] ? 1 : 0;
      // Slices that are whole voxels apart lie on voxels' centres; others up to half a voxel beside them.
      EXPECT_LE(differ, slice_mm == 3.0 ? 0U : in_window / 20) << how << ", slices of " << slice_mm;
      EXPECT_NE(map, all) << how;
    }
  }
}

TEST_F(Segments, SeveralBecomeADicomSegmentationAndComeBackUnshiftedUnderTheirNames) {
  const SortedJson map = json(segment("map.nrrd") + "--window 600: --window 200:600");
  const SortedJson seg = json(segment("seg.dcm") + "--window 600: --window 200:600");
  EXPECT_EQ(seg["labels"], map["labels"]);
  write("map.json", R"({"Balls": 1, "Cube": 2})");
  EXPECT_EQ(run("convert " + at("map.nrrd") + " -o " + at("named.dcm")).status, 0);
  const auto index_of = [](const glm::ivec3& dims, const glm::ivec3& at) {
    return static_cast<std::size_t>(at.x + dims.x * (at.y + dims.y * at.z));
  };
  for (const char* name : {"seg.dcm", "named.dcm"}) {
    const voxel::Scene was = voxel::read_scene(folder_ / "map.nrrd"), is = voxel::read_scene(folder_ / name);
    const auto& before = std::get<voxel::Int16Samples>(was.samples);
    const auto& after = std::get<voxel::Int16Samples>(is.samples);
    std::size_t labelled = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      if (after[i] == 0) continue;
      ++labelled;
      const auto dims = is.lattice.dims;
      const int n = static_cast<int>(i);
      const glm::ivec3 at{n % dims.x, n / dims.x % dims.y, n / dims.x / dims.y};
      const glm::dvec3 p = was.lattice.voxel(is.lattice.lps_mm(at)), nearest = glm::round(p);
      ASSERT_LT(glm::distance(p, nearest), 1e-6);
      ASSERT_EQ(before[index_of(was.lattice.dims, glm::ivec3(nearest))], after[i]);
    }
    EXPECT_EQ(labelled, std::count_if(before.begin(), before.end(), [](auto each) { return each != 0; }));
  }
  const SortedJson cube = json("segment " + at("named.dcm") + " --named Cube -o " + at("back.nrrd"));
  EXPECT_EQ(cube["labels"][0]["samples"], 20 * 8 * 8);
  expect_refused(run("convert " + at("scan.nrrd") + " -o " + at("x.dcm")), "label");
}

TEST_F(Segments, NamesOfLabelsStayBesideALabelMapThatIsConverted) {
  EXPECT_EQ(run(segment("map.nrrd") + "--window 600: --window 200:600").status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "map.tsv")) << "a window's two numbers are no name";
  write("map.json", R"({"Balls": 1, "Cube": 2})");
  EXPECT_EQ(run("convert " + at("map.nrrd") + " -o " + at("named.dcm")).status, 0);
  // prepare keeps them, too.
  EXPECT_EQ(run("prepare " + at("map.nrrd") + " -o " + at("less.nrrd") + " --step crop=-20,-15,-15,20,19,15")
                .status,
            0);
  EXPECT_EQ(tests::bytes_of(folder_ / "less.tsv"), "index\tname\n1\tBalls\n2\tCube\n");
  for (const char* name : {"out.nrrd", "other.nii.gz", "third.mha"}) {
    SCOPED_TRACE(name);
    const SortedJson made = json("convert " + at("named.dcm") + " -o " + at(name));
    const std::string stem = std::string(name).substr(0, std::string(name).find('.'));
    EXPECT_NE(made["findings"].dump().find(stem + ".tsv"), std::string::npos) << made["findings"];
    EXPECT_EQ(json("segment " + at(name) + " --named Cube -o " + at("back.nrrd"))["labels"][0]["samples"],
              20 * 8 * 8);
  }
  EXPECT_EQ(tests::bytes_of(folder_ / "out.tsv"), "index\tname\n1\tBalls\n2\tCube\n");
  // Once more: the table is there. Another table there is not replaced, and nothing is written.
  EXPECT_EQ(run("convert " + at("named.dcm") + " -o " + at("out.nrrd")).status, 0);
  write("mine.tsv", "index\tname\n1\tCube\n2\tBalls\n");
  expect_refused(run("convert " + at("named.dcm") + " -o " + at("mine.nrrd")), "mine.tsv");
  EXPECT_EQ(tests::bytes_of(folder_ / "mine.tsv"), "index\tname\n1\tCube\n2\tBalls\n");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "mine.nrrd"));
  // A map with its own table of names needs no other one, and one without names makes none.
  EXPECT_EQ(json("convert " + at("map.nrrd") + " -o " + at("map.mha"))["findings"], SortedJson::array());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "map.tsv"));
  EXPECT_EQ(run("convert " + at("scan.nrrd") + " -o " + at("plain.mha")).status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "plain.tsv"));
}

TEST_F(Segments, ContoursComeBackAsTheMaskTheyBound) {
  const SortedJson followed =
      json("segment " + at("scan.nrrd") + " --window=-50: --contours " + at("regions.json"));
  EXPECT_GT(followed["contours"]["contours"].get<int>(), 10);
  const SortedJson mask =
      json("mask --slices " + at("regions.json") + " --voxel 0.5 -o " + at("mask.octree"));
  const double mm3 = mask["voxels"].get<double>() * 0.125;
  // The cube's contour at -50 lies 0.27 mm from its outer samples instead of half-way.
  EXPECT_NEAR(mm3 / (ball(9) + ball(6) + 19.5 * 7.5 * 16), 1.0, 0.04);
}

TEST_F(Segments, WhatCannotBeMeantIsRefused) {
  expect_refused(run(segment("x.octree")), "--window bone");
  expect_refused(run(segment("x.octree") + "--window bone --otsu 2"), "one of");
  expect_refused(run(segment("x.octree") + "--window bone --window fat"), "label map");
  expect_refused(run(segment("x.octree") + "--tolerance 3"), "--seed");
  expect_refused(run(segment("x.octree") + "--window bone --running-mean"), "tolerance");
  expect_refused(run(segment("x.octree") + "--clusters 9"), "8");
  expect_refused(run(segment("x.octree") + "--clusters 3 --class 4"), "class");
  expect_refused(run(segment("x.octree") + "--clusters 3 --otsu 3"), "--clusters");
  expect_refused(run(segment("x.octree") + "--window bone --seed 99,0,0"), "outside");
  expect_refused(run(segment("x.octree") + "--window 5000:"), "no voxel");
  expect_refused(run(segment("x.octree") + "--otsu 3 --class 4"), "--class");
  expect_refused(run("segment " + at("scan.nrrd") + " --label 1 -o " + at("x.octree")), "label");
  expect_refused(run("segment " + at("scan.nrrd") + " --window bone"), "--contours");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.octree"));
}

TEST_F(Segments, PreparationGoesStepByStepInTheOrderGivenAndSaysWhatEachDid) {
  const SortedJson said = json("prepare " + at("scan.nrrd") + " -o " + at("ready.nrrd") +
                               " --step crop=-20,-15,-13,20,19,13 --step slices=1,cubic --step median=1"
                               " --step gaussian=0.8 --step edge_preserving=2,1 --step average_down=2,2,1");
  ASSERT_EQ(said["steps"].size(), 6u);
  EXPECT_EQ(said["steps"][0]["dims"], SortedJson({40, 34, 14}));
  EXPECT_EQ(said["steps"][0]["first_sample"], SortedJson({4, 5, 3}));
  EXPECT_EQ(said["steps"][1]["dims"], SortedJson({40, 34, 27}));
  EXPECT_EQ(said["steps"][1]["kernel"], "cubic");
  EXPECT_EQ(said["dims"], SortedJson({20, 17, 27}));
  EXPECT_EQ(said["spacing_mm"], SortedJson({2.0, 2.0, 1.0}));
  const SortedJson read = json("info " + at("ready.nrrd"));
  EXPECT_EQ(read["dims"], said["dims"]);
  EXPECT_EQ(read["lps_from_voxel"], said["lps_from_voxel"]);
  // The larger ball is where it was, within what smoothing takes off.
  const SortedJson kept =
      json("segment " + at("ready.nrrd") + " -o " + at("a.octree") + " --window=-50: --seed=-12,0,0");
  EXPECT_NEAR(kept["objects"][0]["volume_mm3"].get<double>() / ball(9), 1.0, 0.12);
  // The order counts: averaged first, the crop's box holds other samples.
  const SortedJson other = json("prepare " + at("scan.nrrd") + " -o " + at("b.nrrd") +
                                " --step average_down=2,2,1 --step crop=-20,-15,-13,20,19,13");
  EXPECT_NE(other["lps_from_voxel"], said["lps_from_voxel"]);
}

TEST_F(Segments, AHeadrestIsRemovedKeptAndPutBack) {
  const std::string clean = "prepare " + at("scan.nrrd") + " -o " + at("clean.nrrd");
  const SortedJson said = json(clean + " --step remove_headrest=-300,5 --removed " + at("removed.octree"));
  // The cube behind; the ball beside lies in front of the coronal middle by half and stays.
  EXPECT_EQ(said["steps"][0]["parts_removed"], 1);
  EXPECT_NEAR(said["steps"][0]["volume_removed_mm3"].get<double>(), 20 * 8 * 16, 80);
  const SortedJson back = json("prepare " + at("clean.nrrd") + " -o " + at("back.nrrd") +
                               " --step restore=" + at("removed.octree"));
  EXPECT_EQ(back["steps"][0]["samples_restored"], said["steps"][0]["samples_removed"]);
  const auto bytes = [&](const char* name) { return tests::bytes_of(folder_ / name); };
  EXPECT_EQ(bytes("back.nrrd"), bytes("scan.nrrd"));
  EXPECT_NE(bytes("clean.nrrd"), bytes("scan.nrrd"));
  expect_refused(run(clean + " --step remove_headrest"), "--removed");
}

TEST_F(Segments, EdgesAndShapesAreScenesToo) {
  const SortedJson shape =
      json("prepare " + at("scan.nrrd") + " -o " + at("shape.nrrd") + " --step shape=0.5,bone");
  EXPECT_EQ(shape["range"], SortedJson({0.0, 1.0}));
  EXPECT_EQ(shape["dims"][2], 77);
  const SortedJson edges =
      json("prepare " + at("scan.nrrd") + " -o " + at("edges.nrrd") + " --step zucker_hummel");
  EXPECT_GT(edges["range"][1], 500);
  const SortedJson marr =
      json("prepare " + at("scan.nrrd") + " -o " + at("marr.nrrd") + " --step marr_hildreth=1.5");
  EXPECT_LT(marr["range"][0], -10);
  EXPECT_EQ(marr["unit"], "1");
}

TEST_F(Segments, StepsThatCannotBeAreRefusedBeforeAnythingIsWritten) {
  const std::string prepare = "prepare " + at("scan.nrrd") + " -o " + at("x.nrrd") + " --step ";
  expect_refused(run(prepare + "crob=1"), "did you mean 'crop'");
  expect_refused(run(prepare + "crop=1,2,3"), "X0,Y0,Z0");
  expect_refused(run(prepare + "crop=90,90,90,99,99,99"), "no sample");
  expect_refused(run(prepare + "slices=1,spline"), "lanczos");
  expect_refused(run(prepare + "median=1.5"), "samples");
  expect_refused(run(prepare + "gaussian=-1"), "sigma");
  expect_refused(run(prepare + "difference_of_gaussians=2,1"), "ratio");
  expect_refused(run(prepare + "difference_of_gaussians=0"), "sigma");
  expect_refused(run(prepare + "roberts=1"), "give roberts");
  expect_refused(run(prepare + "prewitt=1"), "give prewitt");
  expect_refused(run(prepare + "n4_bias_field"), "magnetic");
  expect_refused(run(prepare + "n4_bias_field=-1"), "threshold");
  expect_refused(run(prepare + "n4_bias_field=10,0"), "knots");
  expect_refused(run(prepare + "n4_bias_field=10,200,9"), "levels");
  expect_refused(run(prepare + "n4_bias_field=10,200,4,0"), "iterations");
  expect_refused(run(prepare + "scale_space=2"), "window");
  expect_refused(run(prepare + "scale_space=0,bone"), "sigma");
  expect_refused(run(prepare + "scale_space=2,bone,grey"), "bright");
  expect_refused(run(prepare + "scale_space=2,9000:"), "no sample");
  expect_refused(run(prepare + "restore=" + at("scan.nrrd")), "scan.nrrd");
  expect_refused(run("prepare " + at("scan.nrrd") + " -o " + at("x.stl") + " --step median=1"), ".nrrd");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.nrrd"));
}

}  // namespace
}  // namespace octotomy::planner
