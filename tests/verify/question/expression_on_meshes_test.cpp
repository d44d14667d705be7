// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/question/expression_on_meshes.h"

#include <gtest/gtest.h>
#include <stdexcept>
#include <stop_token>

#include "brep/mesh/components.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/shape/prism.h"

namespace octotomy::verify {
namespace {

/// An axis-aligned box.
brep::Solid box(const glm::dvec3& a, const glm::dvec3& b) {
  brep::Prism prism;
  prism.polygons_mm = {{{a.x, a.z}, {b.x, a.z}, {b.x, b.z}, {a.x, b.z}}};
  prism.from_mm = a.y;
  prism.to_mm = b.y;
  return brep::solid_of(prism);
}

/// Three boxes in general position within a world of 10 x 10 x 10; their volumes are products.
class MeshExpression : public testing::Test {
 protected:
  double volume_mm3(const std::string& text) {
    return meshes_.evaluate(text, [this](std::string_view name) { return solid(name); })
        .measures()
        .volume_mm3;
  }
  brep::Solid solid(std::string_view name) const {
    if (name == "a") return a_;
    if (name == "b") return b_;
    if (name == "c") return c_;
    if (name == "far") return far_;
    throw std::invalid_argument("no " + std::string(name));
  }

  brep::Solid a_ = box({1, 1, 1}, {5, 5, 5});             // 64
  brep::Solid b_ = box({3, 2, 2}, {7, 4, 4});             // 16, of which a holds 8
  brep::Solid c_ = box({4, 3, 0.5}, {4.5, 3.5, 9});       // 2.125; a holds 1, b 0.5, all of it in a
  brep::Solid far_ = box({8, 8, 8}, {9, 9, 9});           // 1
  MeshExpressions meshes_{box({0, 0, 0}, {10, 10, 10})};  // 1000
};

constexpr double rounding_mm3 = 1e-9;

TEST_F(MeshExpression, TheFourOperationsHaveTheirVolumes) {
  EXPECT_NEAR(volume_mm3("a & b"), 8.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("a | b"), 72.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("a - b"), 56.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("b - a"), 8.0, rounding_mm3);
}

// Two prongs of one body; a mask takes both off, and one of them is chosen.
TEST_F(MeshExpression, APartOfWhatWasCutIsTakenFromTheWholeWithoutMeetingItsOwnSurface) {
  const brep::Solid body = meshes_.evaluate("a - n", [](std::string_view name) {
    return name == "a" ? box({1, 1, 1}, {9, 5, 7}) : box({4, 0.5, 3}, {6, 6, 8});
  });
  const brep::Solid mask = box({0.5, 0.5, 5.1}, {9.5, 5.5, 7.5});
  const auto all = [&](std::string_view name) { return name == "body" ? body : mask; };
  const brep::Solid prongs = meshes_.evaluate("body & mask", all);
  ASSERT_EQ(prongs.components().size(), 2u);
  const auto part = [&](std::size_t which) {
    return brep::trusted_solid(brep::part_of(prongs, prongs.components()[which].faces), prongs.proof());
  };
  const brep::Solid piece = part(0), other = part(1);
  const auto lookup = [&](std::string_view name) {
    return name == "piece" ? piece : name == "prongs" ? prongs : all(name);
  };
  const auto origin = [](std::string_view name) {
    return std::string(name == "prongs" ? "body & mask" : "");
  };
  const auto choice = [&](std::string_view name) -> std::optional<MeshExpressions::PartsOf> {
    if (name != "piece") return std::nullopt;
    return MeshExpressions::PartsOf{"prongs", other};
  };
  const brep::Solid rest = meshes_.evaluate("body - piece", lookup, {}, origin, choice);
  EXPECT_NEAR(rest.measures().volume_mm3, body.measures().volume_mm3 - piece.measures().volume_mm3, 1e-12);
  EXPECT_EQ(rest.components().size(), 1u);
  EXPECT_EQ(brep::health(rest.triangles()).findings, std::vector<std::string>());
  EXPECT_EQ(meshes_.shift_mm(), 0.0);
  // What was not cut from the body is asked of the Boolean.
  const auto elsewhere = [](std::string_view name) {
    return std::string(name == "prongs" ? "mask & other" : "");
  };
  EXPECT_NEAR(meshes_.evaluate("body - piece", lookup, {}, elsewhere, choice).measures().volume_mm3,
              rest.measures().volume_mm3, 1e-6);
}

TEST_F(MeshExpression, OfFiftyThousandOperandsIsNoDeepTree) {
  std::string text = "a";
  for (int i = 1; i < 50'000; ++i) text += i % 2 == 0 ? " | a" : " | b";
  EXPECT_NEAR(volume_mm3(text), 72.0, rounding_mm3);
}

TEST_F(MeshExpression, NestedTooDeepIsRefusedWithTheDepthThatIsAllowed) {
  for (const char symbol : {'(', '~'}) {
    try {
      volume_mm3(std::string(100'000, symbol) + "a");
      FAIL() << "read 100,000 of " << symbol;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("nested at most 200 deep"), std::string::npos);
    }
  }
}

TEST_F(MeshExpression, OperatorsBindAsInPython) {
  // Each pair of readings has volumes of its own, so a wrong precedence cannot pass.
  EXPECT_NEAR(volume_mm3("far | a & b"), 9.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("(far | a) & b"), 8.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("b & a - c"), 7.5, rounding_mm3);
  EXPECT_NEAR(volume_mm3("far - far & a"), 0.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("far - (far & a)"), 1.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("a - b - c"), 55.5, rounding_mm3);
  EXPECT_NEAR(volume_mm3("a - (b - c)"), 56.5, rounding_mm3);
}

TEST_F(MeshExpression, AComplementIsTakenWithinTheWorldAndNoEarlier) {
  EXPECT_NEAR(volume_mm3("~a"), 1000.0 - 64.0, rounding_mm3 * 1000.0);
  EXPECT_NEAR(volume_mm3("b & ~a"), 8.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("~(~a | ~b)"), 8.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("~~a"), 64.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("~a & ~b"), 1000.0 - 72.0, rounding_mm3 * 1000.0);
}

TEST_F(MeshExpression, EqualAndEmptyOperandsNeedNoGeometry) {
  EXPECT_EQ(volume_mm3("a - a"), 0.0);
  EXPECT_NEAR(volume_mm3("a & a"), 64.0, rounding_mm3);
  EXPECT_EQ(volume_mm3("(a - a) & b"), 0.0);
  EXPECT_NEAR(volume_mm3("b | (a - a)"), 16.0, rounding_mm3);
  EXPECT_NEAR(volume_mm3("b - (a & far)"), 16.0, rounding_mm3);
}

TEST_F(MeshExpression, ASolidNamedTwiceLeavesNoSheetOfItself) {
  const auto area = [this](const std::string& text) {
    return meshes_.evaluate(text, [this](std::string_view name) { return solid(name); }).measures().area_mm2;
  };
  // b reaches through one face of a: a - b has a's faces but for a hole of 2 x 2, and a pit of depth 2.
  EXPECT_NEAR(area("a - b"), 96.0 - 4.0 + 4.0 + 4.0 * 4.0, rounding_mm3);
  EXPECT_NEAR(area("a & (a ^ b)"), area("a - b"), rounding_mm3);
  EXPECT_NEAR(area("(a | b) - b"), area("a - b"), rounding_mm3);
  EXPECT_EQ(area("(a ^ b) & (a & b)"), 0.0);
}

TEST_F(MeshExpression, APairIsCorefinedOnceForAllItsResults) {
  const auto names = [this](std::string_view name) { return solid(name); };
  const brep::Solid first = meshes_.evaluate("a - b", names);
  volume_mm3("a & b");
  EXPECT_TRUE(meshes_.evaluate("a - b", names).is_same(first));
}

TEST_F(MeshExpression, ASolidMadeOfOthersMeetsThemInNoSheet) {
  std::map<std::string, std::string, std::less<>> origins{{"piece", "a & b"}, {"rest", "a - piece"}};
  std::map<std::string, brep::Solid, std::less<>> made;
  const auto names = [&](std::string_view name) {
    const auto found = made.find(name);
    return found == made.end() ? solid(name) : found->second;
  };
  const auto origin = [&](std::string_view name) {
    const auto found = origins.find(name);
    return found == origins.end() ? std::string() : found->second;
  };
  const auto answer = [&](const std::string& text) { return meshes_.evaluate(text, names, {}, origin); };
  made.emplace("piece", answer("a & b"));
  const brep::Solid rest = answer("a - piece");
  EXPECT_TRUE(rest.is_same(meshes_.evaluate("a - b", names)));
  EXPECT_TRUE(meshes_.findings().empty());
  made.emplace("rest", rest);
  EXPECT_TRUE(answer("rest & piece").empty());
  EXPECT_TRUE(answer("rest | piece").is_same(a_));
  EXPECT_NEAR(answer("(rest | piece) - c").measures().volume_mm3, 63.0, rounding_mm3);
  // Nothing is shared: the answers that are there serve.
  EXPECT_NEAR(answer("rest - far").measures().volume_mm3, 56.0, rounding_mm3);
  // Functions of more names than are taken apart stay as they are.
  origins.emplace("many", "a | b | c | far | d | e | f");
  made.emplace("many", answer("a | far"));
  EXPECT_NEAR(answer("many - a").measures().volume_mm3, 1.0, rounding_mm3);
}

TEST_F(MeshExpression, AStopIsNoMissingAnswer) {
  std::stop_source stop;
  stop.request_stop();
  const auto names = [this](std::string_view name) { return solid(name); };
  EXPECT_THROW(meshes_.evaluate("a - b", names, stop.get_token()), brep::Stopped);
  EXPECT_NEAR(volume_mm3("a - b"), 56.0, rounding_mm3) << "the next one is not stopped";
}

TEST_F(MeshExpression, SaysWhereAnExpressionGoesWrong) {
  for (const char* text : {"", "a &", "a b", "(a", "& a", "a + b", "a)"}) {
    try {
      volume_mm3(text);
      ADD_FAILURE() << "'" << text << "' was taken";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("position"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(volume_mm3("a & nobody"), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
