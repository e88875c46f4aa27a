// What the readers of our own texts promise, whatever the bytes were.
#pragma once

#include <string>
#include <string_view>

#include "io/bytes/message.h"
#include "io/json.h"
#include "io/shape_table.h"
#include "study/toml/toml_tree.h"

namespace chladni::io {

/// What is read is written, read again and written the same.
inline bool read_json(std::string_view bytes) {
  const std::string once = text(parse_json(std::string(bytes)));
  return text(parse_json(once)) == once;
}

inline bool read_message(std::string_view bytes) {
  const Message read = message(bytes);
  for (const auto& [name, array] : read.doubles) {
    if (array.size() > static_cast<Eigen::Index>(bytes.size())) return false;
  }
  const std::string once = io::bytes(read);
  return io::bytes(message(once)) == once;
}

inline bool read_shapes(std::string_view bytes) {
  const auto table = parse_shapes(bytes, "t.csv");
  return table.values.rows() == static_cast<Eigen::Index>(table.channels.size()) &&
         table.values.cols() == table.frequency_hz.size() && table.values.allFinite() &&
         table.deviation.allFinite() && table.frequency_hz.minCoeff() >= 0.0;
}

/// The tree of a study.
inline bool read_toml(std::string_view bytes) {
  return study::parse_toml(bytes, "study.toml").kind == study::TomlNode::Kind::table;
}

}  // namespace chladni::io
