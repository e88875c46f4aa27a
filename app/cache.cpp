// chladni cache: the meshes and modes that runs have kept for later ones.
#include "host/cache.h"

#include <fmt/format.h>

#include <ostream>

#include "app/command.h"
#include "base/error.h"
#include "io/json.h"

namespace chladni::app {
namespace {

std::string line(const Cache::Size& size) {
  return fmt::format("{} {}, {:.1f} MB", size.entries, size.entries == 1 ? "entry" : "entries",
                     1e-6 * static_cast<double>(size.bytes));
}

}  // namespace

int cache(bool clear, bool json, std::ostream& results) {
  const auto place = cache_place();
  const bool is_off = place.folder.empty();
  const Cache cache(place.folder, place.most_bytes);
  const auto size = is_off ? Cache::Size{} : clear ? cache.clear() : cache.size();
  if (json) {
    results << io::text(io::JsonObject{{"folder", place.folder.string()},
                                       {"entries", static_cast<long long>(size.entries)},
                                       {"bytes", static_cast<long long>(size.bytes)},
                                       {"most_bytes", static_cast<long long>(place.most_bytes)},
                                       {"removed", clear}});
    return 0;
  }
  if (!place.note.empty()) results << place.note << "\n";
  if (is_off) {
    results << "off: nothing is kept (CHLADNI_CACHE)\n";
  } else if (clear) {
    results << fmt::format("removed {} from {}\n", line(size), place.folder.string());
  } else {
    results << fmt::format("{}  {} of at most {:.1f} GB\n", place.folder.string(), line(size),
                           1e-9 * static_cast<double>(place.most_bytes));
  }
  return 0;
}

}  // namespace chladni::app
