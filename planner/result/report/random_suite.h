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

/// The tiers of random questions.
enum class RandomTier {
  Exact,    ///< sets of voxels in general position, compared voxel by voxel
  AsGiven,  ///< small sets of voxels as given, so that faces coincide and edges touch, compared voxel by
            ///< voxel
  Bounded   ///< plans on scans, compared within their bounds
};

/// "exact", "as_given" or "bounded".
const char* name_of(RandomTier tier);

struct RandomSuiteOptions {
  int count = 1000;  ///< number of questions in each tier
  std::vector<RandomTier> tiers{RandomTier::Exact, RandomTier::AsGiven, RandomTier::Bounded};
  std::uint64_t seed = 1;  ///< seed of the first question; question i has seed + i
  /// The folder to which plans of disagreements are written, each in a folder of its own; created if there is
  /// one.
  std::filesystem::path failures = "disagreements";
  std::stop_token stop{};
  std::function<void(const std::string& doing, double share)> progress{};
};

/// A question on which the kernels disagree, simplified as far as they still disagree.
struct Disagreement {
  std::uint64_t seed = 0;
  std::string tier;
  std::string question;  ///< the simplified expression, or plan
  std::vector<std::string> reasons;
  std::filesystem::path plan;  ///< where it was written
};

/// The results of one tier's questions.
struct RandomAnswers {
  VerdictCounts verdicts;  ///< for tiers of sets, one per question; for bounded, one per object of every plan
  int asked = 0;
  int of_substance = 0;  ///< number of results that voxels resolve and that are neither empty nor an operand
  int no_answer = 0;     ///< questions for which the mesh kernel reported that it has no answer
  int refused = 0;       ///< masks or windows without a voxel, which are not questions
  /// Certificates in the order of the questions: those of the first most_told questions, and all that do not
  /// pass.
  std::vector<verify::Certificate> results;
  static constexpr std::size_t most_told = 1000;
};

struct RandomSuite {
  RandomAnswers exact, as_given, bounded;
  std::vector<Disagreement> disagreements;
  std::optional<verify::Contested> worst;  ///< the worst of the bounded tier's objects

  /// The share of all questions whose results count in `of_substance`.
  double substance() const;
};

/// With a lower share, the agreement would mostly be on trivial results.
inline constexpr double least_substance = 0.3;

/// Asks both kernels random questions: expressions up to six operators deep, of sets of up to 48 voxels a
/// side in general position and of up to four as given; and plans. Questions are asked in parallel; answers
/// depend on the seed only. A disagreement is simplified (without some operators, motions or regions, by
/// smaller sets) as long as the kernels still disagree, and written as a plan with its scans. Throws Stopped,
/// and as voxel::write_file(). Cost in processor time: a question to the exact tier about 0.3 s, as given 3
/// ms, to the bounded tier 1 s.
RandomSuite ask_random(const RandomSuiteOptions& options);

}  // namespace octotomy::planner
