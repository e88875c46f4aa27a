#include "study_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <sstream>
#include <type_traits>

#include "base/error.h"
#include "simulators/tables/rig.h"

namespace chladni {
namespace {

simulators::DeviationLaw law_named(const std::string& text) {
  using simulators::DeviationLaw;
  const std::map<std::string, DeviationLaw> laws{{"normal", DeviationLaw::normal},
                                                 {"uniform", DeviationLaw::uniform},
                                                 {"student", DeviationLaw::student}};
  const auto found = laws.find(text);
  require(found != laws.end(),
          fmt::format("no law '{}'; there are normal, uniform, student", text));
  return found->second;
}

// What each word that takes a value does with it.
std::map<std::string, std::function<void(const std::string&)>> words(Arguments& all) {
  const auto number = [](auto& into) {
    return [&into](const std::string& text) {
      into = static_cast<std::decay_t<decltype(into)>>(std::stod(text));
    };
  };
  const auto text = [](std::string& into) {
    return [&into](const std::string& word) { into = word; };
  };
  return {{"--kinds", text(all.kinds)},
          {"--rigs", text(all.rigs)},
          {"--write", text(all.write)},
          {"--cases", text(all.cases)},
          {"--law", [&all](const std::string& word) { all.hidden.law = law_named(word); }},
          {"--correlation", number(all.hidden.correlation)},
          {"--own-delay", number(all.hidden.own_delay_s)},
          {"--fixtures", number(all.hidden.fixtures)},
          {"--edge", number(all.edge_length)},
          {"--every", number(all.every)},
          {"--seeds", number(all.seeds)},
          {"--check", number(all.check)},
          {"--first", number(all.first)},
          {"--lines", number(all.hidden.lines)},
          {"--severity", number(all.hidden.severity)},
          {"--degree", number(all.hidden.degree)},
          {"--modes", number(all.structure.modes)},
          {"--fine", number(all.structure.fine)},
          {"--deviation", number(all.deviation)},
          {"--coarser", number(all.coarser)}};
}

std::map<std::string, std::function<void()>> switches(Arguments& all) {
  return {{"--tolerance", [&all] { all.tolerance = true; }},
          {"--fe", [&all] { all.fe = all.tolerance = true; }},
          {"--answer", [&all] { all.fe = all.tolerance = all.answer = true; }},
          {"--changed-damping", [&all] { all.hidden.damping_stays = false; }},
          {"--detectable", [&all] { all.detectable = true; }},
          {"--list", [&all] { all.list = true; }}};
}

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> all;
  std::stringstream words(text);
  for (std::string word; std::getline(words, word, ',');) all.push_back(word);
  return all;
}

void add_each(std::vector<Trial>& all, const simulators::Rig& rig, unsigned seed, unsigned every,
              const std::vector<std::string>& names) {
  for (std::size_t n = 0; n < names.size(); ++n) {
    if ((n + seed) % every != 0 || !rig.has(names[n])) continue;
    all.push_back({rig.name, names[n], {names[n]}, seed});
  }
}

bool has_all(const simulators::Rig& rig, const std::vector<std::string>& kinds) {
  return std::ranges::all_of(kinds, [&](const auto& kind) { return rig.has(kind); });
}

}  // namespace

Arguments arguments(int count, char** values) {
  Arguments all;
  const auto known = words(all);
  const auto plain = switches(all);
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    if (const auto one = plain.find(word); one != plain.end()) {
      one->second();
      continue;
    }
    const auto found = known.find(word);
    require(found != known.end(), fmt::format("'{}' is not known here", word));
    require(i + 1 < count, fmt::format("{} needs a value", word));
    found->second(values[++i]);
  }
  require(all.every > 0, "--every needs a number above 0");
  if (all.tolerance) all.hidden.deviation = all.deviation;
  require(all.fe || all.rigs == "table", "--rigs needs --fe");
  return all;
}

std::vector<Trial> trials(const Arguments& wanted) {
  std::vector<Trial> all;
  for (const auto& name : parts(wanted.rigs)) {
    const auto rig = simulators::rig_named(name, wanted.hidden.degree);
    for (const auto& word : parts(wanted.kinds)) {
      for (unsigned n = 0; n < wanted.seeds; ++n) {
        const unsigned seed = wanted.first + n;
        if (word == "all") {
          add_each(all, rig, seed, wanted.every, simulators::hidden_kinds());
        } else if (word == "outside") {
          add_each(all, rig, seed, wanted.every, simulators::outside_kinds());
        } else if (word == "pairs") {
          const auto pair = simulators::hidden_pair(seed);
          if (has_all(rig, pair)) all.push_back({name, "pairs", pair, seed});
        } else if (word == "none") {
          all.push_back({name, "none", {}, seed});
        } else {
          all.push_back({name, word, {word}, seed});
        }
      }
    }
  }
  return all;
}

}  // namespace chladni
