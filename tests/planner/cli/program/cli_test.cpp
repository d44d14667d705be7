// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The program as scripts see it: exit status, standard output, what is left on disk.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/file_bytes.h"
#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::CommandLine;
using tests::SortedJson;

TEST_F(CommandLine, SaysItsVersionAndHelpsEveryVerbWithAnExample) {
  EXPECT_EQ(run("--version").out, std::string("octotomy ") + OCTOTOMY_VERSION + "\n");
  const std::string help = run("--help").out;
  for (const char* verb :
       {"look",    "run",      "verify",  "info",    "measure", "render", "mesh",    "boolean", "smooth",
        "tet",     "register", "compare", "phantom", "octree",  "eval",   "mark",    "mask",    "slice",
        "segment", "prepare",  "saw",     "repair",  "mirror",  "offset", "contours"}) {
    EXPECT_NE(help.find(verb), std::string::npos) << verb;
    const CommandAnswer answer = run(std::string(verb) + " --help");
    EXPECT_EQ(answer.status, 0) << verb;
    EXPECT_NE(answer.out.find("Example:"), std::string::npos) << verb;
    EXPECT_NE(answer.out.find("--json"), std::string::npos) << verb;
  }
}

TEST_F(CommandLine, HelpListsEveryVerbInExactlyOneGroup) {
  // A line of help that holds a verb: under a heading, two blanks before its name.
  std::istringstream help(run("--help").out);
  std::map<std::string, int> lines;
  int groups = 0;
  bool is_in_group = false;
  for (std::string line; std::getline(help, line);) {
    if (line == "Example:") break;
    EXPECT_NE(line, "Subcommands:") << "a verb has no group: planner/cli/program/verb_groups.cpp";
    if (line.ends_with(':') && line != "Options:") {
      ++groups;
      is_in_group = true;
    } else if (is_in_group && line.starts_with("  ")) {
      ++lines[line.substr(2, line.find(' ', 2) - 2)];
    }
  }
  EXPECT_EQ(groups, 10);
  // The words of the last case of the completion: all verbs, then options.
  const std::string completion = run("--manual bash").out, start = "    *) words='";
  const std::size_t at = completion.find(start);
  ASSERT_NE(at, std::string::npos);
  std::istringstream words(completion.substr(at + start.size()));
  std::size_t verbs = 0;
  for (std::string word; words >> word && !word.starts_with('-'); ++verbs) EXPECT_EQ(lines[word], 1) << word;
  EXPECT_GT(verbs, 40u);
  EXPECT_EQ(lines.size(), verbs);
}

TEST_F(CommandLine, TheManualAndTheCompletionsNameEveryVerbAndItsOptions) {
  const std::string man = run("--manual man").out;
  EXPECT_EQ(man.rfind(".TH OCTOTOMY 1", 0), 0u);
  for (const char* kind : {"man", "bash", "zsh"}) {
    const CommandAnswer answer = run(std::string("--manual ") + kind);
    EXPECT_EQ(answer.status, 0) << answer.errors;
    for (const char* word :
         {"look", "verify", "render", kind[0] == 'm' ? "\\-\\-time\\-limit" : "--time-limit"})
      EXPECT_NE(answer.out.find(word), std::string::npos) << kind << " " << word;
    EXPECT_EQ(answer.out.find("--manual"), std::string::npos) << kind;
  }
  write("completion.bash", run("--manual bash").out);
  const CommandAnswer typed = tests::run_command(
      "bash -c '. " + (folder_ / "completion.bash").string() +
          "; COMP_WORDS=(octotomy measure --wi); COMP_CWORD=2; _octotomy; echo \"${COMPREPLY[@]}\"'",
      folder_ / "");
  EXPECT_EQ(typed.out, "--window\n") << typed.errors;
  expect_refused(run("--manual fish"), "fish");
}

TEST_F(CommandLine, FrameAndUnitOfAVolumeFileAreThoseThatTheUserNames) {
  const SortedJson stated = SortedJson::parse(run("info " + at("ball.nrrd") + " --json").out);
  const CommandAnswer answer = run("info " + at("ball.nrrd") + " --frame RAS --unit cm --json");
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const SortedJson named = SortedJson::parse(answer.out);
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column) {
      const double before = stated["lps_from_voxel"][row][column],
                   after = named["lps_from_voxel"][row][column];
      EXPECT_NEAR(after, (row < 2 ? -10.0 : 10.0) * before, 1e-9) << row << ", " << column;
    }
  int warnings = 0;
  for (const SortedJson& line : named["audit"]) {
    const bool is_option = line["check"] == "orientation" || line["check"] == "length_unit";
    warnings += is_option && line["verdict"] == "WARN";
  }
  EXPECT_EQ(warnings, 2) << named["audit"];
  expect_refused(run("info " + at("ball.nrrd") + " --frame up"), "RAS");
  expect_refused(run("info " + at("ball.nrrd") + " --unit pixel"), "inch");
  ASSERT_EQ(run("convert " + at("ball.nrrd") + " --dicom -o " + at("ball_dicom")).status, 0);
  expect_refused(run("info " + at("ball_dicom") + " --frame RAS"), "leave --frame");
  expect_refused(run("info " + at("ball_dicom") + " --unit mm"), "leave --frame and --unit out");
}

TEST_F(CommandLine, WrongUsageIsStatusTwoAndOneLine) {
  expect_refused(run(""), "subcommand is required");
  expect_refused(run("lok " + at("ball.nrrd")), "lok");
  expect_refused(run("info"), "file");
  expect_refused(run("info " + at("missing.nrrd")), "missing.nrrd");
  expect_refused(run("info " + std::string(300, 'a') + ".nrrd"), "aaa.nrrd: ");
  expect_refused(run("measure " + at("ball.nrrd") + " --json"), "--window");
  expect_refused(run("measure " + at("ball.nrrd") + " --window abc"), "abc");
  expect_refused(run("measure " + at("ball.nrrd") + " --window 5:1"), "5:1");
  expect_refused(run("render " + at("ball.nrrd") + " --window 0: --view front -o " + at("p.png")), "front");
  for (const char* wrong : {"--stereo nan", "--eye inf", "--eye 0", "--width nan", "--opacity nan"})
    expect_refused(run("render " + at("ball.nrrd") + " --window 0: -o " + at("p.png") + " " + wrong),
                   std::string(wrong).substr(std::string(wrong).find(' ') + 1));
  for (const char* orthographic : {"mip", "radiograph", "composite"})
    expect_refused(
        run("render " + at("ball.nrrd") + " --eye 500 -o " + at("p.png") + " --shading " + orthographic),
        orthographic);
  expect_refused(run("render " + at("ball.nrrd") + " --window 0: --size 0x5 -o " + at("p.png")), "0x5");
  expect_refused(run("render " + at("ball.nrrd") + " --window 0: -o " + at("no/p.png")), "no folder");
  expect_refused(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("p.stp")), ".stl");
  expect_refused(run("run " + at("ball.plan.json") + " -o " + at("out") + " --scan tc=x"),
                 "did you mean 'ct'");
  expect_refused(run("phantom torso -o " + at("p.nrrd")), "torso");
}

TEST_F(CommandLine, ABrokenPlanLeavesNothing) {
  write("broken.plan.json", R"({ "octotomy_plan": 1, "name": "x", "scans": { "ct": { "path": "ball.nrrd" } },
    "steps": [ { "id": "ball", "do": "window", "scan": "ct", "lo": 0 } ] })");
  expect_refused(run("run " + at("broken.plan.json") + " -o " + at("out") + " --json"),
                 "did you mean 'low'?");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  write("empty.plan.json", R"({ "octotomy_plan": 1, "name": "x", "scans": { "ct": { "path": "ball.nrrd" } },
    "steps": [ { "id": "ball", "do": "window", "scan": "ct", "low": 9000 } ] })");
  expect_refused(run("run " + at("empty.plan.json") + " -o " + at("out") + " --json"), "no voxel");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(CommandLine, RunAnswersWithTheFileItWrote) {
  const CommandAnswer answer = run("run " + at("ball.plan.json") + " -o " + at("out") + " --json");
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const SortedJson said = SortedJson::parse(answer.out);
  std::ifstream file(folder_ / "out/result.json");
  EXPECT_EQ(said, SortedJson::parse(file));
  EXPECT_EQ(said["octotomy"], OCTOTOMY_VERSION);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/ball.stl"));
}

TEST_F(CommandLine, ARunKeepsWhatTheUserPutIntoItsFolderAndRefusesWhatTheUserChanged) {
  const std::string again = "run " + at("out/my.plan.json") + " -o " + at("out");
  ASSERT_EQ(run("run " + at("ball.plan.json") + " -o " + at("out")).status, 0);
  std::filesystem::copy_file(folder_ / "ball.plan.json", folder_ / "out/my.plan.json");
  std::filesystem::copy_file(folder_ / "ball.nrrd", folder_ / "out/ball.nrrd");
  ASSERT_EQ(run(again).status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/my.plan.json"));
  write("out/ball.stl", "edited");
  expect_refused(run(again), "out/ball.stl: was changed");
  EXPECT_EQ(tests::bytes_of(folder_ / "out/ball.stl"), "edited");
  for (const char* verb : {"look ", "verify --report . "})
    expect_refused(tests::run_command("cd " + at("out") + " && " OCTOTOMY_BINARY_DIR "/octotomy " + verb +
                                          at("ball.nrrd") + (verb[0] == 'l' ? " -o ." : ""),
                                      folder_ / ""),
                   "working folder");
}

TEST_F(CommandLine, ATableReplacesNeitherAScanNorAFileOfAResult) {
  ASSERT_EQ(run("run " + at("ball.plan.json") + " -o " + at("out")).status, 0);
  const std::string table = "table " + at("out") + " -o ";
  for (const char* taken : {"ball.nrrd", "out/result.json", "out/tables/measurements.csv"}) {
    const std::string before = tests::bytes_of(folder_ / taken);
    ASSERT_FALSE(before.empty()) << taken;
    expect_refused(run(table + at(taken)), std::string(taken) + (std::string(taken).ends_with(".csv")
                                                                     ? ": is a file of a result"
                                                                     : ": a table is written as .csv"));
    EXPECT_EQ(tests::bytes_of(folder_ / taken), before) << taken;
  }
  expect_refused(run(table + at("no/table.csv")), "no folder");
  for (int i = 0; i < 2; ++i) EXPECT_EQ(run(table + at("out/mine.csv")).status, 0) << i;
}

TEST_F(CommandLine, ARunThatIsKilledAtAnyInstantLeavesTheResultThatWasThere) {
  const std::string command = std::string(OCTOTOMY_BINARY_DIR) + "/octotomy run " + at("ball.plan.json") +
                              " -o " + at("out") + " >" + at("said") + " 2>&1";
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::chrono::duration<double> run_s = std::chrono::steady_clock::now() - start;
  write("out/mine.frd", "mine");
  const auto whole = [&] {
    return tests::run_command("cd " + at("out") + " && sha256sum --check --quiet .octotomy-result",
                              folder_ / "")
                   .status == 0 &&
           tests::bytes_of(folder_ / "out/mine.frd") == "mine";
  };
  ASSERT_TRUE(whole());
  for (int i = 0; i < 30; ++i) {
    std::ostringstream late;
    late << "timeout -s KILL " << run_s.count() * (i + 0.5) / 30 << " " << command;
    [[maybe_unused]] const int status = std::system(late.str().c_str());
    ASSERT_TRUE(whole()) << "killed after " << late.str();
  }
  std::filesystem::remove(folder_ / "out/result.json");
  EXPECT_FALSE(whole()) << "the check sees nothing";
}

TEST_F(CommandLine, AnotherScanCanTakeTheNamedOnesPlace) {
  voxel::write_scene(tests::ball_scene(9.0, 32), folder_ / "small.nrrd");
  const CommandAnswer answer =
      run("verify " + at("ball.plan.json") + " --scan ct=" + at("small.nrrd") + " --json");
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const SortedJson said = SortedJson::parse(answer.out);
  EXPECT_NEAR(said["certificates"][0]["voxel"]["volume_mm3"].get<double>(), tests::ball_mm3(9.0), 60.0);
  EXPECT_EQ(said["counts"]["FAIL"], 0);
}

TEST_F(CommandLine, TheAnswerIsTheSameOnAnyNumberOfThreads) {
  const auto measured = [&](const std::string& threads) {
    SortedJson json =
        SortedJson::parse(run("measure " + at("ball.nrrd") + " --window 0: --json --threads " + threads).out);
    json.erase("timings_ms");
    return json;
  };
  EXPECT_EQ(measured("1"), measured("2"));
}

// For 16-bit samples the octree is built during reading; for other samples it is built afterwards.
TEST_F(CommandLine, MeasuresAlikeWhetherTheOctreeIsBuiltBesideTheReadingOrAfterIt) {
  voxel::Scene scene = tests::ball_scene(40.0, 160);
  voxel::write_scene(scene, folder_ / "shorts.nrrd");
  const auto& shorts = std::get<voxel::Int16Samples>(scene.samples);
  scene.samples = voxel::FloatSamples(shorts.begin(), shorts.end());
  voxel::write_scene(scene, folder_ / "floats.nrrd");
  for (const std::string options : {"", " --voxel 1.7", " --threads 1"}) {
    const auto measured = [&](const std::string& name) {
      SortedJson json = SortedJson::parse(run("measure " + at(name) + " --window 0: --json" + options).out);
      for (const char* key : {"timings_ms", "source", "audit", "inputs", "scans"}) json.erase(key);
      return json;
    };
    EXPECT_EQ(measured("shorts.nrrd"), measured("floats.nrrd")) << options;
  }
  const auto refusal = [&](const std::string& name, const std::string& options) {
    const tests::CommandAnswer answer = run("measure " + at(name) + options);
    expect_refused(answer, "");
    return answer.errors;
  };
  for (const std::string options : {" --window 0: --voxel 0.00001", ""}) {
    std::string of_floats = refusal("floats.nrrd", options);
    if (const std::size_t name = of_floats.find("floats"); name != std::string::npos)
      of_floats.replace(name, 6, "shorts");
    EXPECT_EQ(refusal("shorts.nrrd", options), of_floats);
  }
  std::string bytes = tests::bytes_of(folder_ / "shorts.nrrd");
  bytes[bytes.size() - 5] ^= 1;
  write("checksum.nrrd", bytes);
  write("short.nrrd", bytes.substr(0, bytes.size() / 2));
  for (const std::string name : {"checksum.nrrd", "short.nrrd"})
    EXPECT_NE(refusal(name, " --window 0:").find("packed samples are damaged or cut short"),
              std::string::npos);
}

TEST_F(CommandLine, MeasuresAScansWindowAndAMesh) {
  const SortedJson scan = SortedJson::parse(run("measure " + at("ball.nrrd") + " --window 0: --json").out);
  EXPECT_NEAR(scan["volume_mm3"].get<double>(), tests::ball_mm3(12.0), 60.0);
  EXPECT_NEAR(scan["volume_partial_mm3"].get<double>(), tests::ball_mm3(12.0), 60.0);
  EXPECT_NEAR(scan["area_mm2"].get<double>(), 4.0 * M_PI * 144.0, 0.03 * 4.0 * M_PI * 144.0);
  EXPECT_EQ(scan["components"], 1);
  EXPECT_EQ(scan["euler"], 2);
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.ply")).status, 0);
  const SortedJson mesh = SortedJson::parse(run("measure " + at("ball.ply") + " --json").out);
  EXPECT_NEAR(mesh["volume_mm3"].get<double>(), scan["volume_isosurface_mm3"].get<double>(), 1e-6);
  // The partial volume of voxels is another estimate of the same volume, from the same samples.
  EXPECT_NEAR(mesh["volume_mm3"].get<double>() / scan["volume_partial_mm3"].get<double>(), 1.0, 0.003);
  EXPECT_NE(mesh["volume_mm3"], scan["volume_partial_mm3"]);
  EXPECT_TRUE(mesh["volume_partial_mm3"].is_null());
  EXPECT_FALSE(mesh["findings"].empty());
}

TEST_F(CommandLine, ARenderedBallCoversItsDisc) {
  const SortedJson json = SortedJson::parse(
      run("render " + at("ball.nrrd") + " --window 0: --size 256x256 --json -o " + at("ball.png")).out);
  const double lit_mm2 = json["lit_pixels"].get<double>() * std::pow(json["pixel_mm"].get<double>(), 2);
  EXPECT_NEAR(lit_mm2, M_PI * 144.0, 2.0 * M_PI * 12.0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "ball.png"));
}

TEST_F(CommandLine, ACutPictureKeepsTheHalfThatTheNormalPointsAwayFromAndNamesItsObjects) {
  // Seen from the patient's left, a ball without its left half shows its flat face, at the ball's middle.
  const std::string ball = "render " + at("ball.nrrd") + " --window 0: --view left --json -o " + at("p.png");
  const SortedJson whole = SortedJson::parse(run(ball).out);
  const SortedJson cut =
      SortedJson::parse(run(ball + " --cut-plane 2,0,0,0 --cut-face grey --tones=-1000:1000").out);
  EXPECT_NEAR(cut["depth_range_mm"][0].get<double>() - whole["depth_range_mm"][0].get<double>(), 12.0, 0.1);
  EXPECT_NEAR(cut["depth_range_mm"][1].get<double>() - cut["depth_range_mm"][0].get<double>(), 0.0, 1.0);
  EXPECT_EQ(cut["pixel_mm"], whole["pixel_mm"]);
  ASSERT_EQ(cut["objects"].size(), 1u);
  EXPECT_EQ(cut["objects"][0]["name"], "ball");
  EXPECT_EQ(cut["objects"][0]["lit_pixels"], cut["lit_pixels"]);
  const SortedJson boxed = SortedJson::parse(run(ball + " --cut-box 0,-20,-20,20,20,20").out);
  EXPECT_EQ(boxed["depth_range_mm"][0], cut["depth_range_mm"][0]);
  expect_refused(run(ball + " --cut-plane 1,0,0"), "4 numbers");
  expect_refused(run(ball + " --cut-plane 0,0,0,4"), "without length");
  expect_refused(run(ball + " --cut-box 0,0,0,-1,1,1"), "lower corner");
  expect_refused(run(ball + " --cut-face grey"), "--cut-plane");
  expect_refused(run(ball + " --cut-plane 1,0,0,0 --cut-face grey --tones 5"), "5");
}

TEST_F(CommandLine, AnAnnotatedPictureIsAnotherPictureOfTheSamePixels) {
  const std::string ball = "render " + at("ball.nrrd") + " --window 0: --size 200x150 --json";
  const SortedJson plain = SortedJson::parse(run(ball + " -o " + at("p.png")).out);
  const SortedJson annotated =
      SortedJson::parse(run(ball + " --annotate --title truth -o " + at("a.png")).out);
  EXPECT_EQ(plain["lit_pixels"], annotated["lit_pixels"]);
  EXPECT_EQ(plain["pixel_mm"], annotated["pixel_mm"]);
  EXPECT_NE(std::filesystem::file_size(folder_ / "p.png"), std::filesystem::file_size(folder_ / "a.png"));
  EXPECT_EQ(run("render " + at("ball.nrrd") + " --shading mip --annotate -o " + at("m.png")).status, 0);
}

TEST_F(CommandLine, AnOptionThatChangesNothingIsRefused) {
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --window 0: -o " + at("b.octree")).status, 0);
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --grey -o " + at("g.octree")).status, 0);
  const std::string octree = "octree " + at("b.octree") + " -o " + at("x.octree");
  expect_refused(run(octree + " --voxel 2"), "--voxel");
  expect_refused(run(octree + " --grey"), "--grey");
  expect_refused(run(octree + " --depth 6"), "--from");
  const std::string out = " -o " + at("x.png");
  expect_refused(run("render " + at("g.octree") + out + " --shading radiograph --window 0:"), "--window");
  expect_refused(run("render " + at("g.octree") + out + " --shading mip --colour '#ff0000'"), "--colour");
  expect_refused(run("render " + at("b.octree") + out + " --window 0:"), "--window");
  expect_refused(run("render " + at("b.octree") + out + " --voxel 2"), "--voxel");
  expect_refused(run("render " + at("g.octree") + out + " --range 3"), "--colour-by");
  expect_refused(run("slice " + at("b.octree") + out + " --interpolate cubic"), "--interpolate");
  expect_refused(run("slice " + at("g.octree") + out + " --height 20"), "--curve");
  expect_refused(run("slice " + at("g.octree") + out + " --up 0,0,1"), "--up");
  const std::string mesh = "mesh " + at("b.octree") + " -o " + at("x.stl");
  expect_refused(run(mesh + " --tiling least-area"), "--surface");
  expect_refused(run(mesh + " --touching together"), "--surface");
  EXPECT_EQ(run(mesh + " --touching together --surface cuberille").status, 0);
  EXPECT_EQ(run("render " + at("g.octree") + out + " --shading radiograph").status, 0);
}

TEST_F(CommandLine, APointPickedInTwoViewsIsMarkedWhereTheyMeet) {
  const auto picked = [&](const std::string& view) {
    return SortedJson::parse(run("render " + at("ball.nrrd") + " --window 0: --size 101x101 --view " + view +
                                 " --pick 50,50 --pick 0,0 --json -o " + at("p.png"))
                                 .out)["picks"];
  };
  const SortedJson front = picked("anterior");
  EXPECT_EQ(front[0]["object"], "ball");
  EXPECT_NEAR(front[0]["point_mm"][1].get<double>(), -12.0, 0.1);
  EXPECT_NEAR(front[0]["point_mm"][0].get<double>(), front[0]["view_mm"][0].get<double>(), 1e-9);
  EXPECT_TRUE(front[1]["object"].is_null());
  EXPECT_TRUE(front[1]["point_mm"].is_null());
  EXPECT_TRUE(front[1]["depth_mm"].is_null());
  const SortedJson mark = SortedJson::parse(run("mark --in anterior:3,4 --in left:-5,6 --json").out);
  EXPECT_EQ(mark["point_mm"], SortedJson::parse("[3.0, -5.0, 5.0]"));
  EXPECT_NEAR(mark["miss_mm"].get<double>(), 2.0, 1e-12);
  expect_refused(run("mark --in anterior:3,4 --in posterior:1,2"), "same direction");
  expect_refused(run("mark --in anterior:3,4"), "--in");
  expect_refused(run("render " + at("ball.nrrd") + " --window 0: --pick 512,0 -o " + at("q.png")), "512,0");
}

TEST_F(CommandLine, ATransferFunctionOfAFileIsDrawnAndOneThatIsNoneIsRefused) {
  write("t.json", R"({ "octotomy_transfer": 1, "points": [
      { "sample": 0, "colour": "#cc8c6b", "per_mm": 0 }, { "sample": 400, "colour": "#f0e3c7", "per_mm": 9 } ] })");
  write("u.json", R"({ "octotomy_transfer": 1, "points": [ { "sampel": 0 } ] })");
  const std::string ball =
      "render " + at("ball.nrrd") + " --shading composite --size 256x256 --json -o " + at("c.png");
  const SortedJson json = SortedJson::parse(run(ball + " --transfer " + at("t.json")).out);
  const double lit_mm2 = json["lit_pixels"].get<double>() * std::pow(json["pixel_mm"].get<double>(), 2);
  EXPECT_NEAR(lit_mm2, M_PI * 144.0, 2.0 * M_PI * 12.0);
  EXPECT_NEAR(json["depth_range_mm"][1].get<double>() - json["depth_range_mm"][0].get<double>(), 12.0, 2.0);
  EXPECT_EQ(run(ball).status, 0);
  expect_refused(run(ball + " --transfer " + at("u.json")), "did you mean 'sample'");
  expect_refused(run(ball + " --transfer hair"), "vessels");
  expect_refused(run("render " + at("ball.nrrd") + " --transfer bone -o " + at("c.png")), "composite");
  expect_refused(run("render " + at("ball.nrrd") + " --title x -o " + at("c.png")), "--annotate");
  expect_refused(run("render " + at("ball.nrrd") + " --range 2 -o " + at("c.png")), "--colour-by");
  expect_refused(run(ball + " --count"), "--count");
}

TEST_F(CommandLine, ABallColouredByAnotherInsideItIsAsFarOutsideAsTheirRadiiDiffer) {
  voxel::write_scene(tests::ball_scene(9.0, 32), folder_ / "core.nrrd");
  const std::string ball = "render " + at("ball.nrrd") + " --window 0: --json --annotate -o " + at("p.png");
  const SortedJson json =
      SortedJson::parse(run(ball + " --range 4 --colour-by distance:" + at("core.nrrd")).out);
  EXPECT_EQ(json["colour_by"]["distance_to"], "core");
  EXPECT_EQ(json["colour_by"]["range_mm"], 4.0);
  EXPECT_NEAR(json["colour_by"]["seen_mm"][0].get<double>(), 3.0, 0.87);
  EXPECT_NEAR(json["colour_by"]["seen_mm"][1].get<double>(), 3.0, 0.87);
  ASSERT_EQ(json["objects"].size(), 1u);
  expect_refused(run(ball + " --colour-by distance:nowhere.octree"), "nowhere.octree");
  expect_refused(run(ball + " --colour-by height"), "distance:FILE");
}

TEST_F(CommandLine, OctreesOfAScanTellTheirLevelsAndEvaluate) {
  const SortedJson ball =
      SortedJson::parse(run("octree " + at("ball.nrrd") + " --window 0: --json -o " + at("ball.octree")).out);
  EXPECT_EQ(ball["fields"], "binary");
  EXPECT_EQ(ball["depth"], 5);
  EXPECT_NEAR(ball["voxels"].get<double>(), tests::ball_mm3(12.0), 60.0);
  EXPECT_EQ(ball["bytes_file"], std::filesystem::file_size(folder_ / "ball.octree"));
  const SortedJson told = SortedJson::parse(run("info " + at("ball.octree") + " --json").out);
  for (const char* key : {"depth", "levels", "voxels", "bytes_memory", "bytes_file", "metadata"})
    EXPECT_EQ(told[key], ball[key]) << key;
  ASSERT_EQ(told["levels"].size(), 5u);
  std::uint64_t voxels = 0;
  for (const SortedJson& level : told["levels"])
    voxels += level["full"].get<std::uint64_t>() << (3 * (5 - level["level"].get<int>()));
  EXPECT_EQ(voxels, told["voxels"]);

  // The same object by way of its samples, moved by whole voxels there and back.
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --grey -o " + at("grey.octree")).status, 0);
  const std::string lets = " --let ball=" + at("ball.octree") + " --let grey=" + at("grey.octree") +
                           " --window grey=0: --motion there=2,0,-1 --json -o " + at("result.octree");
  const std::string back = " --motion back=-2,0,1";
  EXPECT_EQ(SortedJson::parse(run("eval 'move(move(ball, there), back) ^ grey'" + lets + back).out)["voxels"],
            0);
  const SortedJson moved = SortedJson::parse(run("eval 'move(grey, there) | ball'" + lets).out);
  EXPECT_GT(moved["voxels"], ball["voxels"]);
  expect_refused(run("eval 'bal | grey'" + lets), "did you mean 'ball'");
  expect_refused(run("eval 'ball |'" + lets), "character");
  // What changes nothing is refused: a motion and a file that are not named, and options without an object.
  expect_refused(run("eval 'move(grey, there) | ball'" + lets + back),
                 "--motion: the expression does not use 'back'");
  expect_refused(run("eval 'move(grey, there)'" + lets), "--let ball: the expression does not use this name");
  const std::string alone = " --let ball=" + at("ball.octree") + " -o " + at("x.octree");
  expect_refused(run("eval ball --grey" + alone), "--grey does not apply, because no operand has samples");
  expect_refused(run("eval ball --digitise half" + alone), "--motion");
  expect_refused(run("eval ball --interpolate nearest" + alone), "--motion");
  expect_refused(run("eval 'move(ball, m)' --motion m=1,0,0 --interpolate nearest" + alone),
                 "--interpolate does not apply, because no operand has samples");
  expect_refused(run("contours " + at("ball.nrrd") + " --window 0: --code-spacing 2 -o " + at("x.json")),
                 "--codes");
  expect_refused(run("segment " + at("ball.nrrd") + " --window 0: --identity remove -o " + at("x.octree")),
                 ".dcm");
  expect_refused(run("measure " + at("ball.octree") + " --voxel 2"), "already has voxels");
  expect_refused(run("eval grey --let grey=" + at("grey.octree") + " -o " + at("x.octree")),
                 "--window grey=");
  expect_refused(run("octree " + at("ball.nrrd") + " -o " + at("x.octree")), "--window LOW:HIGH");
  expect_refused(run("octree " + at("grey.octree") + " --as runs -o " + at("x.txt")), "--window LOW:HIGH");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.octree"));
}

TEST_F(CommandLine, Figure31GoesThroughEveryRepresentation) {
  write("figure.txt", "P(EP(EEEEEEEF)FP(EEEEFEEE)EEP(EFFEEFEE)E)\n");
  ASSERT_EQ(run("octree " + at("figure.txt") + " --from treecode --depth 2 -o " + at("figure.octree")).status,
            0);
  const auto content = [&](const std::string& name) { return tests::bytes_of(folder_ / name); };
  for (const char* form : {"treecode", "linear", "explicit", "runs", "segments", "marginal", "faces", "array",
                           "packed", "bits"}) {
    SCOPED_TRACE(form);
    const std::string file = std::string(form) + ".txt";
    ASSERT_EQ(run("octree " + at("figure.octree") + " --as " + form + " -o " + at(file)).status, 0);
    ASSERT_EQ(run("octree " + at(file) + " --from " + form + " --depth 2 -o " + at("back.octree")).status, 0);
    ASSERT_EQ(run("octree " + at("back.octree") + " --as treecode -o " + at("back.txt")).status, 0);
    EXPECT_EQ(content("back.txt"), content("figure.txt"));
  }
  EXPECT_EQ(content("linear.txt"), "17, 2, 34, 61, 62, 65\n");
  EXPECT_EQ(content("runs.txt"), "8:9 12:13 23:26 28:29 41:41 44:44 57:57\n");
  expect_refused(run("octree " + at("runs.txt") + " --from linear --depth 2 -o " + at("x.octree")),
                 "character 1");
  expect_refused(run("octree " + at("runs.txt") + " --from runs -o " + at("x.octree")), "--depth");
}

TEST_F(CommandLine, TheThesissSphereHasTable3_1) {
  const SortedJson made = SortedJson::parse(
      run("phantom sphere --voxels 256 --radius 64 --digitise partial --json -o " + at("sphere.octree")).out);
  EXPECT_NEAR(made["truth"]["volume_mm3"], 4.0 / 3.0 * M_PI * 64 * 64 * 64, 1e-6);
  EXPECT_NEAR(made["truth"]["area_mm2"], 4.0 * M_PI * 64 * 64, 1e-6);
  const SortedJson told = SortedJson::parse(run("info " + at("sphere.octree") + " --json").out);
  const std::vector<std::array<int, 3>> table{{8, 0, 0},           {8, 0, 56},        {56, 8, 0},
                                              {272, 72, 104},      {1160, 480, 536},  {4760, 2240, 2280},
                                              {19232, 9360, 9488}, {0, 115784, 38072}};
  ASSERT_EQ(told["levels"].size(), table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    EXPECT_EQ(told["levels"][i]["level"], i + 1);
    EXPECT_EQ(told["levels"][i]["partial"], table[i][0]) << "level " << i + 1;
    EXPECT_EQ(told["levels"][i]["full"], table[i][1]) << "level " << i + 1;
    EXPECT_EQ(told["levels"][i]["empty"], table[i][2]) << "level " << i + 1;
  }
  const SortedJson measured = SortedJson::parse(run("measure " + at("sphere.octree") + " --json").out);
  EXPECT_NEAR(measured["volume_partial_mm3"].get<double>() / made["truth"]["volume_mm3"].get<double>(), 1.0,
              1e-4);
  EXPECT_NEAR(measured["area_mm2"].get<double>() / made["truth"]["area_mm2"].get<double>(), 1.0, 0.02);
  EXPECT_EQ(measured["components"], 1);
  EXPECT_EQ(measured["euler"], 1);
  expect_refused(run("phantom sphere --voxels 100 -o " + at("x.octree")), "100");
  expect_refused(run("phantom sphere --noise 3 -o " + at("x.octree")), "--noise");
  expect_refused(run("phantom head --radius 3 -o " + at("x.nrrd")), "--radius");
}

TEST_F(CommandLine, MasksComeFromViewsAndSlicesAndAreEditedFurther) {
  write("front.json", R"({"polygons_mm": [[[-10,-10],[6,-10],[6,10],[-10,10]]]})");
  write("side.json", "[[[-8,-10],[8,-10],[8,10],[-8,10]]]");
  write("slices.json", R"({"view": "inferior", "slices": [
      {"position_mm": 6, "polygons_mm": [[[-5,-5],[5,-5],[5,5],[-5,5]]]},
      {"position_mm": 2, "polygons_mm": [[[-5,-5],[5,-5],[5,5],[-5,5]]]}]})");
  const std::string front = " --region anterior:" + at("front.json");
  const std::string side = " --region left:" + at("side.json");
  const SortedJson both =
      SortedJson::parse(run("mask" + front + side + " --json -o " + at("both.octree")).out);
  EXPECT_EQ(both["voxels"], 16 * 16 * 20);
  EXPECT_EQ(both["step"]["views_of"], "scan") << "a plan that holds the head would turn it";
  const SortedJson one = SortedJson::parse(
      run("mask" + front + " --like " + at("both.octree") + " --json -o " + at("one.octree")).out);
  EXPECT_GT(one["voxels"], both["voxels"]);
  const SortedJson edited = SortedJson::parse(
      run("mask" + side + " --edit " + at("one.octree") + " --json -o " + at("edited.octree")).out);
  EXPECT_EQ(edited["levels"], both["levels"]);
  const SortedJson slices =
      SortedJson::parse(run("mask --slices " + at("slices.json") + " --json -o " + at("slices.octree")).out);
  EXPECT_EQ(slices["voxels"], 10 * 10 * 8);
  expect_refused(run("mask" + front + " -o " + at("x.octree")), "--like");
  expect_refused(run("mask -o " + at("x.octree")), "--region");
  expect_refused(run("mask --region front:" + at("front.json") + " -o " + at("x.octree")), "front");
  expect_refused(run("mask --region anterior:" + at("slices.json") + " -o " + at("x.octree")), "slices");
}

TEST_F(CommandLine, GreyResultsKeepTheirSamplesAndAreMeasured) {
  ASSERT_EQ(run("octree " + at("ball.nrrd") + " --grey -o " + at("grey.octree")).status, 0);
  const std::string ask = " --let g=" + at("grey.octree") + " --window g=0: ";
  const SortedJson kept =
      SortedJson::parse(run("eval g" + ask + "--grey --json -o " + at("kept.octree")).out);
  EXPECT_EQ(kept["fields"], "grey");
  EXPECT_GE(kept["range"][1], 900);
  // The object that keeps its samples still has the samples' surface, even when it is moved by half voxels.
  const SortedJson measured =
      SortedJson::parse(run("measure " + at("grey.octree") + " --window 0: --json").out);
  EXPECT_NEAR(measured["volume_partial_mm3"].get<double>() / tests::ball_mm3(12.0), 1.0, 0.005);
  EXPECT_EQ(measured["inertia_mm5"].size(), 3u);
  for (const char* how : {"--interpolate nearest", "--interpolate cubic", "--digitise half"})
    EXPECT_EQ(run("eval 'move(g, m)'" + ask + "--motion m=0.4,0,0,10,0,0,1 " + how + " -o " + at("m.octree"))
                  .status,
              0)
        << how;
  expect_refused(run("measure " + at("grey.octree")), "--window");
}

TEST_F(CommandLine, TimeOverIsStatusThreeAndLeavesNothing) {
  const CommandAnswer answer =
      run("run " + at("ball.plan.json") + " -o " + at("out") + " --json --time-limit 0.000001");
  EXPECT_TRUE(answer.status == 3 || answer.status == 0) << answer.errors;
  EXPECT_EQ(answer.status == 3, !std::filesystem::exists(folder_ / "out"));
}

TEST_F(CommandLine, AFullDiskIsStatusThree) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  EXPECT_EQ(run("info " + at("ball.nrrd") + " --json > /dev/full").status, 3);
}

TEST_F(CommandLine, AReaderThatGoesAwayIsNoError) {
  const std::string command = "bash -c \"set -o pipefail; '" + std::string(OCTOTOMY_BINARY_DIR) +
                              "/octotomy' info " + (folder_ / "ball.nrrd").string() + " --json | true\"";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 0);
}

}  // namespace
}  // namespace octotomy::planner
