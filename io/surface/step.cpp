#include "io/surface/step.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "base/error.h"
#include "base/quantity.h"
#include "host/atomic_file.h"
#include "host/worker.h"
#include "io/bytes/message.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

#ifdef CHLADNI_WITH_STEP
constexpr bool kWithStep = true;
#else
constexpr bool kWithStep = false;
#endif

constexpr std::size_t kLargestFile = std::size_t{1} << 30U;

// The names of STEP's length units in OpenCASCADE, and our names.
constexpr std::array<std::array<std::string_view, 2>, 8> kUnits{{{"METRE", "m"},
                                                                 {"MILLIMETRE", "mm"},
                                                                 {"CENTIMETRE", "cm"},
                                                                 {"MICROMETRE", "um"},
                                                                 {"KILOMETRE", "km"},
                                                                 {"INCH", "inch"},
                                                                 {"FOOT", "foot"},
                                                                 {"MILLI-INCH", "mil"}}};

void check_unit(const std::string& in_file, const std::string& asked) {
  require(!in_file.empty() || !asked.empty(),
          "the file states no length unit, expected one: unit = \"mm\"");
  if (asked.empty() || in_file.empty()) return;
  const double wanted = unit_factor(asked, "m");
  const auto* const known = std::find_if(
      kUnits.begin(), kUnits.end(), [&](const auto& unit) { return unit[0] == upper(in_file); });
  require(known != kUnits.end(), "the file's length unit is " + shown(in_file) +
                                     ", which cannot be compared with " + shown(asked) +
                                     ": leave the unit out, the file's own is taken");
  const double own = unit_factor((*known)[1], "m");
  require(std::abs(own / wanted - 1.0) < 1e-9, "the file's length unit is " + shown(in_file) +
                                                   ", not " + shown(asked) +
                                                   ": leave the unit out, the file's own is taken");
}

// OpenCASCADE converts all numbers to millimetres. Where the file states no unit, the numbers are
// the file's own.
double metres_per_number(const std::string& in_file, const std::string& asked) {
  return in_file.empty() ? unit_factor(asked, "m") : 1e-3;
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

// The place of a parameter that is no number, as other programs print it: nan, -inf, 1.#QNAN.
// OpenCASCADE accepts such a coordinate and does not end. STEP itself has words only before a
// bracket and between dots.
std::size_t no_number(std::string_view bytes) {
  bool in_text = false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (bytes[i] == '\'') in_text = !in_text;
    if (in_text || (bytes[i] != '(' && bytes[i] != ',')) continue;
    const std::size_t first = bytes.find_first_not_of(" \t\r\n+-", i + 1);
    if (first == std::string_view::npos) break;
    std::size_t end = first;
    while (end < bytes.size() && is_letter(bytes[end])) ++end;
    const std::string word = upper(std::string(bytes.substr(first, end - first)));
    const bool is_word = word == "NAN" || word == "INF" || word == "INFINITY" || word == "IND";
    if (is_word && end < bytes.size() && bytes[end] != '(') return first;
    if (bytes.substr(first, 3) == "1.#") return first;
  }
  return std::string_view::npos;
}

void require_numbers(const std::string& bytes) {
  const auto at = no_number(bytes);
  if (at == std::string_view::npos) return;
  const auto line =
      1 + std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  const auto end = bytes.find_first_of(",) \r\n", at);
  throw InvalidInput("line " + fmt::to_string(line) + ": found " +
                     shown(bytes.substr(at, end - at)) +
                     ", expected a number: export the body anew");
}

Geometry geometry_of(const Message& found, const std::string& unit) {
  const std::string& refused = found.head.at("refused").string();
  require(refused.empty(), refused);
  const std::string& in_file = found.head.at("unit").string();
  check_unit(in_file, unit);
  mesh::Surface surface;
  surface.points = found.numbers("points") * metres_per_number(in_file, unit);
  surface.triangles = found.cells("triangles");
  const Cells& patch = found.cells("patch");
  require(patch.cols() == 1 && patch.rows() > 0, "its triangles make no sense");
  surface.patch = patch.col(0);
  for (const Json& name : found.head.at("patch_names").array()) {
    surface.patch_names.push_back(name.string());
  }
  require(surface.points.cols() == 3 && surface.triangles.cols() == 3 &&
              surface.patch.size() == surface.triangles.rows() && surface.patch.size() > 0 &&
              surface.points.allFinite() && surface.triangles.minCoeff() >= 0 &&
              surface.triangles.maxCoeff() < surface.points.rows() &&
              surface.patch.minCoeff() >= 0 &&
              surface.patch.maxCoeff() < std::ssize(surface.patch_names),
          "its triangles make no sense");
  Geometry geometry;
  geometry.notes.push_back(fmt::to_string(surface.patch_names.size()) + " faces in " +
                           fmt::to_string(surface.triangles.rows()) + " triangles; length unit " +
                           (in_file.empty() ? unit + ", as stated" : in_file + ", from the file"));
  geometry.body = std::move(surface);
  return geometry;
}

}  // namespace

Geometry read_step(const std::filesystem::path& file, const std::string& unit) {
  require(kWithStep, file.string() +
                         ": STEP needs OpenCASCADE, which this build was made without; install "
                         "libocct-data-exchange-dev and build again, or export STL");
  const std::string bytes = read_whole(file, kLargestFile);
  refuse_utf16(bytes, file.string());
  require(bytes.find("ISO-10303-21") < 1024,
          file.string() + ": no 'ISO-10303-21' at the start, expected a STEP file");
  try {
    require_numbers(bytes);
  } catch (const InvalidInput& error) {
    throw InvalidInput(file.string() + ": " + error.what());
  }
  const auto path = std::filesystem::absolute(file);
  const WorkerLimits limits{.time = std::chrono::seconds(120),
                            .memory_bytes = (std::size_t{2} << 30U) + 64 * bytes.size(),
                            .output_bytes = (std::size_t{64} << 20U) + 64 * bytes.size(),
                            .confined = true,
                            .files = {path}};
  const auto worker = worker_path("chladni-step");
  const auto result = run_worker(worker, {path.string()}, "", limits);
  const Message reply = reply_of(worker, [&] { return message(result.output); });
  try {
    return geometry_of(reply, unit);
  } catch (const InvalidInput& error) {
    throw InvalidInput(file.string() + ": " + error.what());
  }
}

}  // namespace chladni::io
