// The program chladni-painter [XVFB] reads a request from stdin and writes a PNG to stdout. It
// paints on its own display, made by the program XVFB, or on the display that DISPLAY names.
#include <exception>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <string>

#include "base/error.h"
#include "io/bytes/message.h"
#include "io/picture/own_display.h"
#include "io/picture/pictures.h"

namespace {

using Picture = std::string (*)(const chladni::io::Message&);

const std::map<std::string, Picture> kPictures{{"contact_sheet", chladni::picture::contact_sheet},
                                               {"drawing", chladni::picture::drawing},
                                               {"heat_map", chladni::picture::heat_map},
                                               {"layouts", chladni::picture::layouts},
                                               {"patches", chladni::picture::patches}};

}  // namespace

int main(int argc, char** argv) {
  std::ios::sync_with_stdio(false);  // reads blocks, not bytes
  try {
    const std::string bytes{std::istreambuf_iterator<char>(std::cin), {}};
    const chladni::io::Message request = chladni::io::message(bytes);
    const std::string& kind = request.head.at("kind").string();
    const auto picture = kPictures.find(kind);
    chladni::require(picture != kPictures.end(), "there is no picture \"" + kind + "\"");
    std::optional<chladni::picture::OwnDisplay> display;
    if (argc > 1) display.emplace(argv[1]);
    const std::string png = picture->second(request);
    std::cout.write(png.data(), static_cast<std::streamsize>(png.size()));
    return std::cout.flush() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
