#include "io/picture/title.h"

#include "io/picture/letters.h"

namespace chladni::picture {

void paint_title(Canvas& canvas, const std::string& words, double margin, double width) {
  TextStyle style{.size = 34.0, .bold = true};
  const auto fits = [&](const std::string& part) {
    return canvas.text_width(part, style) <= width - 2.0 * margin;
  };
  while (style.size > 22.0 && !fits(words)) style.size -= 2.0;
  canvas.text({margin, 64.0}, shortened(words, fits), style);
}

}  // namespace chladni::picture
