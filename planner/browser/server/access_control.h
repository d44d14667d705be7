// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Access control of the server: it answers only pages that were opened with its token.
namespace octotomy::planner::serve {

/// A request's target: "/file/a%20b.stl?token=1" is the path "/file/a b.stl" and the query token = 1.
struct Target {
  std::string path;
  std::map<std::string, std::string> query;
};
/// Throws std::runtime_error if a percent sign is not followed by two hexadecimal digits, or a decoded byte
/// is 0.
Target parse_target(std::string_view text);

/// A target such as "/file/TOKEN/report/report.html": the token, and the output file's name,
/// "report/report.html". The token is in the path, so that relative links within a report reach the files
/// beside it. file_of() returns none for any other target.
struct FileTarget {
  std::string token, name;
};
std::optional<FileTarget> file_of(const Target& target);

/// The headers of a request that identify its sender; empty if absent.
struct Caller {
  std::string host, origin, token;
};

/// A new random token: 128 bits in hexadecimal.
std::string new_token();
/// Reads the token in a file that only its owner may read. If there is no such file, writes a new token into
/// it. A restarted server with the same file accepts pages of the earlier one. Throws std::runtime_error if
/// others may read the file, or if it contains no token.
std::string token_in(const std::filesystem::path& path);

/// What a token allows: to change the plan and to name files, or only to look at the open plan.
enum class Access { Edit, View };

/// Checks whether a request comes from a page of this server. A page of another site can make a browser send
/// requests to this machine, even under a host name of that site. Such a request lacks the token, and its
/// Host or Origin differs.
class AccessControl {
 public:
  /// `hosts` are the accepted values of the Host header, such as "127.0.0.1:8080". If there are none, every
  /// value is accepted, for a server that listens on all interfaces. `view_token` is the token of windows
  /// that only show the plan. Without it, there are no such windows.
  AccessControl(std::string token, std::vector<std::string> hosts, std::optional<std::string> view_token = {})
      : token_(std::move(token)), hosts_(std::move(hosts)), view_token_(std::move(view_token)) {}

  const std::string& token() const { return token_; }
  /// What the caller's token allows; none if it is no token of this server.
  std::optional<Access> access_of(const Caller& caller) const;
  /// The reason to refuse a file of the page itself, for which a right Host is enough, because the file
  /// contains nothing private. None: accepted.
  std::optional<std::string> refusal_of_host(const Caller& caller) const;
  /// The reason to refuse a request that needs the access `needed`: Host or token is wrong, the token allows
  /// less, or the Origin differs from the Host. None: accepted.
  std::optional<std::string> refusal(const Caller& caller, Access needed) const;
  /// As refusal(), for requests that open a socket or send a file: an absent Origin is refused, too.
  std::optional<std::string> refusal_of_action(const Caller& caller, Access needed) const;

 private:
  std::string token_;
  std::vector<std::string> hosts_;
  std::optional<std::string> view_token_;
};

}  // namespace octotomy::planner::serve
