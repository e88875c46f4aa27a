// Makes arbitrary text safe for XML, HTML and scripts, and UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace chladni::io {

/// `text` with & < > " ' ` as entities, for the text and the quoted attributes of XML and HTML.
/// Bytes that are not UTF-8 and control characters that XML forbids become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

/// `text`, with bytes that are not UTF-8 (RFC 3629) replaced by U+FFFD.
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// `text` itself where all of it is UTF-8; else its bytes as letters of Latin-1, in UTF-8.
[[nodiscard]] std::string utf8_of(std::string_view text);

/// The first `bytes` bytes of the UTF-8 text, less those of a letter that does not end there.
[[nodiscard]] std::string_view whole_letters(std::string_view text, std::size_t bytes);

/// JSON for a <script> element. It contains no '<', '>', '&', U+2028 and U+2029, so that no string
/// can end the script or begin a comment. @param json  valid JSON
[[nodiscard]] std::string script_safe(std::string_view json);

/// The base64 text of the bytes (RFC 4648, with padding).
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace chladni::io
