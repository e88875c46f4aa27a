#include "study/study.h"

#include <set>
#include <system_error>

#include "base/error.h"
#include "base/sha256.h"
#include "host/atomic_file.h"
#include "study/device_arrays.h"
#include "study/extends.h"
#include "study/named_materials.h"
#include "study/schemas.h"
#include "study/schemas/known.h"
#include "study/tables/tables.h"
#include "study/toml/toml_text.h"

namespace chladni::study {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestStudy = std::size_t{16} << 20U;

bool is_below(const fs::path& path, const fs::path& folder) {
  const auto [in_folder, in_path] =
      std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return in_folder == folder.end() || (std::next(in_folder) == folder.end() && in_folder->empty());
}

/// models/oat/minimal/study.toml is "minimal"; models/beam.toml is "beam".
std::string name_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::string parent =
      fs::absolute(file).lexically_normal().parent_path().filename().string();
  return stem == "study" && !parent.empty() ? parent : stem;
}

}  // namespace

fs::path StudyFolder::resolved(const std::string& text) const {
  const fs::path wanted = fs::path(text).is_absolute() ? fs::path(text) : folder / text;
  if (named != nullptr) named->push_back(wanted);
  std::error_code fault;  // a name that is too long, a loop of links
  const fs::path real = fs::weakly_canonical(wanted, fault);
  require(!fault, "the path \"" + text + "\" cannot be used: " + fault.message() +
                      "; expected a file below the study's folder");
  if (is_below(real, fs::weakly_canonical(folder))) return wanted;
  for (const auto& other : allowed) {
    if (is_below(real, fs::weakly_canonical(other))) return real;
  }
  throw InvalidInput("the path \"" + text +
                     "\" leaves the study's folder; put the file there, or allow its folder on "
                     "the command line with --allow-outside " +
                     real.parent_path().string());
}

namespace {

WholeDocument whole_document(std::string_view bytes, const fs::path& file,
                             const StudyFolder& folder) {
  const auto read = [&](const std::string& text, fs::path& base) {
    base = folder.resolved(text);
    return read_whole(base, kLargestStudy);
  };
  return with_bases(parse_toml(bytes, file.string()), file, read);
}

// Materials by name and arrays of devices. What they stand for is what all else sees.
bool replace_short_forms(TomlNode& tree, const StudyFolder& folder, Problems& problems,
                         Study& study) {
  const bool materials = complete_materials(tree, problems);
  const auto resolved = [&](const std::string& text) { return folder.resolved(text); };
  const bool arrays = expand_arrays(tree, resolved, problems, study.bases);
  return materials || arrays;
}

Study study_of(std::string_view bytes, const fs::path& file, const StudyFolder& folder) {
  Study study;
  study.file = file;
  study.name = name_of(file);
  study.sha256 = sha256(bytes);
  auto document = whole_document(bytes, file, folder);
  study.bases = std::move(document.bases);
  TomlNode& tree = document.tree;
  Problems problems(file.string());
  const bool extends = !study.bases.empty();
  const bool replaced = replace_short_forms(tree, folder, problems, study);
  study.text = !extends && !replaced ? std::string(bytes) : toml_text(tree);
  const auto known = without_statements(tree, problems);
  TableReader root(tree, "", problems);
  top_schema().read(root, study);
  read_geometry_part(root, folder, study);
  read_materials(root, study);
  read_mesh_part(root, study);
  read_modes_part(root, study);
  read_supports(root, study);
  read_attachments(root, study);
  read_variations(root, study);
  read_channels(root, study);
  read_layouts(root, study);
  read_placement(root, study);
  read_measurement(root, folder, study);
  read_experiment(root, folder, study);
  read_design(root, study);
  read_identification(root, study);
  read_state_space(root, study);
  read_interpolation(root, study);
  read_observer(root, folder, study);
  read_priors(root, study);
  read_diagnosis(root, folder, study);
  read_specimens(root, folder, study);
  read_expectations(root, study);
  static_cast<void>(root.find("extends"));  // read before: a slip of its letters is told
  root.refuse_unknown();
  read_known(known, study, problems);
  problems.throw_if_any();
  return study;
}

// What a study names, as far as it can be read.
std::vector<fs::path> names_in(const fs::path& file, const std::vector<fs::path>& allowed) {
  std::vector<fs::path> named;
  try {
    const StudyFolder folder{fs::absolute(file).parent_path(), allowed, &named};
    (void)study_of(read_whole(file, kLargestStudy), file, folder);
  } catch (const InvalidInput&) {
    return named;  // whoever reads the study reports the error
  }
  return named;
}

}  // namespace

Study parse_study(std::string_view bytes, const fs::path& file,
                  const std::vector<fs::path>& allowed) {
  return study_of(bytes, file, {fs::absolute(file).parent_path(), allowed});
}

std::vector<fs::path> files_of(const fs::path& file, const std::vector<fs::path>& allowed) {
  std::vector<fs::path> all{file};
  std::set<fs::path> known{fs::absolute(file).lexically_normal()};
  auto lent = allowed;  // to a base, a truth, a specimen
  lent.push_back(fs::absolute(file).parent_path());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].extension() != ".toml") continue;  // these name others
    for (auto& named : names_in(all[i], i == 0 ? allowed : lent)) {
      if (known.insert(fs::absolute(named).lexically_normal()).second) all.push_back(named);
    }
  }
  return all;
}

Study read_study(const fs::path& file, const std::vector<fs::path>& allowed) {
  std::error_code ignored;  // read_whole reports the error
  require(
      !fs::is_directory(file, ignored),
      file.string() + " is a folder; expected a study, such as " + (file / "study.toml").string());
  return parse_study(read_whole(file, kLargestStudy), file, allowed);
}

}  // namespace chladni::study
