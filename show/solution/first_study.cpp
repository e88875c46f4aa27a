#include "show/first_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/quantity.h"
#include "host/folder.h"
#include "host/shell_word.h"
#include "mesh/site.h"
#include "mesh/surface.h"
#include "stage/faces.h"
#include "stage/model.h"
#include "stage/solution.h"
#include "study/toml_edit.h"

namespace chladni::show {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPatchesTold = 12;

constexpr const char* kCommands = R"(#   chladni check {0}    what it says in SI units, and its size
#   chladni modes {0}    frequencies and mode shapes
#   chladni study {0}    all that it has data for, and report.html
)";

constexpr const char* kRest = R"(
[placement]                                    # where pairs of a sensor and an actuator belong
modes = 3                                      # the first three flexible ones

# [[support]]                                  # without one the body is free
# patch = "x_min"
# fixed = "xyz"

# [[attachment]]                               # what hangs on it or holds it
# kind = "spring"                              # others: chladni list attachments
# name = "flexure"
# at = ["0 mm", "0 mm"]
# direction = "z"
# stiffness = "1200 N/m"

# [measurement]                                # then: chladni identify, compare, diagnose
# frf = "measured.csv"                         # .csv, .uff or .mat; chladni check measured.csv
# hold_out = ["{}"]                            # no fit sees it

# [diagnosis]                                  # what the simulation gets wrong, and why
)";

std::string geometry_of(const FirstChoices& choices, const std::string& file) {
  if (choices.kind == "file") {
    const auto unit = choices.unit.empty() ? "" : ", unit = " + study::toml_text(choices.unit);
    return fmt::format("geometry = {{ file = {}{} }}\n", study::toml_text(file), unit);
  }
  std::string text = "[geometry." + choices.kind + "]\n";
  for (const auto& [key, value] : choices.dimensions) {
    text +=
        fmt::format("{:<10} = {}\n", key, value.starts_with('[') ? value : study::toml_text(value));
  }
  return text;
}

std::string places_text(const std::vector<Eigen::Vector2d>& places, const std::string& table,
                        const std::string& letter, const std::string& more) {
  std::string text;
  for (std::size_t i = 0; i < places.size(); ++i) {
    text += fmt::format(
        "\n[[{}]]\nname = \"{}{}\"\nat = [\"{:.6g} mm\", \"{:.6g} mm\"]\ndirection = \"z\"\n{}",
        table, letter, i + 1, 1e3 * places[i].x(), 1e3 * places[i].y(), i == 0 ? more : "");
  }
  return text;
}

// What stands above the channels.
std::string beginning(const FirstChoices& choices, const fs::path& file, const std::string& part,
                      const std::string& told) {
  const std::string name = file.filename().string();
  const std::string title =
      choices.kind == "file" ? choices.part.stem().string() : "a first " + choices.kind;
  std::string text =
      "# A first study, written by `chladni new`. What stands behind # is a comment.\n";
  text += fmt::format(fmt::runtime(kCommands), shell_word(name));
  text += "# Every key: chladni list keys. Every dimension has its unit.\n\n";
  text += fmt::format("title    = {}\nmaterial = {}  # others: chladni list materials\n",
                      study::toml_text(title), study::toml_text(choices.material));
  text += "modes    = { count = 12, damping_ratio = 0.005 }\n";
  text += "# mesh   = { edge_length = \"10 mm\" }  # left out: from the geometry\n\n";
  if (choices.kind != "file") {
    text += "# Origin: the middle of the top face; x along the length, y along the width, z up.\n";
  }
  return text + told + geometry_of(choices, part);
}

// The point nearest to `corner` on the line to the middle where the body looks up; none where it
// does so nowhere on that line.
std::optional<Eigen::Vector2d> towards(const Eigen::Vector2d& corner, const Eigen::Vector2d& middle,
                                       const mesh::SiteFinder& finder) {
  // A tenth of a millimetre, or on a small body a digit beyond a thousandth of it.
  const double small = std::pow(10.0, std::floor(std::log10(2e-3 * (corner - middle).norm())));
  const double step = small > 0.0 ? std::min(1e-4, small) : 1e-4;
  for (const double share : {1.0, 0.85, 0.7, 0.55, 0.4}) {
    const Eigen::Vector2d wanted = middle + share * (corner - middle);
    const Eigen::Vector2d rounded = (wanted / step).array().round() * step;
    const auto site = finder.from_above(rounded.x(), rounded.y());
    if (site && site->normal.z() > 0.5) return rounded;
  }
  return {};
}

// Places on the body seen from above, towards the corners of its box.
std::vector<Eigen::Vector2d> places_on(const mesh::TetMesh& shell, double share) {
  const auto box = mesh::bounding_box(shell.points);
  const Eigen::Vector2d middle = box.colwise().mean().head<2>();
  const Eigen::Vector2d half = 0.5 * share * (box.row(1) - box.row(0)).head<2>();
  const mesh::SiteFinder finder(shell);
  std::vector<Eigen::Vector2d> places;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const Eigen::Vector2d corner = middle + Eigen::Vector2d(x * half.x(), y * half.y());
    if (const auto place = towards(corner, middle, finder)) places.push_back(*place);
  }
  return places;
}

// The middle of the largest triangle that looks up: where none of the places above lies on the
// body.
std::vector<Eigen::Vector2d> place_on_a_face(const mesh::TetMesh& shell) {
  double largest = 0.0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  for (Eigen::Index f = 0; f < shell.faces.rows(); ++f) {
    const Eigen::Vector3d a = shell.points.row(shell.faces(f, 0));
    const Eigen::Vector3d b = shell.points.row(shell.faces(f, 1));
    const Eigen::Vector3d c = shell.points.row(shell.faces(f, 2));
    const double up = (b - a).cross(c - a).z();
    if (up <= largest) continue;
    largest = up;
    place = ((a + b + c) / 3.0).head<2>();
  }
  return {place};
}

std::vector<Eigen::Vector2d> sites(const mesh::TetMesh& shell, double share) {
  auto places = places_on(shell, share);
  return places.empty() ? place_on_a_face(shell) : places;
}

struct Patch {
  std::string name;
  double area = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // the sum, weighted by area
};

std::vector<Patch> patches_of(const mesh::TetMesh& shell) {
  std::vector<Patch> patches;
  for (const auto& name : shell.patch_names) patches.push_back({name, 0.0, {0.0, 0.0, 0.0}});
  for (Eigen::Index f = 0; f < shell.faces.rows(); ++f) {
    const Eigen::Vector3d a = shell.points.row(shell.faces(f, 0));
    const Eigen::Vector3d b = shell.points.row(shell.faces(f, 1));
    const Eigen::Vector3d c = shell.points.row(shell.faces(f, 2));
    const Eigen::Vector3d normal = 0.5 * (b - a).cross(c - a);
    auto& patch = patches[static_cast<std::size_t>(shell.face_patch(f))];
    patch.area += normal.norm();
    patch.normal += normal;
  }
  std::ranges::stable_sort(patches, std::greater(), &Patch::area);
  return patches;
}

std::string looks(const Patch& patch) {
  if (patch.normal.norm() < 0.99 * patch.area) return "curved or in several parts";
  const Eigen::Vector3d n = patch.normal.normalized();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(n(axis)) > 0.999)
      return fmt::format("looks along {}{}", n(axis) < 0 ? "-" : "", "xyz"[axis]);
  }
  return fmt::format("looks along ({:.2f}, {:.2f}, {:.2f})", n.x(), n.y(), n.z());
}

// What was found in a body's file, as comments.
std::string told_of(const study::Study& study, const stage::Outline& outline) {
  std::string text = "# " + stage::understood(study, outline).line() + "\n";
  const auto box = mesh::bounding_box(outline.shell.points);
  text += fmt::format("# x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g} mm\n",
                      1e3 * box(0, 0), 1e3 * box(1, 0), 1e3 * box(0, 1), 1e3 * box(1, 1),
                      1e3 * box(0, 2), 1e3 * box(1, 2));
  for (const auto& note : stage::faces_of(study, outline.shell, {}, "what looks up").notes) {
    text += "# " + note + "\n";
  }
  const auto patches = patches_of(outline.shell);
  text += fmt::format("# {} {}, for [[support]] and `on`:\n", patches.size(),
                      patches.size() == 1 ? "patch" : "patches, the largest first");
  for (std::size_t i = 0; i < std::min(patches.size(), kPatchesTold); ++i) {
    text += fmt::format("#   {:<16} {:>10.4g} cm2  {}\n", patches[i].name, 1e4 * patches[i].area,
                        looks(patches[i]));
  }
  if (patches.size() > kPatchesTold) {
    text +=
        fmt::format("#   and {} more; `chladni mesh` paints them\n", patches.size() - kPatchesTold);
  }
  return text;
}

std::string part_name(const FirstChoices& choices, const fs::path& file) {
  if (choices.kind != "file") return "";
  const auto folder = fs::absolute(file).parent_path();
  const auto name = path_from(folder, choices.part);
  require(!name.empty() && *name.begin() != "..",
          choices.part.string() + " is not below the folder of the study, " + folder.string() +
              "; write the study beside its part, or copy the part there");
  return name.generic_string();
}

}  // namespace

const std::vector<FirstBody>& first_bodies() {
  static const std::vector<FirstBody> all = {
      {"plate", {{"length", "400 mm"}, {"width", "300 mm"}, {"thickness", "12 mm"}}},
      {"beam", {{"length", "500 mm"}, {"width", "40 mm"}, {"thickness", "10 mm"}}},
      {"disc", {{"diameter", "300 mm"}, {"thickness", "20 mm"}}},
      {"wafer_table",
       {{"length", "600 mm"},
        {"width", "600 mm"},
        {"height", "50 mm"},
        {"face_sheet", "8 mm"},
        {"pockets", "[9, 9]", "1"},
        {"rib", "6 mm"},
        {"rim", "6 mm"}}}};
  return all;
}

std::string first_study(const FirstChoices& choices, const fs::path& file) {
  const auto part = part_name(choices, file);
  const auto bare = study::parse_study(beginning(choices, file, part, ""), file);
  const auto outline = stage::outline_of(bare, {});
  const auto told = choices.kind == "file" ? told_of(bare, outline) : "";
  const auto sensors = sites(outline.shell, 0.8);
  const auto actuators = sites(outline.shell, 0.55);
  // [geometry.plate] takes the lines below it, so the tables come last.
  const std::string text = beginning(choices, file, part, told) +
                           places_text(sensors, "sensor", "s",
                                       "quantity = \"displacement\"  # velocity, acceleration\n") +
                           places_text(actuators, "actuator", "a", "") +
                           fmt::format(fmt::runtime(kRest), "s1");
  const auto whole = study::parse_study(text, file);
  static_cast<void>(stage::places_of(whole, outline.shell));
  stage::require_faces(whole, outline.shell);
  return text;
}

}  // namespace chladni::show
