// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "planner/result/report/report.h"
#include "verify/certificate/certificate.h"
#include "voxel/solid/expression.h"

namespace octotomy::planner {

/// What a random question asks.
enum class RandomTier {
  Exact,    ///< sets of voxels in general position, to the voxel
  AsGiven,  ///< small sets of voxels as they are, so that faces coincide and edges touch, to the voxel
  Bounded   ///< plans on scans, within their bounds
};

/// "exact", "as_given" or "bounded".
const char* name_of(RandomTier tier);

struct RandomSuiteOptions {
  int count = 1000;  ///< questions to each tier
  std::vector<RandomTier> tiers{RandomTier::Exact, RandomTier::AsGiven, RandomTier::Bounded};
  std::uint64_t seed = 1;  ///< of the first; question i has seed + i
  /// Where plans of disagreements are written, a folder each; made when there is one.
  std::filesystem::path failures = "disagreements";
  std::stop_token stop{};
  std::function<void(const std::string& doing, double share)> progress{};
};

/// A question on which the kernels disagree, made as simple as it stays one.
struct Disagreement {
  std::uint64_t seed = 0;
  std::string tier;
  std::string question;  ///< the simplified expression, or plan
  std::vector<std::string> reasons;
  std::filesystem::path plan;  ///< where it was written
};

/// How one tier's questions were answered.
struct RandomAnswers {
  VerdictCounts verdicts;  ///< of sets: a question each; bounded: every object of every plan
  int asked = 0;
  int of_substance = 0;  ///< results that voxels resolve and that are neither empty nor an operand
  int no_answer = 0;     ///< the mesh kernel had none, and said so
  int refused = 0;       ///< a mask or window without a voxel: no question
  /// Of the questions, in their order, where there is one: of the first most_told, and all that do not pass.
  std::vector<verify::Certificate> results;
  static constexpr std::size_t most_told = 1000;
};

struct RandomSuite {
  RandomAnswers exact, as_given, bounded;
  std::vector<Disagreement> disagreements;
  std::optional<verify::Contested> worst;  ///< of the bounded tier's objects

  /// Results of substance as a share of all.
  double substance() const;
};

/// Results of less substance would show agreement on nothing.
inline constexpr double least_substance = 0.3;

/// Asks both kernels random questions: expressions up to six operators deep, of sets of up to 48 voxels a
/// side in general position and of up to four as given; and plans. Questions are asked in parallel; answers
/// depend on the seed only. A disagreement is simplified (operators, motions and regions taken away, sets cut
/// down) as long as it stays one, and written as a plan with its scans. Throws Stopped, and as voxel::write_file().
/// Cost in processor time: a question to the exact tier about 0.3 s, as given 3 ms, to the bounded tier 1 s.
RandomSuite ask_random(const RandomSuiteOptions& options);

}  // namespace octotomy::planner
