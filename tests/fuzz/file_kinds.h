// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace octotomy::tests {

/// A kind of file that the program reads: one that is sound, how its mutants are read, and what computes
/// with those that were. In commands MUTANT stands for the mutant and OUT for a file to write.
struct FileKind {
  std::string name;
  std::string file;   ///< the mutant's name, with the extension that chooses the reader
  std::string sound;  ///< bytes to mutate
  /// Of half of the mutants: packs or seals, so that damage gets past checksums.
  std::function<std::string(std::string)> finish;
  std::vector<std::filesystem::path> beside;  ///< files that lie in the mutant's folder
  bool is_folder = false;                     ///< the program is given that folder
  bool is_changed = false;                    ///< by its commands: its folder is laid anew for each
  std::vector<std::string> command;           ///< reads a mutant
  /// Of these one, chosen by the seed, computes with a mutant that was read. All take the sound file.
  std::vector<std::vector<std::string>> verbs;
  /// Take a second or so, and may find too little in the sound file: one mutant in 256 is for them.
  std::vector<std::vector<std::string>> slow_verbs = {};
};

/// Every kind. `make` runs the program with arguments and throws where it fails: it makes the sound files, in
/// `folder`. Kinds that other programs make are left out where those are not installed, and said to be.
std::vector<FileKind> file_kinds(const std::filesystem::path& folder,
                                 const std::function<void(const std::vector<std::string>&)>& make);

}  // namespace octotomy::tests
