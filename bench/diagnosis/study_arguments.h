// What hidden_effects_study is asked for.
#pragma once

#include <string>
#include <vector>

#include "simulators/hidden/hidden_effect.h"
#include "simulators/plates/ritz_structure.h"

namespace chladni {

struct Arguments {
  std::string kinds = "all", rigs = "table";
  unsigned seeds = 2, first = 1;
  unsigned every = 1;  ///< of all kinds those whose number and seed come to a multiple of it
  simulators::HiddenOptions hidden;
  simulators::RitzStructureOptions structure;
  bool fe = false;           ///< the structure of the program that ships
  bool answer = false;       ///< with `fe`: all that `chladni diagnose` does, modes included
  double edge_length = 0.0;  ///< of its mesh [m]; 0: left to it
  bool tolerance = false, list = false, detectable = false;
  unsigned check = 0;      ///< masses hidden at each multiple of their smallest size
  double deviation = 1.0;  ///< of the rigs, within tolerances
  int coarser = 2;         ///< degrees that the structure has less, within tolerances
  std::string write;       ///< a file for the first case instead of a diagnosis
  std::string cases;       ///< a file of a line of JSON for each case
};

struct Trial {
  std::string rig, group;  ///< a row of the table
  std::vector<std::string> kinds;
  unsigned seed = 0;
};

/// @throws InvalidInput  a word that is not known, or one without its value
[[nodiscard]] Arguments arguments(int count, char** values);

/// Rigs one after the other; kinds that a rig cannot have are left out.
[[nodiscard]] std::vector<Trial> trials(const Arguments& wanted);

}  // namespace chladni
