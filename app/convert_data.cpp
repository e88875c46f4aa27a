// chladni convert IN OUT: measured data from one format to another.
#include <fmt/format.h>

#include <ostream>

#include "app/command.h"
#include "app/command_line/unit_of_data.h"
#include "base/error.h"
#include "io/frf_file.h"
#include "io/mat.h"
#include "io/time_file.h"

namespace chladni::app {
namespace {

struct Converted {
  std::vector<std::string> notes, lost;
};

Converted converted(const std::filesystem::path& from, const std::filesystem::path& to,
                    const std::string& unit, bool hdf5) {
  require_one_unit(unit);
  const auto version = hdf5 ? io::MatVersion::mat_7_3 : io::MatVersion::mat_5;
  try {
    io::FrfOptions options;
    options.unit = unit;
    auto file = io::read_frf(from, options);
    return {std::move(file.notes), io::write_frf(to, file.set, version)};
  } catch (const io::NoResponses&) {
    io::TimeOptions options;
    options.unit = unit;
    auto file = io::read_time(from, options);
    return {std::move(file.notes), io::write_time(to, file.data, version)};
  }
}

}  // namespace

int convert_data(const std::filesystem::path& from, const std::filesystem::path& to,
                 const std::string& unit, bool hdf5, std::ostream& results) {
  const auto done = converted(from, to, unit, hdf5);
  for (const auto& note : done.notes) results << "note: " << note << '\n';
  for (const auto& loss : done.lost) results << "lost: " << loss << '\n';
  results << fmt::format("{} -> {}\n", from.string(), to.string());
  return 0;
}

}  // namespace chladni::app
