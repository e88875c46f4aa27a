// Variables and files of version 5 put together by hand from the format's description: not by
// libmatio.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace chladni::io {

inline std::string element(std::uint32_t type, const std::string& data) {
  std::string bytes(8, '\0');
  const auto size = static_cast<std::uint32_t>(data.size());
  std::memcpy(bytes.data(), &type, 4);
  std::memcpy(bytes.data() + 4, &size, 4);
  bytes += data;
  bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
  return bytes;
}

template <typename Number>
inline std::string raw(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

inline std::string array_head(std::uint32_t flags, const std::vector<std::int32_t>& dims,
                              const std::string& name) {
  return element(6, raw<std::uint32_t>({flags, 0})) + element(5, raw(dims)) + element(1, name);
}

inline std::string doubles(const std::string& name, const std::vector<std::int32_t>& dims,
                           const std::vector<double>& real, const std::vector<double>& imag = {}) {
  const bool is_complex = !imag.empty();
  return element(14, array_head(is_complex ? 0x0806 : 6, dims, name) + element(9, raw(real)) +
                         (is_complex ? element(9, raw(imag)) : ""));
}

inline std::string characters(const std::string& name, const std::string& text) {
  std::vector<std::uint16_t> letters;
  for (const char c : text) letters.push_back(static_cast<unsigned char>(c));
  return element(14, array_head(4, {1, static_cast<std::int32_t>(text.size())}, name) +
                         element(4, raw(letters)));
}

inline std::string cells(const std::string& name, const std::vector<std::string>& texts) {
  std::string inside = array_head(1, {static_cast<std::int32_t>(texts.size()), 1}, name);
  for (const auto& text : texts) inside += characters("", text);
  return element(14, inside);
}

/// An array of structures. @param values  of the fields of the first one, then of the second
inline std::string structures(const std::string& name, const std::vector<std::int32_t>& dims,
                              const std::vector<std::string>& fields,
                              const std::vector<std::string>& values) {
  std::string inside = array_head(2, dims, name), names;
  for (std::string field : fields) {
    field.resize(32, '\0');
    names += field;
  }
  inside += std::string("\x05\x00\x04\x00\x20\x00\x00\x00", 8) + element(1, names);
  for (const auto& value : values) inside += value;
  return element(14, inside);
}

inline std::string structure(const std::string& name,
                             const std::vector<std::pair<std::string, std::string>>& fields) {
  std::vector<std::string> names, values;
  for (const auto& [field, value] : fields) {
    names.push_back(field);
    values.push_back(value);
  }
  return structures(name, {1, 1}, names, values);
}

inline std::string compressed(const std::string& bytes) {
  std::string packed(compressBound(bytes.size()), '\0');
  uLongf size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &size,
           reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  packed.resize(size);
  std::string head(8, '\0');
  const std::uint32_t words[2] = {15, static_cast<std::uint32_t>(size)};
  std::memcpy(head.data(), words, 8);
  return head + packed;  // without padding
}

inline std::string version_5(const std::vector<std::string>& variables) {
  std::string bytes = "MATLAB 5.0 MAT-file, by hand";
  bytes.resize(124, ' ');
  bytes += std::string("\x00\x01IM", 4);
  for (const auto& variable : variables) bytes += variable;
  return bytes;
}

}  // namespace chladni::io
