// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/network/dicom_web.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <memory>
#include <string_view>

#include "planner/network/curl_library.h"
#include "planner/network/multipart.h"
#include "voxel/space/error.h"
#include "voxel/space/progress.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_answer = 16 << 20, most_reason = 1 << 16, most_header_lines = 1 << 18;

/// One HTTP request. An exception of a callback ends the request; run() rethrows it.
class Request {
 public:
  Request(const WebArchive& archive, const std::string& path, const std::stop_token& stop)
      : archive_(archive), url_(archive.url + (archive.url.ends_with('/') ? "" : "/") + path), stop_(stop) {
    if (!handle_) throw voxel::Error(voxel::ErrorCode::Resource, "libcurl has no memory for a request");
    set(CURLOPT_URL, url_.c_str());
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_FOLLOWLOCATION, 0L);
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_CONNECTTIMEOUT, archive.timeout_s);
    set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    set(CURLOPT_LOW_SPEED_TIME, archive.timeout_s);
    set(CURLOPT_SSLVERSION, static_cast<long>(CURL_SSLVERSION_TLSv1_2));
    set(CURLOPT_USERAGENT, "octotomy/" OCTOTOMY_VERSION);
    if (!archive.user.empty()) set(CURLOPT_USERPWD, archive.user.c_str());
    if (archive.tls && !archive.tls->authorities.empty())
      set(CURLOPT_CAINFO, archive.tls->authorities.c_str());
    if (archive.tls && !archive.tls->certificate.empty())
      set(CURLOPT_SSLCERT, archive.tls->certificate.c_str());
    if (archive.tls && !archive.tls->key.empty()) set(CURLOPT_SSLKEY, archive.tls->key.c_str());
    set(CURLOPT_ERRORBUFFER, error_.data());
    set(CURLOPT_WRITEFUNCTION, &Request::take);
    set(CURLOPT_WRITEDATA, this);
    set(CURLOPT_HEADERFUNCTION, &Request::take_header);
    set(CURLOPT_HEADERDATA, this);
    set(CURLOPT_NOPROGRESS, 0L);
    set(CURLOPT_XFERINFOFUNCTION, &Request::is_stopped);
    set(CURLOPT_XFERINFODATA, this);
  }

  void add_header(const std::string& line) {
    headers_.reset(curl_.slist_append(headers_.release(), line.c_str()));
    set(CURLOPT_HTTPHEADER, headers_.get());
  }
  /// Makes this a POST request with a body of `bytes` bytes. `body` writes the next bytes into a buffer and
  /// returns their number.
  void post(std::uint64_t bytes, std::function<std::size_t(char*, std::size_t)> body) {
    body_ = std::move(body);
    set(CURLOPT_POST, 1L);
    set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(bytes));
    set(CURLOPT_READFUNCTION, &Request::give);
    set(CURLOPT_READDATA, this);
    add_header("Expect:");
  }

  /// Sends the request and returns the status of the answer. If that is 200, passes the answer's body to
  /// `answer`; otherwise reason() returns its text.
  long run(const std::function<void(const std::string& type, std::string_view bytes)>& answer) {
    answer_ = &answer;
    const CURLcode code = curl_.easy_perform(handle_.get());
    if (thrown_) std::rethrow_exception(thrown_);
    if (stop_.stop_requested()) throw voxel::Stopped("stopped during a request to " + archive_.url);
    if (code != CURLE_OK)
      throw PeerError(archive_.url + ": " +
                      (error_.front() != '\0' ? error_.data() : curl_.easy_strerror(code)));
    return status();
  }
  long status() const {
    long number = 0;
    curl_.easy_getinfo(handle_.get(), CURLINFO_RESPONSE_CODE, &number);
    return number;
  }
  /// The beginning of the text that came with another status than 200, as one line of printable characters.
  std::string reason() const {
    std::string text = reason_.substr(0, 200);
    for (char& c : text)
      if (c < ' ' || c > '~') c = ' ';
    return text;
  }

 private:
  template <typename Value>
  void set(CURLoption option, Value value) {
    // An option that an older libcurl does not support is an error, because the safety of the request may
    // depend on it.
    if (const CURLcode code = curl_.easy_setopt(handle_.get(), option, value); code != CURLE_OK)
      throw voxel::Error(voxel::ErrorCode::Resource, "libcurl refuses option " + std::to_string(option) +
                                                         ": " + curl_.easy_strerror(code) +
                                                         "; install version 7.85 or later");
  }

  static std::size_t take(char* bytes, std::size_t, std::size_t count, void* self) {
    auto& request = *static_cast<Request*>(self);
    try {
      if (request.status() != 200) {
        request.reason_.append(bytes,
                               std::min(count, most_reason - std::min(most_reason, request.reason_.size())));
        return request.reason_.size() < most_reason ? count : 0;
      }
      const char* type = nullptr;
      request.curl_.easy_getinfo(request.handle_.get(), CURLINFO_CONTENT_TYPE, &type);
      (*request.answer_)(type == nullptr ? "" : type, {bytes, count});
      return count;
    } catch (...) {
      request.thrown_ = std::current_exception();
      return 0;
    }
  }
  /// Limits the size of header lines, because libcurl stores all of them.
  static std::size_t take_header(char*, std::size_t, std::size_t count, void* self) {
    auto& request = *static_cast<Request*>(self);
    request.header_bytes_ += count;
    if (request.header_bytes_ <= most_header_lines) return count;
    request.thrown_ = std::make_exception_ptr(
        PeerError(request.archive_.url + ": answers more than 256 KB of header lines: is it an archive?"));
    return 0;
  }
  static std::size_t give(char* to, std::size_t, std::size_t count, void* self) {
    auto& request = *static_cast<Request*>(self);
    try {
      return request.body_(to, count);
    } catch (...) {
      request.thrown_ = std::current_exception();
      return CURL_READFUNC_ABORT;
    }
  }
  static int is_stopped(void* self, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
    return static_cast<Request*>(self)->stop_.stop_requested() ? 1 : 0;
  }

  const WebArchive& archive_;
  std::string url_;
  std::stop_token stop_;
  const CurlLibrary& curl_ = curl_library();
  std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> handle_{curl_.easy_init(), curl_.easy_cleanup};
  std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> headers_{nullptr, curl_.slist_free_all};
  std::array<char, CURL_ERROR_SIZE> error_{};
  std::function<std::size_t(char*, std::size_t)> body_;
  const std::function<void(const std::string&, std::string_view)>* answer_ = nullptr;
  std::string reason_;
  std::size_t header_bytes_ = 0;
  std::exception_ptr thrown_;
};

[[noreturn]] void refuse(const std::string& what, long status, const std::string& reason) {
  throw PeerError(what + ": the archive answers status " + std::to_string(status) +
                  (reason.empty() ? "" : ": " + reason));
}

/// The body of a request: a text, a file and a second text, one after the other.
class FileBody {
 public:
  FileBody(std::string before, const fs::path& path, std::string after)
      : before_(std::move(before)), after_(std::move(after)), path_(path), file_(path, std::ios::binary) {
    if (!file_) throw std::runtime_error(path.string() + ": cannot be read");
    left_ = fs::file_size(path);
    bytes_ = before_.size() + left_ + after_.size();
  }
  std::uint64_t bytes() const { return bytes_; }
  std::size_t read(char* to, std::size_t count) {
    if (!before_.empty()) return text(before_, to, count);
    if (left_ == 0) return text(after_, to, count);
    const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(count, left_));
    if (!file_.read(to, static_cast<std::streamsize>(now)))
      throw std::runtime_error(path_.string() + ": cannot be read to its end");
    left_ -= now;
    return now;
  }

 private:
  static std::size_t text(std::string& from, char* to, std::size_t count) {
    const std::size_t now = from.copy(to, count);
    from.erase(0, now);
    return now;
  }
  std::string before_, after_;
  fs::path path_;
  std::ifstream file_;
  std::uint64_t left_ = 0, bytes_ = 0;
};

}  // namespace

void store_by_web(const WebArchive& archive, const fs::path& path, const std::stop_token& stop) {
  // The text that separates the parts of a body. A DICOM file that contains it would be damaged on arrival.
  // Only its sender could have put it there.
  const std::string boundary = "octotomy-4c7e1f0a9b2d4e58a1c36b7790de5f42";
  FileBody body("--" + boundary + "\r\nContent-Type: application/dicom\r\n\r\n", path,
                "\r\n--" + boundary + "--\r\n");
  Request request(archive, "studies", stop);
  request.add_header("Content-Type: multipart/related; type=\"application/dicom\"; boundary=" + boundary);
  request.add_header("Accept: application/dicom+json");
  request.post(body.bytes(), [&](char* to, std::size_t count) { return body.read(to, count); });
  std::string said;
  const long status = request.run([&](const std::string&, std::string_view bytes) {
    if (said.size() + bytes.size() > most_answer) throw PeerError(archive.url + ": its answer exceeds 16 MB");
    said.append(bytes);
  });
  // The tag 00081197 lists instances that were not stored, with the reason (PS3.18, I.2).
  if (status != 200 || said.find("00081197") != std::string::npos)
    refuse(path.string() + ": not stored", status, status == 200 ? said.substr(0, 200) : request.reason());
}

std::string search_by_web(const WebArchive& archive, const std::string& query, const std::stop_token& stop) {
  Request request(archive, query, stop);
  request.add_header("Accept: application/dicom+json");
  std::string found;
  const long status = request.run([&](const std::string&, std::string_view bytes) {
    if (found.size() + bytes.size() > most_answer)
      throw PeerError(archive.url + ": its answer exceeds 16 MB");
    found.append(bytes);
  });
  if (status == 204) return "[]";  // nothing was found
  if (status != 200) refuse(archive.url, status, request.reason());
  return found;
}

void retrieve_by_web(const WebArchive& archive, const std::string& resource, ReceivedFiles& folder,
                     const std::stop_token& stop) {
  Request request(archive, resource, stop);
  request.add_header("Accept: multipart/related; type=\"application/dicom\"; transfer-syntax=*");
  std::optional<Multipart> parts;
  const long status = request.run([&](const std::string& type, std::string_view bytes) {
    if (!parts) parts.emplace(type, folder);
    parts->add(bytes);
  });
  if (status != 200) refuse(archive.url + ", " + resource, status, request.reason());
  if (!parts) throw PeerError(archive.url + ": sends an empty answer");
  parts->finish();
}

std::string web_text(const std::string& text) {
  std::string made;
  for (const unsigned char c : text)
    if (std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_' || c == '~' || c == '*' || c == '?') {
      made += static_cast<char>(c);
    } else {
      std::array<char, 4> coded{};
      std::snprintf(coded.data(), coded.size(), "%%%02X", c);
      made += coded.data();
    }
  return made;
}

}  // namespace octotomy::planner
