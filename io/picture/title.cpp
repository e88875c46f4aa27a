#include "io/picture/title.h"

#include <algorithm>

namespace chladni::picture {

void paint_title(Canvas& canvas, std::string words, double margin, double width) {
  TextStyle style{.size = 34.0, .bold = true};
  const double room = width - 2.0 * margin;
  while (style.size > 22.0 && canvas.text_width(words, style) > room) style.size -= 2.0;
  const std::string whole = words;
  while (words.size() > 4 && canvas.text_width(words, style) > room) {
    do {
      words.pop_back();
    } while (!words.empty() && (static_cast<unsigned char>(words.back()) & 0xC0U) == 0x80U);
    if (!words.empty() && static_cast<unsigned char>(words.back()) >= 0xC0U) words.pop_back();
    words = words.substr(0, words.size() - std::min<std::size_t>(3, words.size())) + "...";
  }
  canvas.text({margin, 64.0}, words, style);
}

}  // namespace chladni::picture
