// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace octotomy::tests {

/// A kind of file that the program reads: a sound file, the commands that read its mutants, and commands that
/// compute with mutants that were read. In commands, MUTANT stands for the mutant and OUT for a file to
/// write.
struct FileKind {
  std::string name;
  std::string file;   ///< the mutant's name, with the extension that chooses the reader
  std::string sound;  ///< bytes to mutate
  /// Packs or seals half of the mutants, so that damage gets past checksums.
  std::function<std::string(std::string)> finish;
  std::vector<std::filesystem::path> beside;  ///< files that lie in the mutant's folder
  bool is_folder = false;                     ///< the program is given that folder
  bool is_changed = false;                    ///< by its commands: its folder is laid anew for each
  std::vector<std::string> command;           ///< reads a mutant
  /// One of these commands, chosen by the seed, computes with a mutant that was read. All accept the sound
  /// file.
  std::vector<std::vector<std::string>> verbs;
  /// Commands that take about a second, or that may find too little in the sound file. One mutant in 256 is
  /// passed to them.
  std::vector<std::vector<std::string>> slow_verbs = {};
};

/// Every kind. `make` runs the program with arguments and throws if it fails; it makes the sound files in
/// `folder`. Kinds that other programs make are left out, with a message, if those are not installed.
std::vector<FileKind> file_kinds(const std::filesystem::path& folder,
                                 const std::function<void(const std::vector<std::string>&)>& make);

}  // namespace octotomy::tests
