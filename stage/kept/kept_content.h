// An entry of the cache as the thing that it holds.
#pragma once

#include <new>
#include <optional>
#include <string>

#include "base/error.h"
#include "host/cache.h"

namespace chladni::stage {

/// What `read` makes of the content of an entry; none where there is no entry, or no memory for it.
/// An entry of which it makes nothing (InvalidInput) is removed.
template <typename Read>
[[nodiscard]] auto kept_content(const Cache& cache, const std::string& name, Read read)
    -> std::optional<decltype(read(std::string()))> {
  try {
    if (const auto content = cache.content(name)) return read(*content);
  } catch (const InvalidInput&) {
    cache.drop(name);
  } catch (const std::bad_alloc&) {
    return {};
  }
  return {};
}

}  // namespace chladni::stage
