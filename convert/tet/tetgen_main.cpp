// SPDX-License-Identifier: AGPL-3.0-or-later

// octotomy-tetgen: one run of TetGen, fed and read by mesher_process.cpp.

#include <limits>
#include <string>
#include <tetgen.h>

#include "convert/tet/mesher_child.h"

using octotomy::convert::MesherAnswer;
using octotomy::convert::MesherRequest;
using octotomy::convert::read_all;
using octotomy::convert::write_all;
namespace convert = octotomy::convert;

namespace {

/// Fills TetGen's input arrays, which live until the process ends.
bool read_complex(const MesherRequest& request, tetgenio& in) {
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
  MesherAnswer answer;
  answer.points = static_cast<std::uint64_t>(out.numberofpoints);
  answer.tetrahedra = static_cast<std::uint64_t>(out.numberoftetrahedra);
  return write_all(file, &answer, sizeof answer) &&
         write_all(file, out.pointlist, 3 * answer.points * sizeof(double)) &&
         write_all(file, out.tetrahedronlist, 4 * answer.tetrahedra * sizeof(int));
}

bool answer(const convert::MesherTask& task) {
  // Never destroyed: the destructors would free one by one the arrays that read_complex allocates as one.
  static auto& in = *new tetgenio;
  static auto& out = *new tetgenio;
  std::string switches = task.request.switches.data();
  if (!read_complex(task.request, in)) return false;
  tetrahedralize(switches.data(), &in, &out);
  return write_answer(task.answer_file, out);
}

}  // namespace

int main() {
  convert::run_mesher(answer);
}
