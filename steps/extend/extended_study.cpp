#include "steps/extend/extended_study.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "diagnosis/effect.h"
#include "host/folder.h"
#include "host/shell_word.h"
#include "steps/extend/extension.h"
#include "study/extends.h"

namespace chladni::steps {
namespace {

namespace fs = std::filesystem;

// Changes relative paths so that they are right in the extended study's folder:
// "../../models/beam/measured.csv".
void lead_paths(study::TomlEdit& edit, const fs::path& file, const fs::path& folder) {
  const fs::path from = fs::absolute(file).parent_path();
  const fs::path way = path_from(folder, from);
  if (way == ".") return;
  const auto files = study::relative_files(edit.tree());
  for (const auto* file_name : files) {
    edit.replace(*file_name,
                 study::toml_text((way / file_name->text).lexically_normal().generic_string()));
  }
  if (files.empty()) return;
  edit.append_comment(
      fmt::format("Its files lie with the study that was diagnosed: --allow-outside {}",
                  shell_word(fs::weakly_canonical(from).string())));
}

// The causes came after the reference was measured: beside a model that has them it would tell them
// a second time.
void leave_out_reference(study::TomlEdit& edit, const study::Study& study) {
  if (!study.measurement || study.measurement->reference.empty()) return;
  const auto* measurement = study::member(edit.tree(), "measurement");
  if (measurement == nullptr || measurement->members.empty()) return;
  edit.set(*measurement, measurement->members.front().key, "reference", "\"\"",
           "the causes below have come since it was measured");
}

bool is_exchange(const diagnosis::Cause& cause) {
  return cause.effect.starts_with("swapped_") || cause.effect.starts_with("permuted_");
}

// 0: of the body or of a channel at its place; 1: an exchange of labels; 2: of a record.
int turn_of(const diagnosis::Cause& cause) {
  if (is_exchange(cause)) return 1;
  const bool is_of_place =
      cause.effect.ends_with("_position") || cause.effect.ends_with("_direction");
  return cause.channels.empty() || is_of_place ? 0 : 2;
}

// True for what changes the damping of all modes. The dashpot of a resonator depends on it.
bool is_of_modes(const diagnosis::Cause& cause) {
  return std::ranges::any_of(diagnosis::effects(), [&](const diagnosis::Effect* effect) {
    return effect->name == cause.effect &&
           effect->in_study.table == diagnosis::InStudy::Table::modes;
  });
}

bool is_of_size(const diagnosis::Cause& cause) { return cause.effect == "size_error"; }

// The size of the body comes first, because places follow it; then damping of all modes. A channel
// has another name after an exchange.
std::vector<diagnosis::Cause> in_order(std::vector<diagnosis::Cause> causes) {
  std::ranges::stable_partition(causes, is_of_modes);
  if (std::ranges::any_of(causes, is_exchange)) std::ranges::stable_sort(causes, {}, turn_of);
  std::ranges::stable_partition(causes, is_of_size);
  return causes;
}

}  // namespace

ExtendedStudy extended_study(std::string_view bytes, const fs::path& file,
                             const diagnosis::Surface& chart,
                             const std::vector<diagnosis::Cause>& causes, const fs::path& folder,
                             const std::vector<fs::path>& allowed, bool fits_variations,
                             const DiagnosedOn& on) {
  ExtendedStudy result{std::string(bytes), {}};
  double growth = 0.0;
  for (const auto& cause : in_order(causes)) {
    // One cause after the other: each starts from the text that the one before left.
    const study::Study study = study::parse_study(result.text, file, allowed);
    study::TomlEdit edit(result.text, file.string());
    const Extension by{edit, study, chart, cause, fits_variations, on, growth};
    const auto refused = extend(cause.effect)(by);
    if (!refused.empty()) {
      result.unexpressed.push_back(cause.effect + ": " + refused);
      study::TomlEdit untouched(result.text, file.string());
      untouched.append_comment(by.comment() + "\nNot in this study: " + refused + ".");
      result.text = untouched.text();
      continue;
    }
    result.text = edit.text();
    if (is_of_size(cause)) growth = (1.0 + growth) * (1.0 + by.number("relative")) - 1.0;
  }
  const auto extended = study::parse_study(result.text, file, allowed);
  study::TomlEdit reference(result.text, file.string());
  if (result.unexpressed.size() < causes.size()) leave_out_reference(reference, extended);
  result.text = reference.text();
  study::TomlEdit edit(result.text, file.string());
  lead_paths(edit, file, folder);
  result.text = edit.text();
  return result;
}

}  // namespace chladni::steps
