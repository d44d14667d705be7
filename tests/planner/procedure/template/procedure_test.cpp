// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/template/procedure.h"

#include <gtest/gtest.h>

#include "planner/operation/measure/near_surfaces.h"
#include "planner/operation/table/json.h"
#include "planner/plan/evaluate.h"
#include "tests/planner/ball_scan.h"
#include "tests/planner/procedure/template/on_the_head.h"
#include "verify/phantom/head_phantom.h"
#include "voxel/filter/components.h"

namespace octotomy::planner {
namespace {

using tests::has, tests::head_input, tests::head_landmarks, tests::way_mm;

std::string refusal(const std::string& name, const ProcedureInput& input) {
  try {
    plan_of(read_procedure(name), input);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Procedure, EachOfTheProgramMakesAPlanThatReadsAndTakesFewValues) {
  ASSERT_GE(procedures().size(), 3u);
  for (const std::string& name : procedures()) {
    const Procedure procedure = read_procedure(name);
    EXPECT_EQ(procedure.name, name);
    EXPECT_LE(procedure.values.size(), most_values) << name;
    ProcedureInput input = head_input();
    for (const ProcedureScan& scan : procedure.scans) input.further_scans[scan.name] = {{"path", "leg.nrrd"}};
    const Json plan = plan_of(procedure, input);
    const Plan read = parse_plan(plan.dump(), ".");
    EXPECT_EQ(plan.dump().find("\"="), std::string::npos) << name << " keeps a formula";
    EXPECT_EQ(read.landmarks.size(), head_landmarks().size());
    const Json whole = plan_of(with_all_options(procedure), input);
    EXPECT_EQ(whole.dump().find("\"="), std::string::npos) << name << " keeps a formula";
    std::size_t more = 0;
    for (const ProcedureOption& option : procedure.options) {
      EXPECT_LE(option.values.size(), most_values) << name;
      more += option.steps.size();
    }
    EXPECT_EQ(whole.at("steps").size(), plan.at("steps").size() + more) << name;
  }
}

TEST(Procedure, AnOptionAddsItsValuesAndStepsAndIsKnownByItsName) {
  const Procedure flap = read_procedure("fibula_flap");
  ProcedureInput input = head_input();
  input.further_scans["donor"] = {{"path", "leg.nrrd"}};
  input.values = {{"plate_width_mm", 8}};
  EXPECT_THROW(plan_of(flap, input), std::runtime_error);
  const Json plan = plan_of(with_options(flap, {"guides"}), input);
  for (const Json& step : plan.at("steps"))
    if (step.at("id") == "plate") {
      EXPECT_EQ(step.at("width_mm"), 8.0);
      EXPECT_EQ(step.at("screws").size(), 10u);
    }
  const auto refused = [](const auto& act) {
    try {
      act();
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused([&] { with_options(flap, {"guide"}); }).find("did you mean 'guides'?"),
            std::string::npos);
  EXPECT_NE(refused([&] { with_options(read_procedure("le_fort_ii"), {"guides"}); }).find("it has none"),
            std::string::npos);
  const auto parsed = [&](const std::string& value, const std::string& step) {
    return refused([&] {
      parse_procedure(R"({"procedure": "mine", "says": "Mine.", "landmarks": [], "values": [{"name": "a_mm",
          "says": "A.", "preset": 1, "least": 0, "most": 2}], "steps": [{"id": "one"}], "options": [{"name": "o",
          "says": "O.", "values": [{"name": ")" +
                      value + R"(", "says": "B.", "preset": 1, "least": 0, "most": 2}], "steps": [{"id": ")" +
                      step + R"("}]}]})");
    });
  };
  EXPECT_EQ(parsed("b_mm", "two"), "");
  EXPECT_NE(parsed("a_mm", "two").find("value 'a_mm' is defined twice"), std::string::npos);
  EXPECT_NE(parsed("b_mm", "one").find("step 'one' is defined twice"), std::string::npos);
}

TEST(Procedure, APlaceAlongTheHeadsDirectionsBecomesAPointOfTheScan) {
  const auto steps = [](const std::string& place) {
    const Procedure mine = parse_procedure(R"({"procedure": "mine", "says": "Mine.",
        "landmarks": [{"name": "a", "says": "A."}], "values": [], "steps": [{"id": "one", "at": {"head_mm": )" +
                                           place + "}}]}");
    // The head's left is the scan's back, the head's back the scan's right.
    const glm::dmat3 lps_from_head(glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1));
    return steps_of(mine, {{"a", {10, 20, 30}}}, {}, lps_from_head);
  };
  // The landmark's coordinates along the head are 20, -10, 30.
  EXPECT_EQ(steps(R"(["=a.x + 1", "=a.y + 2", "=a.z + 3"])")[0].at("at"), (Json{8.0, 21.0, 33.0}));
  EXPECT_THROW(steps(R"(["=a.x", "=a.y"])"), std::runtime_error);
  EXPECT_THROW(steps(R"(["=a.x", "=a.y", "z"])"), std::runtime_error);
}

TEST(Procedure, PartsOfALeFortISitWhereItsLandmarksAre) {
  ProcedureInput input = head_input();
  const Json plan = plan_of(with_all_options(read_procedure("le_fort_i")), input);
  const auto step = [&](const std::string& id) {
    for (const Json& each : plan["steps"])
      if (each["id"] == id) return each;
    return Json();
  };
  // Of the way from the piriform rim to the buttress a fraction, and 6 mm below the cut.
  EXPECT_EQ(step("screw_left_low_1").at("at"), (Json{14.7, -81.6, -31.45}));
  EXPECT_EQ(step("plate_left").at("screws"), (Json{"screw_left_low_2_moved", "screw_left_low_1_moved",
                                                   "screw_left_high_1", "screw_left_high_2"}));
  EXPECT_EQ(step("intermediate_splint").at("upper_direction"), (Json{0.0, 0.0, 33.0}));
  for (const char* part : {"intermediate_splint", "guide_left", "guide_right", "plate_left", "plate_right"}) {
    EXPECT_EQ(step(part + std::string("_prints")).at("object"), part);
    const bool is_splint = part == std::string("intermediate_splint");
    for (const char* side :
         is_splint ? std::vector<const char*>{"_upper", "_lower"} : std::vector<const char*>{""}) {
      const Json goes_on = step(part + std::string("_goes_on") + side),
                 holds = step(part + std::string("_holds") + side);
      EXPECT_EQ(holds.at("do"), "rocking") << part;
      for (const char* key : {"object", "against"}) EXPECT_EQ(holds.at(key), goes_on.at(key)) << part << key;
    }
    EXPECT_EQ(step(part + std::string("_file")).at("path"), part + std::string(".stl"));
  }
}

TEST(Procedure, TypedValuesAndLandmarksBecomeThePlansNumbers) {
  ProcedureInput input = head_input();
  input.values = {{"forward_mm", 6}, {"up_mm", 2.5}, {"kerf_mm", 0.8}};
  const Json plan = plan_of(read_procedure("le_fort_i"), input);
  const auto step = [&](const char* id) {
    for (const Json& each : plan["steps"])
      if (each["id"] == id) return each;
    return Json();
  };
  EXPECT_EQ(step("maxilla_moved")["by"], (Json{{"forward_mm", 6.0}, {"left_mm", 0.0}, {"up_mm", 2.5}}));
  const Json cut = step("below_cut")["regions"][1]["polygons_mm"][0],
             kerf = step("below_cut_and_kerf")["regions"][1]["polygons_mm"][0];
  EXPECT_EQ(cut[6], (Json{-84.0, -25.0}));
  EXPECT_EQ(kerf[6], (Json{-84.0, -24.2}));
}

TEST(Procedure, OnTheHeadPhantomEachTakesItsOwnPieceAndLeavesTheOthers) {
  const tests::ScratchFolder folder;
  verify::HeadOptions coarse;
  coarse.voxel_mm = 2.0;
  voxel::write_scene(verify::head_phantom(coarse), folder / "head.nrrd");
  ProcedureInput input = head_input();
  input.folder = folder.path();
  input.voxel_mm = 2.0;
  input.values = {{"forward_mm", 6}, {"kerf_mm", 2}};
  EvaluateOptions quick;
  quick.meshes = false;
  struct Case {
    const char *name, *piece;
    double least_cm3, most_cm3;
    std::vector<std::string> taken, left;
  };
  for (const Case& each :
       {Case{"le_fort_i",
             "maxilla",
             30,
             80,
             {"incisor", "molar_left", "molar_right"},
             {"menton", "foramen_left"}},
        Case{"genioplasty", "chin", 5, 20, {"menton", "pogonion"}, {"incisor", "lower_incisor"}},
        Case{"bilateral_sagittal_split",
             "distal",
             30,
             70,
             {"lower_incisor", "menton", "foramen_left", "foramen_right"},
             {"piriform_left", "buttress_left"}},
        Case{"inverted_l",
             "distal",
             30,
             75,
             {"lower_incisor", "menton", "split_front_left"},
             {"condyle_left", "coronoid_left", "incisor"}},
        Case{"vertical_ramus",
             "distal",
             30,
             80,
             {"lower_incisor", "menton", "coronoid_left"},
             {"condyle_left", "buttress_left", "incisor"}},
        Case{"le_fort_ii",
             "midface",
             45,
             110,
             {"incisor", "molar_left", "piriform_left", "piriform_right"},
             {"menton", "lower_incisor"}},
        Case{"le_fort_iii",
             "midface",
             60,
             140,
             {"incisor", "molar_left", "piriform_left", "cheek_left", "cheek_right", "orbital_rim_left"},
             {"menton", "lower_incisor", "coronoid_left", "coronoid_front_left", "brow", "condyle_left"}},
        Case{"kufner",
             "midface",
             50,
             120,
             {"incisor", "molar_left", "cheek_left", "cheek_right"},
             {"menton", "lower_incisor", "coronoid_left", "coronoid_front_left", "frontonasal", "brow"}},
        Case{"zygoma_left",
             "zygoma",
             6,
             25,
             {"cheek_left"},
             {"cheek_right", "incisor", "molar_left", "coronoid_left", "brow", "piriform_left"}}}) {
    const Json plan = plan_of(read_procedure(each.name), input);
    const Evaluation evaluation = evaluate(parse_plan(plan.dump(), folder.path()), quick);
    const double cm3 = evaluation.object(each.piece).voxel.measures.volume_mm3 / 1000.0;
    EXPECT_GT(cm3, each.least_cm3) << each.name;
    EXPECT_LT(cm3, each.most_cm3) << each.name;
    for (const std::string& mark : each.taken) EXPECT_TRUE(has(evaluation, each.piece, mark)) << mark;
    for (const std::string& mark : each.left) EXPECT_FALSE(has(evaluation, each.piece, mark)) << mark;
    // The kerf is gone from both.
    const double both_cm3 = cm3 + evaluation.object("rest").voxel.measures.volume_mm3 / 1000.0;
    EXPECT_LT(both_cm3, evaluation.object("skull").voxel.measures.volume_mm3 / 1000.0 - 0.3) << each.name;
    const std::string moved = std::string(each.piece) + "_moved";
    EXPECT_NEAR(evaluation.object(moved).voxel.measures.centroid_mm->y,
                evaluation.object(each.piece).voxel.measures.centroid_mm->y - 6.0, 0.3);
  }
}

TEST(Procedure, TheThesissThreeOperationsComeOutOfAFewTypedValues) {
  const tests::ScratchFolder folder;
  verify::HeadOptions coarse;
  coarse.voxel_mm = 2.0;
  voxel::write_scene(verify::head_phantom(coarse), folder / "head.nrrd");
  ProcedureInput input = head_input();
  input.folder = folder.path();
  input.voxel_mm = 2.0;
  EvaluateOptions quick;
  quick.meshes = false;
  const auto planned = [&](const char* name, const std::map<std::string, double>& values) {
    input.values = values;
    return evaluate(parse_plan(plan_of(read_procedure(name), input).dump(), folder.path()), quick);
  };
  const auto expect_way = [](const glm::dvec3& way_mm, double forward_mm, double left_mm, double up_mm) {
    EXPECT_LT(glm::distance(way_mm, {left_mm, -forward_mm, up_mm}), 1e-3);
  };

  // Case 1, 8.4.2.
  const Evaluation kufner = planned("kufner", {{"forward_mm", 2}, {"up_mm", -1}});
  expect_way(way_mm(kufner, "midface_moved", "incisor"), 2, 0, -1);

  // Case 2, 8.4.3: the condyles come down by 41.1 mm, the front up by 2 mm and, after the way back, forward
  // by 1 mm.
  const Evaluation mandible =
      planned("mandible", {{"forward_mm", 1}, {"front_up_mm", 2}, {"back_up_mm", -41.1}});
  expect_way(way_mm(mandible, "mandible_moved", "lower_incisor"), 1, 0, 2);
  for (const char* condyle : {"condyle_left", "condyle_right"})
    EXPECT_NEAR(way_mm(mandible, "mandible_moved", condyle).z, -41.1, 1e-3);
  for (const char* taken : {"menton", "lower_incisor", "coronoid_left", "coronoid_right", "split_back_left"})
    EXPECT_TRUE(has(mandible, "mandible", taken)) << taken;
  for (const char* left : {"incisor", "molar_left", "zygoma_left", "brow"})
    EXPECT_FALSE(has(mandible, "mandible", left)) << left;
  // In this head no neck bone lies in the jaw's space, and no part of the jaw counts as neck bone.
  EXPECT_TRUE(mandible.object("neck_bone").voxel.octree.is_empty());
  EXPECT_EQ(mandible.object("mandible").voxel.octree, mandible.object("jaw_space").voxel.octree);
  const auto parts = voxel::components(mandible.object("mandible").voxel.octree).voxel_counts;
  EXPECT_GT(static_cast<double>(parts.front()),
            0.95 * static_cast<double>(mandible.object("mandible").voxel.octree.voxel_count()));

  // Case 3, 8.4.4.
  const Evaluation jaws = planned("two_jaw", {{"upper_left_mm", 2},
                                              {"upper_front_up_mm", 7},
                                              {"upper_back_up_mm", 3},
                                              {"lower_forward_mm", 9},
                                              {"lower_left_mm", 2},
                                              {"lower_front_up_mm", 6},
                                              {"lower_back_up_mm", 2},
                                              {"lower_yaw_deg", 3}});
  expect_way(way_mm(jaws, "maxilla_moved", "incisor"), 0, 2, 7);
  expect_way(way_mm(jaws, "distal_moved", "lower_incisor"), 9, 2, 6);
  for (const char* molar : {"molar_left", "molar_right"})
    EXPECT_NEAR(way_mm(jaws, "maxilla_moved", molar).z, 3.0, 1e-3);
  for (const char* molar : {"lower_molar_left", "lower_molar_right"})
    EXPECT_NEAR(way_mm(jaws, "distal_moved", molar).z, 2.0, 1e-3);
  EXPECT_FALSE(jaws.object("overlap_upper").voxel.octree.is_empty());
  const double pieces_mm3 = jaws.object("maxilla").voxel.measures.volume_mm3 +
                            jaws.object("distal").voxel.measures.volume_mm3 +
                            jaws.object("rest").voxel.measures.volume_mm3;
  EXPECT_LT(pieces_mm3, jaws.object("skull").voxel.measures.volume_mm3 - 300.0);
}

TEST(Procedure, OneTakesLandmarksAndStepsOfAnother) {
  const Procedure both = read_procedure("two_jaw"), upper = read_procedure("le_fort_i");
  const auto step = [](const Procedure& procedure, const char* id) {
    return *std::find_if(procedure.steps.begin(), procedure.steps.end(),
                         [&](const Json& each) { return each.at("id") == id; });
  };
  EXPECT_EQ(step(both, "below_cut"), step(upper, "below_cut"));
  for (const ProcedureLandmark& landmark : upper.landmarks)
    EXPECT_EQ(std::count_if(both.landmarks.begin(), both.landmarks.end(),
                            [&](const ProcedureLandmark& each) { return each.name == landmark.name; }),
              1);
  const auto refused = [](const std::string& landmarks, const std::string& steps) {
    try {
      parse_procedure(R"({"procedure": "mine", "says": "Mine.", "values": [], "landmarks": [)" + landmarks +
                      R"(], "steps": [)" + steps + "]}");
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused(R"({"of": "le_fort_1"})", "{}").find("did you mean 'le_fort_i'?"), std::string::npos);
  EXPECT_NE(refused(R"({"of": "mine"})", "{}").find("another procedure"), std::string::npos);
  EXPECT_NE(
      refused("", R"({"of": "le_fort_i", "steps": ["cut"]})").find("steps[0]: le_fort_i has no step 'cut'"),
      std::string::npos);
}

TEST(Procedure, ZygomasOfBothSidesAreMirrorImages) {
  const auto corners = [](const char* name, double side) {
    std::vector<glm::dvec2> points;
    const Json plan = plan_of(read_procedure(name), head_input());
    for (const Json& step : plan["steps"])
      if (step["id"] == "zygoma_region_and_kerf")
        for (const Json& point : step["regions"][0]["polygons_mm"][0])
          points.emplace_back(side * point[0].get<double>(), point[1].get<double>());
    return points;
  };
  const auto left = corners("zygoma_left", 1.0), right = corners("zygoma_right", -1.0);
  ASSERT_EQ(left.size(), 6u);
  EXPECT_EQ(left, right);
}

TEST(Procedure, AMirroredReconstructionFillsAHoleUpToItsGap) {
  const tests::ScratchFolder folder;
  verify::HeadOptions coarse;
  coarse.voxel_mm = 2.0;
  voxel::Scene head = verify::head_phantom(coarse);
  ProcedureInput input = head_input();
  input.folder = folder.path();
  input.voxel_mm = 2.0;
  input.values = {{"rim_gap_mm", 1}, {"reach_mm", 25}};
  EvaluateOptions quick;
  quick.certify = false;
  const auto made = [&](const char* name) {
    voxel::write_scene(head, folder / name);
    input.scan = {{"path", name}};
    return evaluate(
        parse_plan(plan_of(read_procedure("mirrored_reconstruction_front"), input).dump(), folder.path()),
        quick);
  };
  const EvaluateOptions all = quick;
  quick.wanted = {"bone"};
  const double whole_mm3 = made("whole.nrrd").object("bone").voxel.measures.volume_mm3;
  quick = all;
  auto& samples = std::get<voxel::Int16Samples>(head.samples);
  std::size_t at = 0;
  for (int z = 0; z < head.lattice.dims.z; ++z)
    for (int y = 0; y < head.lattice.dims.y; ++y)
      for (int x = 0; x < head.lattice.dims.x; ++x, ++at) {
        const glm::dvec3 p(head.lattice.lps_from_voxel * glm::dvec4(x, y, z, 1.0));
        if (p.y < -30.0 && std::hypot(p.x - 30.0, p.z - 48.0) < 11.0) samples[at] = -1000;
      }
  const Evaluation holed = made("holed.nrrd");
  const double lost_mm3 = whole_mm3 - holed.object("bone").voxel.measures.volume_mm3;
  ASSERT_GT(lost_mm3, 1000.0);
  // The gap is taken off around a hole of some 70 mm by 5 mm of bone.
  EXPECT_NEAR(holed.object("implant").mesh.within->measures().volume_mm3, lost_mm3 - 70.0 * 5.0,
              0.2 * lost_mm3);
  EXPECT_TRUE(holed.object("overlap").voxel.octree.is_empty());
  EXPECT_LT(holed.object("overlap").mesh.within->measures().volume_mm3, 1e-3);
  const double gap_mm =
      least_distance_mm(*holed.object("implant").mesh.within, *holed.object("bone").mesh.within, 1.0);
  EXPECT_GT(gap_mm, 0.5);
  EXPECT_LT(gap_mm, 1.1);
}

TEST(Procedure, AFlapTakesItsDonorsScanAndRefusesToDoWithout) {
  EXPECT_NE(
      refusal("fibula_flap", head_input()).find("lacks a scan: 'donor', the donor's scan: add it by --donor"),
      std::string::npos);
  ProcedureInput input = head_input();
  input.further_scans["donor"] = {{"path", "leg.nrrd"}};
  EXPECT_EQ(refusal("fibula_flap", input), "");
  EXPECT_NE(refusal("le_fort_i", input).find("takes no scan 'donor'"), std::string::npos);
  input.values = {{"start_mm", 150}};
  EXPECT_NE(refusal("fibula_flap", input).find("mm more"), std::string::npos);
}

TEST(Procedure, AHeadThatLiesAskewGetsTheSameRegionsInItsOwnDirections) {
  ProcedureInput level = head_input(), askew = head_input();
  for (ProcedureInput* input : {&level, &askew})
    for (const brep::Landmark& mark : std::vector<brep::Landmark>{{"porion_right", {-60, 10, -8}},
                                                                  {"porion_left", {60, 10, -8}},
                                                                  {"orbitale_left", {32, -70, -8}},
                                                                  {"orbitale_right", {-32, -70, -8}}})
      input->landmarks.push_back(mark);
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (brep::Landmark& mark : askew.landmarks)
    mark.p_mm = {c * mark.p_mm.x - s * mark.p_mm.z, mark.p_mm.y, s * mark.p_mm.x + c * mark.p_mm.z};
  const auto regions = [](const ProcedureInput& input) {
    std::vector<double> numbers;
    const Json plan = plan_of(read_procedure("le_fort_i"), input);
    for (const Json& step : plan["steps"])
      if (step["id"] == "below_cut")
        for (const Json& region : step["regions"])
          for (const Json& point : region["polygons_mm"][0])
            for (const Json& number : point) numbers.push_back(number.get<double>());
    return numbers;
  };
  const std::vector<double> a = regions(level), b = regions(askew);
  ASSERT_EQ(a.size(), 24u);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-3);
}

TEST(Procedure, RefusalsNameLandmarkValueAndStep) {
  ProcedureInput input = head_input();
  std::erase_if(input.landmarks, [](const brep::Landmark& mark) { return mark.name == "incisor"; });
  EXPECT_NE(refusal("le_fort_i", input).find("'incisor', the edge of the upper central incisors"),
            std::string::npos);
  input = head_input();
  input.values = {{"foward_mm", 6}};
  EXPECT_NE(refusal("le_fort_i", input).find("did you mean 'forward_mm'?"), std::string::npos);
  input.values = {{"forward_mm", 600}};
  EXPECT_NE(refusal("le_fort_i", input).find("forward_mm must be from -20"), std::string::npos);
  EXPECT_NE(refusal("le_fort_1", head_input()).find("did you mean 'le_fort_i'?"), std::string::npos);
  try {
    parse_procedure(
        R"({"procedure": "p", "says": "s.", "landmarks": [], "values": [{"name": "a"}], "steps": [{}]})");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("values[0]: has no 'says'"), std::string::npos) << error.what();
  }
}

TEST(Procedure, NestedTooDeepIsRefused) {
  try {
    parse_procedure(std::string(100'000, '[') + std::string(100'000, ']'));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "is nested more than 512 deep");
  }
}

}  // namespace
}  // namespace octotomy::planner
