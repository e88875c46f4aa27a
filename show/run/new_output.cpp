#include "show/new_output.h"

#include <system_error>

#include "base/error.h"

namespace chladni::show {

void require_new_output(const std::filesystem::path& from, const std::filesystem::path& to,
                        bool force) {
  std::error_code fault;
  require(!std::filesystem::equivalent(from, to, fault),
          to.string() + ": it is the file that is read, " + from.string() +
              "; expected another one to write");
  require(
      force || !std::filesystem::exists(to, fault),
      to.string() + ": there is such a file; name another one, or say --force to write over it");
}

}  // namespace chladni::show
