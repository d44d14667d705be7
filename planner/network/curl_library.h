// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

// Disables macros of the header that check the types of arguments; they work only for direct calls.
#define CURL_DISABLE_TYPECHECK
#include <curl/curl.h>

namespace octotomy::planner {

/// Pointers to the functions of libcurl that DICOMweb needs.
struct CurlLibrary {
  decltype(&curl_global_init) global_init;
  decltype(&curl_version_info) version_info;
  decltype(&curl_easy_init) easy_init;
  decltype(&curl_easy_setopt) easy_setopt;
  decltype(&curl_easy_perform) easy_perform;
  decltype(&curl_easy_getinfo) easy_getinfo;
  decltype(&curl_easy_strerror) easy_strerror;
  decltype(&curl_easy_cleanup) easy_cleanup;
  decltype(&curl_slist_append) slist_append;
  decltype(&curl_slist_free_all) slist_free_all;
};

/// Loads and initialises libcurl at the first call. The program is not linked with it, because loading its
/// about thirty libraries would take a third of the program's start. Throws voxel::Error, Resource, if
/// libcurl is not installed or cannot be initialised. May be called from several threads.
const CurlLibrary& curl_library();

}  // namespace octotomy::planner
