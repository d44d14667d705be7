// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/access_control.h"

#include <algorithm>
#include <fcntl.h>
#include <fstream>
#include <random>
#include <stdexcept>
#include <sys/stat.h>
#include <unistd.h>

#include "voxel/space/file_text.h"

namespace octotomy::planner::serve {
namespace {

int digit_of(char symbol) {
  if (symbol >= '0' && symbol <= '9') return symbol - '0';
  if (symbol >= 'a' && symbol <= 'f') return symbol - 'a' + 10;
  if (symbol >= 'A' && symbol <= 'F') return symbol - 'A' + 10;
  throw std::runtime_error("the address has a percent sign without two hexadecimal digits");
}

std::string decoded(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      plain += text[i];
      continue;
    }
    if (i + 2 >= text.size()) throw std::runtime_error("the address ends within a percent sign's digits");
    plain += static_cast<char>(16 * digit_of(text[i + 1]) + digit_of(text[i + 2]));
    i += 2;
  }
  if (plain.find('\0') != std::string::npos) throw std::runtime_error("the address contains a zero byte");
  return plain;
}

/// Takes the same time wherever two tokens differ, to prevent timing attacks.
bool are_equal(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0u : 1u;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i % b.size()]);
  return difference == 0u;
}

}  // namespace

Target parse_target(std::string_view text) {
  Target target;
  const std::size_t mark = text.find('?');
  target.path = decoded(text.substr(0, mark));
  if (mark == std::string_view::npos) return target;
  text.remove_prefix(mark + 1);
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find('&'));
    text.remove_prefix(std::min(text.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    target.query[decoded(pair.substr(0, equals))] =
        equals == std::string_view::npos ? "" : decoded(pair.substr(equals + 1));
  }
  return target;
}

std::optional<FileTarget> file_of(const Target& target) {
  const std::string place = "/file/";
  if (!target.path.starts_with(place)) return {};
  const std::string rest = target.path.substr(place.size());
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos) return FileTarget{"", rest};
  return FileTarget{rest.substr(0, slash), rest.substr(slash + 1)};
}

std::string new_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 32; ++i) token += "0123456789abcdef"[device() % 16];
  return token;
}

std::string token_in(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  constexpr fs::perms of_others = fs::perms::group_all | fs::perms::others_all;
  if (!fs::exists(path)) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
    const std::string token = new_token();
    const bool is_written =
        file >= 0 && ::write(file, token.data(), token.size()) == static_cast<ssize_t>(token.size());
    if (file >= 0) ::close(file);
    if (!is_written) throw std::runtime_error(path.string() + ": cannot be written");
    return token;
  }
  if ((fs::status(path).permissions() & of_others) != fs::perms::none)
    throw std::runtime_error(path.string() + ": others may read this token: chmod 600, or name a new file");
  std::ifstream file = voxel::opened(path);
  std::string token;
  file >> token;
  constexpr std::size_t least_length = 32;
  if (token.size() < least_length || token.find_first_not_of("0123456789abcdef") != std::string::npos)
    throw std::runtime_error(path.string() + ": contains no token: name a file that does not exist yet");
  return token;
}

std::optional<std::string> AccessControl::refusal_of_host(const Caller& caller) const {
  if (hosts_.empty() || std::find(hosts_.begin(), hosts_.end(), caller.host) != hosts_.end()) return {};
  return "this server is not called '" + caller.host + "': open the address that it printed";
}

std::optional<Access> AccessControl::access_of(const Caller& caller) const {
  if (are_equal(caller.token, token_)) return Access::Edit;
  if (view_token_ && are_equal(caller.token, *view_token_)) return Access::View;
  return {};
}

std::optional<std::string> AccessControl::refusal(const Caller& caller, Access needed) const {
  if (auto why = refusal_of_host(caller)) return why;
  if (!caller.origin.empty() && caller.origin != "http://" + caller.host)
    return "the request comes from a page of another site: open the address that the server printed";
  const std::optional<Access> access = access_of(caller);
  if (!access) return "the address lacks the server's token: open the address that the server printed";
  if (needed == Access::Edit && *access == Access::View)
    return "this address only shows the plan: files are neither sent nor received here";
  return {};
}

std::optional<std::string> AccessControl::refusal_of_action(const Caller& caller, Access needed) const {
  if (auto why = refusal(caller, needed)) return why;
  if (caller.origin.empty()) return "the request has no Origin header";
  return {};
}

}  // namespace octotomy::planner::serve
