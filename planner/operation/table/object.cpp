// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/object.h"

#include <stdexcept>

#include "planner/operation/table/bench.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

voxel::Progress progress_of(const std::stop_token& stop,
                            const std::function<void(const std::string&, double)>& report,
                            const std::string& doing) {
  voxel::Progress progress{stop, {}};
  if (report) progress.report = [report, doing](double fraction) { report(doing, fraction); };
  return progress;
}

}  // namespace

const Object& Objects::at(const std::string& name) const {
  const auto found = index_.find(name);
  if (found == index_.end()) throw std::invalid_argument("no object is called '" + name + "'");
  return objects_[found->second];
}

const Object& Objects::add(Object object) {
  index_[object.id] = objects_.size();
  return objects_.emplace_back(std::move(object));
}

const Object& still_of(const Objects& objects, const Object& object) {
  return object.image ? objects.at(object.image->object) : object;
}

glm::dmat4 moved_since_made(const Objects& objects, const std::string& object) {
  glm::dmat4 motion(1.0);
  for (const Object* at = &objects.at(object); at->moved; at = &objects.at(at->moved->object))
    motion = motion * at->moved->motion;
  return motion;
}

glm::dvec3 mark_mm(const Mark& mark, const Objects& objects) {
  if (mark.object.empty()) return mark.p_mm;
  return glm::dvec3(moved_since_made(objects, mark.object) * glm::dvec4(mark.p_mm, 1.0));
}

const brep::Solid& SettleBench::object(const std::string& name) const {
  const std::optional<brep::Solid>& mesh = objects.at(name).mesh.whole;
  if (!mesh) throw std::runtime_error("'" + name + "' has no mesh, which this step needs: see its findings");
  return *mesh;
}

voxel::Box VoxelBench::box_mm() const {
  return voxel::bounds(universe.lattice());
}

voxel::Octree VoxelBench::combined(const voxel::Expression& expression) const {
  const Stopwatch watch(timings, "boolean_voxel");
  return voxel::combine(universe, expression);
}

voxel::Expression VoxelBench::within_universe(const voxel::Expression& symbol) const {
  return symbol & voxel::Expression(box_mm());
}

voxel::Progress AnswerBench::progress(const std::string& doing) const {
  return progress_of(stop, report, doing);
}

voxel::Progress FileBench::progress(const std::string& doing) const {
  return progress_of(stop, report, doing);
}

}  // namespace octotomy::planner
