// SPDX-License-Identifier: AGPL-3.0-or-later

// octotomy-tetgen: one run of TetGen, fed and read by tetgen_process.cpp.

#include <csignal>
#include <cstddef>
#include <limits>
#include <new>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <tetgen.h>
#include <unistd.h>

#include "convert/tetgen_process.h"

using octotomy::convert::TetgenAnswer;
using octotomy::convert::TetgenRequest;
namespace convert = octotomy::convert;

namespace {

bool read_all(void* target, std::size_t bytes) {
  auto* at = static_cast<std::byte*>(target);
  while (bytes > 0) {
    const ssize_t got = read(STDIN_FILENO, at, bytes);
    if (got <= 0) return false;
    at += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int file, const void* source, std::size_t bytes) {
  const auto* at = static_cast<const std::byte*>(source);
  while (bytes > 0) {
    const ssize_t put = write(file, at, bytes);
    if (put <= 0) return false;
    at += put;
    bytes -= static_cast<std::size_t>(put);
  }
  return true;
}

void limit(__rlimit_resource resource, std::uint64_t most) {
  const rlimit both{most, most};
  setrlimit(resource, &both);
}

/// Fills the arrays as TetGen wants them; they live until the process ends.
bool read_complex(const TetgenRequest& request, tetgenio& in) {
  constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<int>::max() / 3);
  if (request.points > most || request.triangles > most || request.holes > most) return false;
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(request.points);
  in.pointlist = new double[3 * request.points];
  if (!read_all(in.pointlist, 3 * request.points * sizeof(double))) return false;

  auto* corners = new int[3 * request.triangles];
  if (!read_all(corners, 3 * request.triangles * sizeof(int))) return false;
  in.numberoffacets = static_cast<int>(request.triangles);
  in.facetlist = new tetgenio::facet[request.triangles];
  auto* polygons = new tetgenio::polygon[request.triangles];
  for (std::uint64_t t = 0; t < request.triangles; ++t) {
    polygons[t] = {corners + 3 * t, 3};
    in.facetlist[t] = {polygons + t, 1, nullptr, 0};
  }

  in.numberofholes = static_cast<int>(request.holes);
  if (request.holes > 0) in.holelist = new double[3 * request.holes];
  return read_all(in.holelist, 3 * request.holes * sizeof(double));
}

bool write_answer(int file, const tetgenio& out) {
  TetgenAnswer answer;
  answer.points = static_cast<std::uint64_t>(out.numberofpoints);
  answer.tetrahedra = static_cast<std::uint64_t>(out.numberoftetrahedra);
  return write_all(file, &answer, sizeof answer) &&
         write_all(file, out.pointlist, 3 * answer.points * sizeof(double)) &&
         write_all(file, out.tetrahedronlist, 4 * answer.tetrahedra * sizeof(int));
}

}  // namespace

int main() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // TetGen talks on the standard output even when told to be quiet: the answer needs a way of its own.
  const int answer_file = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);

  TetgenRequest request;
  if (!read_all(&request, sizeof request) || request.version != TetgenRequest::this_version)
    _exit(convert::tetgen_exit_protocol);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_AS, request.memory_limit_bytes);
  limit(RLIMIT_CPU, request.cpu_limit_seconds);

  int status = 0;
  try {
    // Never destroyed: their destructors would free one by one what read_complex allocates at once.
    auto* in = new tetgenio;
    auto* out = new tetgenio;
    if (!read_complex(request, *in)) _exit(convert::tetgen_exit_protocol);
    tetrahedralize(request.switches.data(), in, out);
    if (!write_answer(answer_file, *out)) status = convert::tetgen_exit_protocol;
  } catch (int reason) {
    status = reason == 1 ? convert::tetgen_exit_memory : convert::tetgen_exit_base + (reason & 15);
  } catch (const std::bad_alloc&) {
    status = convert::tetgen_exit_memory;
  }
  fflush(stdout);
  _exit(status);
}
