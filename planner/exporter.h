// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "convert/deck.h"
#include "planner/evaluate.h"
#include "planner/filling.h"

namespace octotomy::planner {

/// What an export step wrote, or why it wrote nothing. Moving it may throw, as moving its JSON may.
struct Exported {  // NOLINT(bugprone-exception-escape)
  std::string id;
  std::string object;
  std::string path;  ///< within the result folder
  bool written = false;
  std::string content;  ///< for people: "12 345 tetrahedra, smallest dihedral 6.1 degrees"
  nlohmann::ordered_json details;
  std::vector<std::string> findings;
};

struct ExportOptions {
  std::stop_token stop{};
  /// Called with what is being done and a fraction of it, 0..1.
  std::function<void(const std::string& doing, double fraction)> progress{};
};

/// Writes the exports of a plan's result into one folder. Plan and evaluation must live as long.
class Exporter {
 public:
  Exporter(const Plan& plan, const Evaluation& evaluation, std::filesystem::path folder,
           ExportOptions options = {});

  /// Writes an object as the step's extension says: its mesh; tetrahedra that fill its mesh (filling.h); its
  /// voxels as a label map of the universe. Several decks of one object are one filling. Where the step names
  /// further regions, or objects that hold and move this one, the deck is region_deck()'s (region_deck.h).
  /// A deck's header says units, frame, versions, the plan's and its scans' SHA-256, the elements' quality
  /// and all findings.
  ///
  /// An object that is empty, has no mesh, or that no mesher can fill is not written; a finding says why.
  /// Throws what the writers throw where the disk does not take it, and Stopped where the stop token was set;
  /// then the file is not there. Precondition: the step exports.
  Exported write(const Step& step);

  /// Of "tetrahedralise" and "write", of all that was written.
  const Timings& timings() const { return timings_; }

 private:
  /// What is being written.
  struct Export {
    const Object& object;
    const ExportStep& step;
    std::filesystem::path path;
    Exported exported;
  };
  void write_mesh(Export& to);
  void write_label(Export& to);
  void write_filled(Export& to);
  void write_regions(Export& to);
  void write_deck(Export& to, const convert::Tetrahedra& tetrahedra, convert::DeckOptions options);
  voxel::Progress progress(const std::string& doing) const;

  const Plan& plan_;
  const Evaluation& evaluation_;
  std::filesystem::path folder_;
  ExportOptions options_;
  Timings timings_;
  /// A filling that decks of one object share.
  struct Filled {
    Filling filling;
    std::vector<convert::DeckSurface> surfaces;
  };
  /// By the objects' names, whether the fallback was allowed, and where elements are finer.
  std::map<std::string, Filled> filled_;
};

}  // namespace octotomy::planner
