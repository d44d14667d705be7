// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/json_file.h"

#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::planner {
namespace {

std::string nested(std::size_t levels) {
  return std::string(levels, '[') + std::string(levels, ']');
}

template <typename AnyJson>
std::string refusal(const std::string& text) {
  try {
    parse_json<AnyJson>(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "taken";
}

template <typename AnyJson>
class JsonText : public testing::Test {};
using AnyJsons = testing::Types<SortedJson, Json>;
TYPED_TEST_SUITE(JsonText, AnyJsons);

TYPED_TEST(JsonText, IsRefusedBeforeItsDepthTakesTheStack) {
  const std::string too_deep = "is nested more than 512 deep";
  EXPECT_EQ(refusal<TypeParam>(nested(512)), "taken");
  EXPECT_EQ(refusal<TypeParam>(nested(513)), too_deep);
  EXPECT_EQ(refusal<TypeParam>(nested(1'000'000)), too_deep);
  EXPECT_EQ(refusal<TypeParam>(std::string(1'000'000, '[')), too_deep);
  std::string objects;
  for (int level = 0; level < 100'000; ++level) objects += R"({"a":)";
  EXPECT_EQ(refusal<TypeParam>(objects), too_deep);
}

TYPED_TEST(JsonText, CountsNoBracketsInTextsAndNoneThatAreClosed) {
  EXPECT_EQ(refusal<TypeParam>('"' + std::string(1000, '[') + '"'), "taken");
  EXPECT_EQ(refusal<TypeParam>(R"(["a \" )" + std::string(1000, '[') + R"(", "\\"])"), "taken");
  std::string flat = "[";
  for (int i = 0; i < 1000; ++i) flat += "[{}],";
  EXPECT_EQ(refusal<TypeParam>(flat + "0]"), "taken");
  EXPECT_NE(refusal<TypeParam>("[1,").find("is no JSON"), std::string::npos);
}

TYPED_TEST(JsonText, HasAKeyOnceInAnObject) {
  EXPECT_EQ(refusal<TypeParam>(R"({"a": {"b": 1}, "c": [{"b": 2}, {"b": 3, "a": 4}]})"), "taken");
  for (const char* doubled : {R"({"b": 1, "a": 2, "b": 3})", R"([{"a": {"b": 1, "b": 1}}])"})
    EXPECT_EQ(refusal<TypeParam>(doubled), "the key 'b' occurs twice in one object: delete one of them");
}

TYPED_TEST(JsonText, IsNotQuotedWhereItIsNone) {
  for (const char* secret : {"root:x:0:0", "[1, secret]", R"({"a": "secret)", R"({"a" "secret"})"}) {
    const std::string said = refusal<TypeParam>(secret);
    EXPECT_NE(said.find("line 1, column"), std::string::npos) << said;
    for (const char* quoted : {"last read", "secret", "'r'"})
      EXPECT_EQ(said.find(quoted), std::string::npos) << said;
  }
}

TEST(JsonFile, ThatIsTooDeepIsNamed) {
  const tests::ScratchFolder folder;
  const std::filesystem::path path = folder / "deep.json";
  tests::write_bytes(path, nested(100'000));
  try {
    read_json(path);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), path.string() + ": is nested more than 512 deep");
  }
}

}  // namespace
}  // namespace octotomy::planner
