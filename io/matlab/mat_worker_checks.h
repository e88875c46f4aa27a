// Checks of the program chladni-mat that need no libmatio.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

#include "base/error.h"

namespace chladni::mat_worker {

// Refuses truncated files, which libmatio reads as files with fewer variables. In a version 5 file
// the lengths of the variables must end where the file ends.
inline void require_whole(const char* name) {
  std::ifstream file(name, std::ios::binary);
  std::array<char, 128> head{};
  file.read(head.data(), 128);
  const std::string_view mark(head.data() + 126, 2);
  if (!file || (mark != "IM" && mark != "MI")) return;  // of another version
  const bool is_hdf5 = head[125] == 2 || head[124] == 2;
  if (is_hdf5) return;
  const bool swapped = (mark == "MI") == (std::endian::native == std::endian::little);
  file.seekg(0, std::ios::end);
  const auto end = static_cast<std::uint64_t>(file.tellg());
  for (std::uint64_t at = 128; at < end;) {
    std::array<unsigned char, 8> tag{};
    file.seekg(static_cast<std::streamoff>(at));
    file.read(reinterpret_cast<char*>(tag.data()), 8);
    if (swapped) std::reverse(tag.begin() + 4, tag.end());
    std::uint32_t size = 0;
    std::memcpy(&size, tag.data() + 4, 4);
    require(file && size <= end - at - 8, "the file is cut off");
    at += 8 + size;
  }
}

// A place in a variable, or a count from there on.
inline int place_of(const std::string& word) {
  const long long place = std::stoll(word);
  require(place >= 0 && place <= std::numeric_limits<int>::max(),
          "the place " + word +
              " in a variable is not read; expected one up to 2147483647, where " +
              "libmatio ends");
  return static_cast<int>(place);
}

}  // namespace chladni::mat_worker
