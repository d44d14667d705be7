// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Access control of the server: only pages that were opened with the token.
namespace octotomy::planner::serve {

/// A request's target: "/file/a%20b.stl?token=1" is the path "/file/a b.stl" and the query token = 1.
struct Target {
  std::string path;
  std::map<std::string, std::string> query;
};
/// Throws std::runtime_error if a percent sign is not followed by two hexadecimal digits, or a byte is 0.
Target parse_target(std::string_view text);

/// The output file of the target "/file/TOKEN/report/report.html". The token is in the path, so that relative
/// links within the report reach the files beside it. None for any other target.
struct FileTarget {
  std::string token, name;
};
std::optional<FileTarget> file_of(const Target& target);

/// The headers of a request that identify its sender; empty if absent.
struct Caller {
  std::string host, origin, token;
};

/// 128 random bits in hexadecimal.
std::string new_token();
/// The token in a file that only its owner may read, or a new one that is written there. With it, a restarted
/// server accepts pages of the earlier one. Throws std::runtime_error if others may read the file, or it
/// contains no token.
std::string token_in(const std::filesystem::path& path);

/// What a token allows: to change the plan and to name files, or only to look at the open plan.
enum class Access { Edit, View };

/// Checks requests. A page of another site can make a browser send requests here, even under its own name for
/// this machine; it does not have the token, and its Host or Origin differs.
class AccessControl {
 public:
  /// `hosts` are the accepted values of the Host header: "127.0.0.1:8080". Empty: any, for a server that
  /// listens on all interfaces. `view_token` is that of pages that may only look; none: there are no such
  /// pages.
  AccessControl(std::string token, std::vector<std::string> hosts, std::optional<std::string> view_token = {})
      : token_(std::move(token)), hosts_(std::move(hosts)), view_token_(std::move(view_token)) {}

  const std::string& token() const { return token_; }
  /// What the caller's token allows; none if it is no token of this server.
  std::optional<Access> access_of(const Caller& caller) const;
  /// The reason to refuse a file of the page itself, which contains nothing private; none: accepted.
  std::optional<std::string> refusal_of_host(const Caller& caller) const;
  /// The reason to refuse a page that needs `needed`: Host or token is wrong, the token allows less, or the
  /// page's Origin differs from its Host.
  std::optional<std::string> refusal(const Caller& caller, Access needed) const;
  /// The reason to refuse a request that opens a socket or sends a file. As refusal(), but an absent Origin is
  /// refused too.
  std::optional<std::string> refusal_of_action(const Caller& caller, Access needed) const;

 private:
  std::string token_;
  std::vector<std::string> hosts_;
  std::optional<std::string> view_token_;
};

}  // namespace octotomy::planner::serve
