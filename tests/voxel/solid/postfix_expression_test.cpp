// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/postfix_expression.h"

#include <gtest/gtest.h>
#include <map>
#include <random>
#include <string>

namespace octotomy::voxel {
namespace {

/// Objects a to f: half-spaces, told apart by their offset.
class Steps : public testing::Test {
 protected:
  Expression parsed(const std::string& text) {
    Names names;
    names.object = [this](std::string_view name) {
      const std::string key(name);
      if (!objects_.contains(key))
        objects_.emplace(key, HalfSpace{{0, 0, 1}, static_cast<double>(objects_.size())});
      return objects_.at(key);
    };
    names.motion = [](std::string_view) {
      glm::dmat4 shift(1.0);
      shift[3][0] = 1.0;
      return shift;
    };
    return parse_expression(text, names);
  }
  std::size_t count(const std::string& text) { return postfix_of(parsed(text)).steps.size(); }

  std::map<std::string, Expression> objects_;
};

TEST_F(Steps, ARowTakesEachOperandOnce) {
  EXPECT_EQ(count("a"), 1u);
  EXPECT_EQ(count("a | b"), 3u);
  EXPECT_EQ(count("a | b | a | b | b"), 3u);
  EXPECT_EQ(count("a & b & (b & a)"), 7u) << "(b & a) is another value than a & b";
  EXPECT_EQ(count("(a | b) & (a | b)"), 3u);
  EXPECT_EQ(count("a - b - b - c - b"), 5u);
  EXPECT_EQ(count("~a | b | ~a"), 4u);
  EXPECT_EQ(count("move(a, m) | move(a, m)"), 1u);
}

TEST_F(Steps, WhatIsNoRepetitionStays) {
  EXPECT_EQ(count("a ^ a ^ a"), 5u);
  EXPECT_EQ(count("a - a"), 3u);
  EXPECT_EQ(count("a - b | b"), 5u);
  EXPECT_EQ(count("(a | b) & a"), 5u);
  EXPECT_EQ(count("move(a, m) | a"), 3u);
}

TEST_F(Steps, GrowWithDistinctOperandsNotWithTheTextsLength) {
  std::string text = "a";
  for (int i = 0; i < 50000; ++i) text += std::string(" | ") + static_cast<char>('a' + i % 6);
  EXPECT_EQ(count(text), 11u);
}

/// The value of a text by its own rules, without postfix_of().
std::uint64_t value_of(const std::string& text, const std::map<char, std::uint64_t>& values) {
  std::uint64_t value = values.at(text[0]);
  for (std::size_t i = 1; i + 1 < text.size(); i += 2) {
    const std::uint64_t next = values.at(text[i + 1]);
    value = text[i] == '|' ? value | next : text[i] == '&' ? value & next : value & ~next;
  }
  return value;
}

TEST_F(Steps, AreWorthWhatTheExpressionIsWorth) {
  std::map<char, std::uint64_t> values;
  std::mt19937_64 random(1);
  for (char name = 'a'; name <= 'd'; ++name) values[name] = random();
  int shortened = 0;
  for (int round = 0; round < 300; ++round) {
    // One operator a text: rows are read from the left.
    const char symbol = "|&-"[random() % 3];
    std::string text(1, static_cast<char>('a' + random() % 4));
    for (int i = 0; i < 6; ++i) (text += symbol) += static_cast<char>('a' + random() % 4);
    const Expression expression = parsed(text);
    const PostfixExpression postfix = postfix_of(expression);
    shortened += postfix.steps.size() < text.size();
    std::vector<std::uint64_t> stack(postfix.stack_size);
    const std::uint64_t got = postfix.run<std::uint64_t>(
        [&](std::uint32_t i) {
          for (const auto& [name, object] : objects_)
            if (std::get<HalfSpace>(*postfix.operands[i].leaf).offset_mm ==
                std::get<HalfSpace>(*postfix_of(object).operands[0].leaf).offset_mm)
              return values.at(name[0]);
          return std::uint64_t{0};
        },
        stack.data());
    ASSERT_EQ(got, value_of(text, values)) << text;
  }
  EXPECT_GT(shortened, 200);
}

}  // namespace
}  // namespace octotomy::voxel
