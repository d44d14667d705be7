// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/cephalometry/definition.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::planner {
namespace {

std::string refusal(const std::string& measure) {
  try {
    parse_cephalometry(R"({"cephalometry": "own", "says": "s", "landmarks": [{"name": "a", "says": "s"},
      {"name": "b", "says": "s"}], "measures": [)" +
                       measure + "]}");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(CephalometricDefinition, TheProgramsOwnReadAndNameWhereTheirNormsComeFrom) {
  for (const std::string& name : cephalometries()) {
    const Cephalometry read = read_cephalometry(name);
    EXPECT_EQ(read.name, name);
    EXPECT_GT(read.measures.size(), 20u);
    for (const CephalometricMeasure& measure : read.measures) {
      EXPECT_EQ(measure.norm.has_value(), measure.deviation.has_value()) << measure.name;
      EXPECT_EQ(measure.norm.has_value(), !measure.source.empty()) << measure.name;
    }
    // Each source describes people, and is that of a measure.
    for (const CephalometricSource& source : read.sources) {
      EXPECT_GT(source.says.size(), 20u) << source.name;
      EXPECT_TRUE(std::any_of(read.measures.begin(), read.measures.end(),
                              [&](const CephalometricMeasure& one) { return one.source == source.name; }))
          << source.name;
    }
  }
}

TEST(CephalometricDefinition, RefusalsNameThePlaceAndTheNearestName) {
  EXPECT_EQ(refusal(R"({"name": "d", "says": "s", "kind": "distance", "points": ["a", "b"]})"), "");
  EXPECT_NE(refusal(R"({"name": "d", "says": "s", "kind": "distanc", "points": ["a", "b"]})")
                .find("measures[0], kind: there is no 'distanc', did you mean 'distance'?"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"name": "d", "says": "s", "kind": "angle", "points": ["a", "b"]})")
                .find("points: must be 3 landmarks"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"name": "d", "says": "s", "kind": "distance", "points": ["a", "bb"]})")
                .find("'bb' is not defined before, did you mean 'b'?"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"name": "d", "says": "s", "kind": "difference", "of": ["d", "d"]})")
                .find("measures[0], of: 'd' is not defined before"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"name": "d", "says": "s", "kind": "tilt", "plane": "space", "points": ["a", "b"]})")
                .find("lateral or frontal"),
            std::string::npos);
  EXPECT_NE(refusal("7").find("measures[0]"), std::string::npos);
  EXPECT_THROW(parse_cephalometry("{"), std::runtime_error);
}

TEST(CephalometricDefinition, ASourceThatIsNotListedIsRefusedWhereSourcesAre) {
  const std::string begin = R"({"cephalometry": "own", "says": "s", "landmarks": [{"name": "a", "says": "s"},
      {"name": "b", "says": "s"}], )";
  const std::string measure =
      R"("measures": [{"name": "d", "says": "s", "kind": "distance", "points": ["a", "b"], "source": "Down 1948"}]})";
  EXPECT_EQ(parse_cephalometry(begin + measure).measures.front().source, "Down 1948");
  try {
    parse_cephalometry(begin + R"("sources": [{"name": "Downs 1948", "says": "children"}], )" + measure);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("'Down 1948' is not defined before, did you mean 'Downs 1948'?"),
              std::string::npos)
        << error.what();
  }
}

TEST(CephalometricDefinition, NestedTooDeepIsRefusedAsTextAndAsFile) {
  const tests::ScratchFolder folder;
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  const std::filesystem::path path = folder / "deep.json";
  tests::write_bytes(path, deep);
  EXPECT_THROW(parse_cephalometry(deep), std::runtime_error);
  try {
    read_cephalometry(path.string());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), path.string() + ": is nested more than 512 deep");
  }
}

}  // namespace
}  // namespace octotomy::planner
