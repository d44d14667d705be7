// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/message.h"

#include <gtest/gtest.h>
#include <new>

#include "brep/mesh/error.h"
#include "planner/plan/history.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

TEST(Request, IsAnObjectWithAWord) {
  const Request request = parse_request(R"({"id": 7, "do": "undo", "name": "\"]]]\\"})");
  EXPECT_EQ(request.id, 7);
  EXPECT_EQ(request.what, "undo");
  for (const char* wrong : {"", "{", "[]", "5", "null", "{}", R"({"do": 5})", R"({"id": 1})", "\xff\xfe",
                            R"({"do": "a"} x)", "{\"do\": \"\xff\"}"})
    EXPECT_THROW(parse_request(wrong), voxel::Error) << wrong;
}

TEST(Request, IsRefusedBeforeItsDepthTakesTheStack) {
  std::string nested = R"({"do": "edit", "a": )" + std::string(1 << 20, '[');
  EXPECT_THROW(parse_request(nested), voxel::Error);
  nested =
      R"({"do": "edit", "a": )" + std::string(most_levels - 1, '[') + std::string(most_levels - 1, ']') + "}";
  EXPECT_EQ(parse_request(nested).what, "edit");
  nested = R"({"do": "edit", "a": ")" + std::string(1000, '[') + "\"}";
  EXPECT_EQ(parse_request(nested).what, "edit") << "brackets in a text are none";
}

std::string as_it_is(const std::string& text) {
  return text;
}

std::string code_of(const std::exception& error) {
  return Json::parse(refusal_to(3, error, as_it_is).bytes)["error"]["code"];
}

TEST(Refusal, HasTheCodeOfEitherKernel) {
  EXPECT_EQ(code_of(voxel::Error(voxel::ErrorCode::Geometry, "")), "geometry");
  EXPECT_EQ(code_of(voxel::Stopped("")), "cancelled");
  EXPECT_EQ(code_of(brep::Stopped("")), "cancelled");
  EXPECT_EQ(code_of(brep::Error(brep::ErrorCode::Resource, "")), "resource");
  EXPECT_EQ(code_of(std::bad_alloc()), "resource");
  EXPECT_EQ(code_of(std::runtime_error("")), "input");
  EXPECT_EQ(code_of(OtherWriter("")), "changed") << "the page offers to load the file";
  try {
    (void)Json::object().at("missing");
    FAIL();
  } catch (const std::exception& error) {
    const std::string said = refusal_to(3, error, as_it_is).bytes;
    EXPECT_EQ(said.find("json.exception"), std::string::npos) << said;
  }
}

TEST(Refusal, IsTheLineThatIsMadeOfItsMessage) {
  const auto first_line = [](const std::string& text) { return text.substr(0, text.find('\n')); };
  const Message refusal = refusal_to(3, std::runtime_error("no step 'a\nb'"), first_line);
  EXPECT_EQ(Json::parse(refusal.bytes)["error"]["message"], "no step 'a");
}

TEST(Frame, IsItsHeadersLengthTheHeaderAndThePayloads) {
  const Message frame = packed({{"id", 5}}, {{"png", "abc"}, {"depth", std::string("\0\1", 2)}});
  EXPECT_TRUE(frame.is_binary);
  std::size_t length = 0;
  for (int byte = 3; byte >= 0; --byte)
    length = 256 * length + static_cast<unsigned char>(frame.bytes[static_cast<std::size_t>(byte)]);
  const Json header = Json::parse(frame.bytes.substr(4, length));
  EXPECT_EQ(header["id"], 5);
  EXPECT_EQ(header["parts"], (Json{{{"kind", "png"}, {"bytes", 3}}, {{"kind", "depth"}, {"bytes", 2}}}));
  EXPECT_EQ(frame.bytes.substr(4 + length), std::string("abc\0\1", 5));
}

TEST(Answer, ReplacesBytesThatAreNoText) {
  EXPECT_EQ(Json::parse(answer_to(1, {{"name", "a\xff"}}).bytes)["ok"]["name"], "a\xEF\xBF\xBD");
  EXPECT_EQ(Json::parse(event("plan", {{"a", 1}}).bytes), (Json{{"event", "plan"}, {"a", 1}}));
}

}  // namespace
}  // namespace octotomy::planner::serve
