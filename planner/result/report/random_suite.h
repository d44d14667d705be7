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

/// The kinds of random questions.
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
  /// Folder for the plans on which the kernels disagree, each in its own subfolder. It is created only if
  /// there are any.
  std::filesystem::path failures = "disagreements";
  std::stop_token stop{};
  std::function<void(const std::string& doing, double share)> progress{};
};

/// A question on which the kernels disagree, simplified as long as they still do.
struct Disagreement {
  std::uint64_t seed = 0;
  std::string tier;
  std::string question;  ///< the simplified expression or plan, as text
  std::vector<std::string> reasons;
  std::filesystem::path plan;  ///< where it was written
};

/// The results of all questions of one tier.
struct RandomAnswers {
  VerdictCounts verdicts;  ///< one per question on sets; in the bounded tier one per object
  int asked = 0;
  int of_substance = 0;  ///< results that are resolved and neither empty nor an operand
  int no_answer = 0;     ///< questions for which the mesh kernel reports that it has no answer
  int refused = 0;       ///< plans with a window or mask without a voxel, which count as no question
  /// Certificates in the order of the questions: those of the first most_told questions, and of all later
  /// ones that do not pass.
  std::vector<verify::Certificate> results;
  static constexpr std::size_t most_told = 1000;
};

struct RandomSuite {
  RandomAnswers exact, as_given, bounded;
  std::vector<Disagreement> disagreements;
  std::optional<verify::Contested> worst;  ///< the object of the bounded tier with the worst certificate

  /// The share of all questions that count in `of_substance`.
  double substance() const;
};

/// With a smaller share, agreement would be mostly on trivial results.
inline constexpr double least_substance = 0.3;

/// Puts random questions to both kernels: expressions with up to six nested operators of sets of voxels (up
/// to 48 along a side in general position, up to four as given), and plans on scans. Questions run in
/// parallel; their answers depend only on the seed. If the kernels disagree, the question is simplified
/// (fewer operators, motions or regions, smaller sets) as long as they still do, and written as a plan with
/// its scans. Throws Stopped, and as voxel::write_file() does. Cost in processor time for each question: 0.3
/// s in the exact tier, 3 ms as given, 1 s in the bounded tier.
RandomSuite ask_random(const RandomSuiteOptions& options);

}  // namespace octotomy::planner
