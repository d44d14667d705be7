// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/access_control.h"

#include <fstream>
#include <gtest/gtest.h>
#include <set>

#include "tests/planner/ball_scan.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

const AccessControl access("0123", {"127.0.0.1:80", "localhost:80"});

TEST(AccessControl, LetsItsOwnPageInAndNoOther) {
  const Caller own{"127.0.0.1:80", "http://127.0.0.1:80", "0123"};
  EXPECT_FALSE(access.refusal_of_action(own, Access::Edit));
  for (const Caller& wrong :
       {Caller{"evil.example:80", "http://evil.example:80", "0123"},
        Caller{"127.0.0.1:80", "http://evil.example", "0123"},
        Caller{"127.0.0.1:80", "http://localhost:80", "0123"}, Caller{"127.0.0.1:80", "null", "0123"},
        Caller{"127.0.0.1:80", "", "0123"}, Caller{"", "http://", "0123"}, Caller{own.host, own.origin, ""},
        Caller{own.host, own.origin, "012"}, Caller{own.host, own.origin, "01230"},
        Caller{own.host, own.origin, "0124"}})
    EXPECT_TRUE(access.refusal_of_action(wrong, Access::Edit))
        << wrong.host << " " << wrong.origin << " " << wrong.token;
}

TEST(AccessControl, ABrowserSaysNoOriginWhenItOpensThePage) {
  EXPECT_FALSE(access.refusal({"localhost:80", "", "0123"}, Access::Edit));
  EXPECT_TRUE(access.refusal({"localhost:80", "http://evil.example", "0123"}, Access::Edit));
  EXPECT_TRUE(access.refusal({"localhost:80", "", "4567"}, Access::Edit));
  EXPECT_FALSE(access.refusal_of_host({"localhost:80", "", ""}));
  EXPECT_TRUE(access.refusal_of_host({"localhost:81", "", ""}));
}

TEST(AccessControl, AViewTokenOpensThePageAndItsSocketAndNoMore) {
  const AccessControl shared("0123", {"localhost:80"}, "4567");
  const Caller viewer{"localhost:80", "http://localhost:80", "4567"};
  const Caller editor{"localhost:80", "http://localhost:80", "0123"};
  EXPECT_FALSE(shared.refusal(viewer, Access::View));
  EXPECT_FALSE(shared.refusal_of_action(viewer, Access::View));
  EXPECT_TRUE(shared.refusal(viewer, Access::Edit));
  EXPECT_TRUE(shared.refusal_of_action(viewer, Access::Edit));
  EXPECT_FALSE(shared.refusal_of_action(editor, Access::View));
  EXPECT_FALSE(shared.refusal_of_action(editor, Access::Edit));
  EXPECT_EQ(shared.access_of(viewer), Access::View);
  EXPECT_EQ(shared.access_of(editor), Access::Edit);
  // Without a view token, no other token is one, not even an empty one.
  for (const char* token : {"", "4567"})
    EXPECT_FALSE(access.access_of({"localhost:80", "http://localhost:80", token})) << token;
  EXPECT_TRUE(shared.refusal({"localhost:80", "", ""}, Access::View));
}

TEST(AccessControl, AFileIsNamedBehindTheTokenSoThatItsLinksKeepIt) {
  const auto file = file_of(parse_target("/file/0123/report/a%20b.html"));
  ASSERT_TRUE(file);
  EXPECT_EQ(file->token, "0123");
  EXPECT_EQ(file->name, "report/a b.html");
  EXPECT_TRUE(
      access.refusal({"localhost:80", "", file_of(parse_target("/file/a.stl"))->token}, Access::Edit));
  EXPECT_TRUE(access.refusal({"localhost:80", "", file_of(parse_target("/file//a.stl?token=0123"))->token},
                             Access::Edit));
  EXPECT_FALSE(file_of(parse_target("/index.html")));
}

TEST(AccessControl, TokensAreLongAndDiffer) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(new_token());
  EXPECT_EQ(tokens.size(), 100u);
  EXPECT_EQ(tokens.begin()->size(), 32u);
}

TEST(AccessControl, ATokenFileIsItsOwnersAlone) {
  const tests::ScratchFolder folder;
  const fs::path path = folder / "token";
  const std::string token = token_in(path);
  EXPECT_EQ(token_in(path), token);
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  fs::permissions(path, fs::perms::group_read, fs::perm_options::add);
  EXPECT_THROW(token_in(path), std::runtime_error);
  fs::permissions(path, fs::perms::group_read, fs::perm_options::remove);
  std::ofstream(path) << "short";
  EXPECT_THROW(token_in(path), std::runtime_error);
  EXPECT_THROW(token_in(path / "in_no_folder"), std::runtime_error);
}

TEST(Target, IsPathAndQueryWithoutPercentSigns) {
  const Target target = parse_target("/file/a%20b%2fc.stl?token=1&name=x%26y&empty=&alone");
  EXPECT_EQ(target.path, "/file/a b/c.stl");
  EXPECT_EQ(target.query, (std::map<std::string, std::string>{
                              {"token", "1"}, {"name", "x&y"}, {"empty", ""}, {"alone", ""}}));
  EXPECT_EQ(parse_target("").path, "");
  for (const char* wrong : {"/%", "/%2", "/%zz", "/a?b=%", "/%00", "/a?b%00=1"})
    EXPECT_THROW(parse_target(wrong), std::runtime_error) << wrong;
}

}  // namespace
}  // namespace octotomy::planner::serve
