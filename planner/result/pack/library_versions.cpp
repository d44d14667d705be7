// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/library_versions.h"

#include <CGAL/version.h>
#include <OpenMesh/Core/System/config.h>
#include <expat.h>
#include <glm/glm.hpp>
#include <openssl/crypto.h>
#include <sqlite3.h>
#include <string>
#include <tbb/version.h>
#include <zlib.h>

namespace octotomy::planner {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace

nlohmann::ordered_json library_versions() {
  const XML_Expat_Version expat = XML_ExpatVersionInfo();
  return {{"CGAL", CGAL_VERSION_STR},
          {"Expat", dotted(expat.major, expat.minor, expat.micro)},
          {"GLM", dotted(GLM_VERSION_MAJOR, GLM_VERSION_MINOR, GLM_VERSION_PATCH)},
          {"nlohmann_json",
           dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
          {"OpenMesh", dotted(OM_GET_VER, OM_GET_MAJ, OM_GET_MIN)},
          {"OpenSSL", OpenSSL_version(OPENSSL_VERSION_STRING)},
          {"SQLite", sqlite3_libversion()},
          {"TBB", TBB_runtime_version()},
          {"zlib", zlibVersion()}};
}

}  // namespace octotomy::planner
