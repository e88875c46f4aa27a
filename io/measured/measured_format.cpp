#include "io/measured/measured_format.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/bytes/gzip.h"
#include "io/bytes/room.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"

namespace chladni::io {

MeasuredFormat measured_format(const std::filesystem::path& file) {
  std::string ending = upper(file.extension().string());
  if (ending == ".GZ") ending = upper(file.stem().extension().string());
  if (ending == ".CSV") return MeasuredFormat::csv;
  if (ending == ".UFF" || ending == ".UNV" || ending == ".UF") return MeasuredFormat::uff;
  if (ending == ".MAT") return MeasuredFormat::mat;
  return MeasuredFormat::none;
}

MeasuredFormat written_format(const std::filesystem::path& file) {
  const auto format = measured_format(file);
  if (format == MeasuredFormat::none || upper(file.extension().string()) == ".GZ") {
    refuse_ending(file);
  }
  return format;
}

void refuse_ending(const std::filesystem::path& file) {
  throw InvalidInput(file.string() + ": \"" + file.extension().string() +
                     "\" is no ending of measured data; expected .csv, .uff, .unv or .mat");
}

std::string content_of(const std::filesystem::path& file, std::size_t limit) {
  std::string bytes = read_whole(file, limit);
  if (!is_gzip(bytes)) return bytes;
  try {
    return unzipped(bytes, text_limit(limit));
  } catch (const InvalidInput& e) {
    throw InvalidInput(file.string() + ": " + e.what());
  }
}

std::vector<std::string> lost_in_csv(
    const std::vector<const std::vector<modal::MeasuredChannel>*>& sides) {
  bool units = false;
  bool places = false;
  std::set<std::string> of_outputs;  // units
  for (const auto* side : sides) {
    for (const auto& channel : *side) {
      units = units || !channel.unit.empty();
      places = places || channel.node || channel.position || channel.direction.any();
      if (side == sides.front()) of_outputs.insert(channel.unit);
    }
  }
  // Several motions have no unit in common.
  const bool motions = std::ranges::all_of(
      of_outputs, [](const std::string& unit) { return motion_unit(unit).has_value(); });
  if (of_outputs.size() > 1 && motions) of_outputs = {kEachInSi};
  of_outputs.erase("");
  std::vector<std::string> lost;
  if (units) {
    lost.push_back("CSV holds no units" +
                   (of_outputs.size() == 1
                        ? ": say unit = \"" + *of_outputs.begin() +
                              (*of_outputs.begin() == kEachInSi ? "\" in a study that reads it"
                                                                : "\" on reading")
                        : ""));
  }
  if (places) lost.emplace_back("CSV holds no nodes, directions and places: they are left out");
  return lost;
}

}  // namespace chladni::io
