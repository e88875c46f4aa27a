// Streams on texts. The standard's own stop silently where memory lacks: a loop over lines ends
// early, a text is cut off.
#pragma once

#include <ios>
#include <sstream>
#include <string>
#include <utility>

namespace chladni {

/// Reads a text, as std::istringstream, and throws std::bad_alloc where memory lacks.
class TextReader : public std::istringstream {
 public:
  explicit TextReader(std::string text) : std::istringstream(std::move(text)) {
    exceptions(std::ios::badbit);
  }
};

/// Collects a text, as std::ostringstream, and throws std::bad_alloc where memory lacks.
class TextWriter : public std::ostringstream {
 public:
  TextWriter() { exceptions(std::ios::badbit); }
};

}  // namespace chladni
