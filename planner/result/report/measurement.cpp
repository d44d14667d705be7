// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/measurement.h"

namespace octotomy::planner {
namespace {

template <typename Part>
void read_part(const Json& json, std::optional<Part>& part) {
  if (json.contains(Part::key)) read_record(json, part.emplace());
}

}  // namespace

void read_value(const Json& json, Measurement& made) {
  if (const auto id = json.find("id"); id != json.end()) read_value(*id, made.id);
  read_part(json, made.size);
  read_part(json, made.gap);
  read_part(json, made.distance);
  read_part(json, made.angle);
  read_part(json, made.contacts);
  read_part(json, made.airway);
  read_part(json, made.flap);
  read_part(json, made.landmarks);
  read_part(json, made.trials);
}

std::vector<Measurement> measurements_of(const Json& measurements) {
  std::vector<Measurement> all;
  read_value(measurements, all);
  return all;
}

}  // namespace octotomy::planner
