// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/network/curl_library.h"

#include <dlfcn.h>
#include <string>

#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

/// The file name of libcurl with version 4 of its binary interface, which has been stable since 2006.
constexpr const char* file_name = "libcurl.so.4";

[[noreturn]] void refuse_library(const std::string& what) {
  throw voxel::Error(voxel::ErrorCode::Resource, std::string("DICOMweb needs ") + file_name + ", " + what +
                                                     ": install Debian's libcurl4");
}

template <typename Function>
void find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr) refuse_library(std::string("which lacks ") + name);
}

/// libcurl is never unloaded: libraries that it loads register functions that run when the program ends.
CurlLibrary loaded() {
  void* const library = dlopen(file_name, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) refuse_library(std::string("which cannot be loaded (") + dlerror() + ")");
  CurlLibrary curl{};
  find(library, "curl_global_init", curl.global_init);
  find(library, "curl_version_info", curl.version_info);
  find(library, "curl_easy_init", curl.easy_init);
  find(library, "curl_easy_setopt", curl.easy_setopt);
  find(library, "curl_easy_perform", curl.easy_perform);
  find(library, "curl_easy_getinfo", curl.easy_getinfo);
  find(library, "curl_easy_strerror", curl.easy_strerror);
  find(library, "curl_easy_cleanup", curl.easy_cleanup);
  find(library, "curl_slist_append", curl.slist_append);
  find(library, "curl_slist_free_all", curl.slist_free_all);
  if (curl.global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) refuse_library("which cannot be started");
  return curl;
}

}  // namespace

const CurlLibrary& curl_library() {
  static const CurlLibrary library = loaded();
  return library;
}

}  // namespace octotomy::planner
