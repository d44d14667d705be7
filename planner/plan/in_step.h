// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

#include "brep/mesh/error.h"
#include "voxel/space/error.h"
#include "voxel/space/progress.h"

namespace octotomy::planner {

/// The answer of a step's work. What the work throws keeps its code and names the step: "step 'cut': ...".
template <typename Work>
auto in_step(const std::string& id, const Work& work) {
  const auto named = [&](const std::exception& error) { return "step '" + id + "': " + error.what(); };
  try {
    return work();
  } catch (const voxel::Stopped&) {
    throw;
  } catch (const voxel::Error& error) {
    throw voxel::Error(error.code(), named(error));
  } catch (const brep::Error& error) {
    throw brep::Error(error.code(), named(error));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(named(error));
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(named(error));
  }
}

}  // namespace octotomy::planner
