// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/library_versions.h"

#include <CGAL/version.h>
#include <OpenMesh/Core/System/config.h>
#include <boost/version.hpp>
#include <dlfcn.h>
#include <expat.h>
#include <glm/glm.hpp>
#include <gmp.h>
#include <isa-l.h>
#include <itkVersion.h>
#include <lz4.h>
#include <mpfr.h>
#include <openssl/crypto.h>
#include <sqlite3.h>
#include <string>
#include <tbb/version.h>
#include <utility>
#include <zlib.h>
#include <zstd.h>

#include "voxel/dicom/dicom_codec.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

/// The version text of a shared library, which `ask` obtains from one of the library's functions. Empty if
/// the library is not loaded. `file` is its file name, including the version of its interface.
template <typename Version, typename Ask>
std::string loaded_version(const char* file, const char* function, const Ask& ask) {
  void* const library = dlopen(file, RTLD_LAZY | RTLD_NOLOAD);
  if (library == nullptr) return "";
  void* const found = dlsym(library, function);
  std::string answer = found == nullptr ? "" : ask(reinterpret_cast<Version*>(found));
  dlclose(library);
  return answer;
}

/// Adds libtiff and libpng, which OpenImageIO uses, if they are loaded with these interfaces.
void add_picture_libraries(nlohmann::ordered_json& versions) {
  // the text begins with "LIBTIFF, Version 4.5.0"
  const std::string tiff = loaded_version<const char*()>("libtiff.so.6", "TIFFGetVersion",
                                                         [](auto* ask) { return std::string(ask()); });
  const std::size_t digits = tiff.find_first_of("0123456789");
  if (digits != std::string::npos)
    versions["libtiff"] = tiff.substr(digits, tiff.find_first_not_of("0123456789.", digits) - digits);
  const std::string png = loaded_version<const char*(const void*)>(
      "libpng16.so.16", "png_get_libpng_ver", [](auto* ask) { return std::string(ask(nullptr)); });
  if (!png.empty()) versions["libpng"] = png;
}

/// Adds the libraries of the process that decodes DICOM, and those of the picture reader, which is loaded
/// only when needed. Leaves them out if this part of the installation is missing; `verify --self` reports
/// that.
void add_parts(nlohmann::ordered_json& versions) {
  try {
    for (const auto& [name, version] : voxel::codec_facts().libraries) versions[name] = version;
  } catch (const voxel::Error&) {
  }
  try {
    versions["OpenImageIO"] = voxel::image_library_version();
    add_picture_libraries(versions);
  } catch (const voxel::Error&) {
  }
}

}  // namespace

nlohmann::ordered_json library_versions() {
  const XML_Expat_Version expat = XML_ExpatVersionInfo();
  nlohmann::ordered_json versions = {
      {"Boost", dotted(BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100)},
      {"CGAL", CGAL_VERSION_STR},
      {"Expat", dotted(expat.major, expat.minor, expat.micro)},
      {"GLM", dotted(GLM_VERSION_MAJOR, GLM_VERSION_MINOR, GLM_VERSION_PATCH)},
      {"GMP", gmp_version},
      {"ISA-L", dotted(ISAL_MAJOR_VERSION, ISAL_MINOR_VERSION, ISAL_PATCH_VERSION)},
      {"ITK", itk::Version::GetITKVersion()},
      {"LZ4", LZ4_versionString()},
      {"MPFR", mpfr_get_version()},
      {"nlohmann_json",
       dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
      {"OpenMesh", dotted(OM_GET_VER, OM_GET_MAJ, OM_GET_MIN)},
      {"OpenSSL", OpenSSL_version(OPENSSL_VERSION_STRING)},
      {"SQLite", sqlite3_libversion()},
      {"TBB", TBB_runtime_version()},
      {"TetGen", OCTOTOMY_TETGEN_VERSION},
      {"zlib", zlibVersion()},
      {"zstd", ZSTD_versionString()}};
  add_parts(versions);
  return versions;
}

}  // namespace octotomy::planner
