#include "rotation/drawn_sample.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <memory>

#include "base/error.h"

namespace chladni::rotation {
namespace {

// The first word that git prints; empty where it fails.
std::string git(const std::filesystem::path& source, const std::string& what) {
  const std::string command = fmt::format("git -C '{}' {} 2>/dev/null", source.string(), what);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::array<char, 128> line{};
  if (pipe == nullptr || std::fgets(line.data(), line.size(), pipe.get()) == nullptr) return "";
  std::string text = line.data();
  return text.substr(0, text.find_first_of(" \r\n"));
}

bool is_number(const std::string& text) {
  return !text.empty() && text.size() < 9 &&
         text.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

TreeState tree_state(const std::filesystem::path& source) {
  TreeState state;
  state.commit = git(source, "rev-parse HEAD");
  const std::string count = git(source, "rev-list --count --first-parent HEAD");
  if (is_number(count)) state.landings = std::stoul(count);
  state.is_shallow = git(source, "rev-parse --is-shallow-repository") == "true";
  return state;
}

DrawnSample drawn_sample(const std::string& asked, const TreeState& tree) {
  DrawnSample sample;
  if (asked == "all") {
    sample.number = 0;
    sample.all = true;
    sample.from = "CHLADNI_STUDIES: all kinds";
  } else if (!asked.empty()) {
    require(is_number(asked),
            fmt::format("CHLADNI_STUDIES is '{}', expected 'all' or a number", asked));
    sample.number = static_cast<unsigned>(std::stoul(asked));
    sample.half = sample.number / 4 % 2;
    sample.from = "CHLADNI_STUDIES";
  } else if (tree.commit.size() < 8) {
    sample.from = "no git here";
  } else {
    const auto hash = std::stoul(tree.commit.substr(0, 8), nullptr, 16);
    const auto quarter = tree.is_shallow ? hash / 1000 : tree.landings;
    sample.number = static_cast<unsigned>(quarter % 4);
    sample.half = static_cast<unsigned>(quarter / 4 % 2);
    sample.from = fmt::format("commit {}{}", tree.commit.substr(0, 8),
                              tree.is_shallow ? ", of a shallow clone" : "");
  }
  return sample;
}

}  // namespace chladni::rotation
