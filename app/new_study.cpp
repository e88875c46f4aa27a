// chladni new: writes a first study, by asking or from a file.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <ostream>
#include <string>

#include "app/command.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/quantity.h"
#include "host/atomic_file.h"
#include "host/shell_word.h"
#include "show/first_study.h"
#include "study/named_materials.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;

/// Asks on a terminal; elsewhere the answer is the proposal.
class Dialog {
 public:
  explicit Dialog(std::ostream& said)
      : said_(said), asks_(isatty(STDIN_FILENO) == 1 && isatty(STDERR_FILENO) == 1) {}

  [[nodiscard]] bool asks() const { return asks_; }

  /// The answer that `check` accepts; it throws InvalidInput for another one. An empty line is the
  /// proposal.
  template <typename Check>
  std::string answer(const std::string& question, const std::string& proposal, Check check) {
    while (asks_) {
      said_ << question << (proposal.empty() ? ": " : " [" + proposal + "]: ") << std::flush;
      std::string line;
      if (!std::getline(std::cin, line)) throw_if_interrupted();
      require(static_cast<bool>(std::cin), "no answer to \"" + question + "\"");
      const auto begin = line.find_first_not_of(" \t");
      line = begin == std::string::npos ? proposal : line.substr(begin);
      try {
        check(line);
        return line;
      } catch (const InvalidInput& e) {
        said_ << "  " << e.what() << "\n";
      }
    }
    return proposal;
  }

 private:
  std::ostream& said_;
  bool asks_;
};

std::vector<std::string> kinds() {
  std::vector<std::string> names;
  for (const auto& body : show::first_bodies()) names.emplace_back(body.kind);
  return names;
}

bool is_kind(const std::string& word) { return std::ranges::count(kinds(), word) > 0; }

void ask_material(Dialog& dialog, show::FirstChoices& choices) {
  choices.material = dialog.answer(
      "material (chladni list materials)", choices.material, [](const std::string& name) {
        require(study::named_material(name) != nullptr, "there is no material \"" + name + "\"");
      });
}

void ask_dimensions(Dialog& dialog, show::FirstChoices& choices) {
  const auto& bodies = show::first_bodies();
  const auto body = std::ranges::find(bodies, choices.kind, &show::FirstBody::kind);
  for (const auto& [key, value, si_unit] : body->dimensions) {
    const std::string proposal(value);
    const auto check = [&, unit = si_unit](const std::string& text) {
      if (unit == "m") require(quantity(text, unit) > 0.0, "expected a positive length");
    };
    // A list is written as it is: a slip in it is found by the reader of the study.
    choices.dimensions.emplace_back(
        key, si_unit == "m" ? dialog.answer(std::string(key), proposal, check) : proposal);
  }
}

void ask_unit(Dialog& dialog, show::FirstChoices& choices) {
  if (!choices.unit.empty() || !study::needs_unit(choices.part)) return;
  require(dialog.asks(), choices.part.string() +
                             " does not state the unit of its lengths; expected --unit, such as "
                             "--unit mm");
  choices.unit = dialog.answer("unit of its lengths", "mm", [](const std::string& unit) {
    static_cast<void>(unit_factor(unit, "m"));
  });
}

fs::path file_of(const NewStudy& wanted, Dialog& dialog) {
  if (!wanted.output.empty()) return wanted.output;
  if (!is_kind(wanted.what)) return wanted.what;
  return dialog.answer("file", wanted.what + ".toml", [](const std::string& name) {
    require(name.ends_with(".toml"), "expected a name that ends in .toml");
  });
}

}  // namespace

int new_study(const NewStudy& wanted, std::ostream& results) {
  Dialog dialog(std::cerr);
  show::FirstChoices choices;
  choices.part = wanted.from;
  choices.unit = wanted.unit;
  const bool is_file = !wanted.from.empty();
  require(is_file || is_kind(wanted.what) || dialog.asks(),
          fmt::format("{}: of what body? expected --from part.step, or one of {}", wanted.what,
                      study::listed(kinds())));
  const auto file = file_of(wanted, dialog);
  require(file.extension() == ".toml",
          file.string() + " does not end in .toml; expected the file of a study");
  require(!fs::exists(fs::symlink_status(file)),
          file.string() + " is there already and stays; choose another name, or remove it");
  choices.kind =
      is_file ? "file"
      : is_kind(wanted.what)
          ? wanted.what
          : dialog.answer(fmt::format("body ({})", fmt::join(kinds(), ", ")), "plate",
                          [](const std::string& kind) {
                            require(is_kind(kind), "expected one of " + study::listed(kinds()));
                          });
  if (is_file) {
    require(fs::exists(choices.part), choices.part.string() + ": there is no such file");
    ask_unit(dialog, choices);
  } else {
    ask_dimensions(dialog, choices);
  }
  ask_material(dialog, choices);
  const auto text = show::first_study(choices, file);
  write_atomically(file, text);
  results << fmt::format("{}\nchladni check {}\n", file.string(), shell_word(file.string()));
  return 0;
}

}  // namespace chladni::app
