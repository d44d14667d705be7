// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/place_fault.h"

namespace octotomy::verify {

PlaceFault fault_of(const Reading& reading, bool in_voxels, bool in_mesh) {
  if (!reading.voxel.allows(in_voxels)) return in_voxels ? PlaceFault::VoxelsHave : PlaceFault::VoxelsLack;
  if (!reading.mesh.allows(in_mesh)) return in_mesh ? PlaceFault::MeshHas : PlaceFault::MeshLacks;
  const bool near = reading.voxel.near || reading.mesh.near;
  // If the witness decides the side for one kernel at least, the difference is no error: each kernel's side
  // is allowed for that kernel, because they interpolate differently there.
  const bool told = !reading.voxel.is_open() || !reading.mesh.is_open();
  return in_voxels == in_mesh || near || told ? PlaceFault::None : PlaceFault::Apart;
}

}  // namespace octotomy::verify
