// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A doubt about a scan reaches whoever uses it: every verb that reads scans tells the audit's warnings and
// failures, in its JSON and on standard error, with their files.
#include <sstream>

#include "tests/planner/cli/program/command_line.h"
#include "tests/voxel/scan/spoiled_series.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::SortedJson;
using tests::SpoiledKind;

class SpoiledScan : public tests::CommandLine {
 protected:
  const SpoiledKind& kind(const std::string& name) const {
    for (const SpoiledKind& each : tests::spoiled_kinds())
      if (each.name == name) return each;
    throw std::logic_error("there is no kind " + name);
  }
  /// Writes the kind's folder as "scan".
  void spoil(const std::string& name) const {
    std::filesystem::remove_all(folder_ / "scan");
    kind(name).write(folder_ / "scan");
  }
  static const SortedJson* line_of(const SortedJson& audit, const std::string& check) {
    for (const SortedJson& line : audit)
      if (line["check"] == check) return &line;
    return nullptr;
  }
  /// The audit in an answer: its own, or that of the only scan that it lists.
  static SortedJson audit_of(const SortedJson& answer) {
    if (answer.contains("audit")) return answer["audit"];
    if (!answer.contains("scans") || answer["scans"].empty()) return nullptr;
    return answer["scans"][0]["audit"];
  }
  std::vector<std::string> verbs() const {
    const std::string scan = at("scan"), window = " --window 0: ";
    write("plan.json", R"({ "octotomy_plan": 1, "name": "ball", "scans": { "ct": { "path": "scan" } },
      "universe": { "voxel_mm": 1 },
      "steps": [ { "id": "ball", "do": "window", "scan": "ct", "low": 0 },
                 { "id": "half", "do": "combine", "expression": "ball" } ] })");
    return {"info " + scan,
            "segment " + scan + window + "-o " + at("o.octree"),
            "contours " + scan + window + "-o " + at("o.json"),
            "slice " + scan + " --axial middle -o " + at("o.png"),
            "render " + scan + window + "--size 32x32 -o " + at("r.png"),
            "measure " + scan + window,
            "octree " + scan + window + "-o " + at("p.octree"),
            "mesh " + scan + window + "-o " + at("o.stl"),
            "prepare " + scan + " --step median=1 -o " + at("o.nrrd"),
            "convert " + scan + " -o " + at("c.nrrd"),
            "run " + at("plan.json") + " -o " + at("result"),
            "look " + scan + " -o " + at("look")};
  }
};

TEST_F(SpoiledScan, IsToldOfByEveryVerb) {
  for (const char* name : {"four_missing", "half_a_millimetre_sideways"}) {
    const SpoiledKind& spoiled = kind(name);
    spoil(name);
    const std::string verdict = spoiled.verdict == voxel::Verdict::Fail ? "FAIL" : "WARN";
    int asked = 0;
    for (const std::string& verb : verbs()) {
      const CommandAnswer answer = run(verb + " --json");
      ASSERT_TRUE(answer.status == 0 || answer.status == 1) << verb << '\n' << answer.errors;
      const SortedJson audit = audit_of(SortedJson::parse(answer.out));
      const SortedJson* line = line_of(audit, spoiled.check);
      ASSERT_NE(line, nullptr) << verb;
      EXPECT_EQ((*line)["verdict"], verdict) << verb;
      EXPECT_EQ((*line)["files"], SortedJson(spoiled.files)) << verb;
      EXPECT_NE(answer.errors.find(verdict + ", " + spoiled.check), std::string::npos)
          << verb << answer.errors;
      for (const std::string& file : spoiled.files)
        EXPECT_NE(answer.errors.find(file), std::string::npos) << verb << answer.errors;
      // A line once, not once a scan's use.
      EXPECT_EQ(answer.errors.find(", " + spoiled.check), answer.errors.rfind(", " + spoiled.check)) << verb;
      ++asked;
    }
    EXPECT_EQ(asked, 12);
  }
}

TEST_F(SpoiledScan, ReportsAndObjectsSayWhatIsInterpolated) {
  spoil("four_missing");
  ASSERT_LE(run(verbs()[10]).status, 1);
  std::ifstream page(folder_ / "result/report.html");
  const std::string html{std::istreambuf_iterator<char>(page), {}};
  EXPECT_NE(html.find("missing_slices"), std::string::npos);
  EXPECT_NE(html.find("a03"), std::string::npos);
  std::ifstream file(folder_ / "result/result.json");
  const SortedJson result = SortedJson::parse(file);
  ASSERT_EQ(result["scans"][0]["interpolated"].size(), 1u);
  EXPECT_EQ(result["scans"][0]["interpolated"][0]["length_mm"], 10.0);
  EXPECT_EQ(result["scans"][0]["interpolated"][0]["slices"], SortedJson({4, 7}));
  const std::string ball = result["objects"][0]["findings"].dump(),
                    half = result["objects"][1]["findings"].dump();
  EXPECT_NE(ball.find("interpolated over 1 gap between the images of 'ct', up to 10 mm"), std::string::npos)
      << ball;
  EXPECT_NE(half.find("made of 'ball'"), std::string::npos) << half;
  EXPECT_EQ(result["certificates"][0]["verdict"], "WARN");
  EXPECT_NE(result["certificates"][0]["reasons"].dump().find("interpolated over 1 gap"), std::string::npos)
      << result["certificates"][0];
  spoil("another_scanner");
  ASSERT_LE(run(verbs()[10]).status, 1);
  std::ifstream sound(folder_ / "result/result.json");
  EXPECT_EQ(SortedJson::parse(sound)["objects"][0]["findings"].dump().find("interpolated"),
            std::string::npos);
}

TEST_F(SpoiledScan, StacksAndSlicesAreChosenByOptionsAndInPlans) {
  spoil("two_kernels_at_each_place");
  const auto dims = [&](const std::string& options) {
    const CommandAnswer answer = run("info " + at("scan") + options + " --json");
    EXPECT_EQ(answer.status, 0) << answer.errors;
    return SortedJson::parse(answer.out)["dims"][2].get<int>();
  };
  EXPECT_EQ(dims(""), 12);
  EXPECT_EQ(dims(" --series H60s"), 11);
  EXPECT_EQ(dims(" --series 1.2 --slices 2:5"), 4);
  expect_refused(run("info " + at("scan") + " --series H90"), "1.2 'Head'");
  expect_refused(run("info " + at("scan") + " --slices 5:2"), "swap FROM and TO");
  expect_refused(run("info " + at("scan") + " --slices 5:20"), "1:12");
  write("chosen.json", R"({ "octotomy_plan": 1, "name": "ball",
      "scans": { "ct": { "path": "scan", "series": "1.2", "slices": "2:9" } },
      "steps": [ { "id": "ball", "do": "window", "scan": "ct", "low": 0 } ] })");
  ASSERT_LE(run("run " + at("chosen.json") + " -o " + at("result")).status, 1);
  std::ifstream file(folder_ / "result/result.json");
  EXPECT_EQ(SortedJson::parse(file)["scans"][0]["dims"][2], 8);
}

}  // namespace
}  // namespace octotomy::planner
