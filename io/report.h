// The report: one HTML file that needs no other file, no network and no permission.
//
// A report is data: sections made of blocks. Each verb adds a section with one function that
// returns a Section (report_sections.h has the functions for modes). The verb writes no HTML.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/arrays.h"
#include "io/curves.h"
#include "io/matrix_picture.h"
#include "io/vtu.h"

namespace chladni::io {

/// A line of plain text. A good note is green with a tick, a warning is amber, a quiet note grey.
struct Note {
  enum class Tone { plain, quiet, good, warning } tone = Tone::plain;
  std::string text;
};

/// What the reader needs first, as a card.
struct Card {
  struct Figure {
    std::string value, label;  ///< "0.33 %", "off by, after"
  };
  Note::Tone tone = Note::Tone::plain;
  std::string heading;             ///< the verdict in a sentence
  std::vector<std::string> lines;  ///< causes with their places and sizes
  std::vector<Figure> figures;     ///< large numbers
  std::vector<std::string> next;   ///< what to do next
};

/// Names and values, one line each.
struct Facts {
  std::string title;
  std::vector<std::pair<std::string, std::string>> lines;
};

struct Table {
  struct Column {
    std::string heading;
    bool is_number = true;  ///< right-aligned, digits of equal width
  };
  struct Row {
    std::vector<std::string> cells;  ///< one per column
    bool is_quiet = false;           ///< grey
    int shape = -1;  ///< a click shows this shape of the report's viewer; −1: none
  };
  std::string caption;
  std::vector<Column> columns;
  std::vector<Row> rows;
};

struct Image {
  std::string png;  ///< the bytes of the file
  std::string caption;
};

/// A text that is shown when its title is clicked, and not on paper.
struct Listing {
  std::string title, text;
};

/// A matrix as a table with coloured cells: its title is the caption.
using Matrix = MatrixPicture;

/// A body that the mouse rotates and that moves in the chosen shape. One per report.
struct Viewer {
  struct Shape {
    std::string label;                   ///< "7   178.92 Hz"
    std::vector<std::int16_t> movement;  ///< V×3, the largest length is 32767
    int axis = 2;                        ///< the component that gives the colour
  };
  std::vector<std::int16_t> points;  ///< V×3, from the body's centre; half its diagonal is 32767
  std::vector<std::uint16_t> triangles;  ///< T×3
  std::vector<std::uint16_t> outline;    ///< E×2
  std::vector<Shape> shapes;
  std::vector<Marker> markers;
  std::vector<std::uint16_t> marker_vertex;  ///< one per marker
  std::string note;                          ///< omitted parts, if any
  int on_paper = 0;                          ///< number of shapes that are printed
};

/// The report's viewer once more: the body turns slowly, and some of its markers are ringed.
struct Place {
  std::vector<std::string> marked;  ///< names of markers
};

/// Blocks beside each other, where there is room.
struct Beside;
using Block =
    std::variant<Note, Card, Facts, Table, Image, Listing, Matrix, Curves, Viewer, Place, Beside>;
struct Beside {
  std::vector<Block> blocks;
};

struct Section {
  std::string title;
  std::vector<Block> blocks;
};

struct Report {
  std::string title;                  ///< of the study
  std::string understood;             ///< "600.0 x 600.0 x 20.0 mm  19.44 kg"
  std::vector<std::string> warnings;  ///< shown first, or behind a section that starts with a card
  std::vector<Section> sections;
};

/// The HTML page. All text is escaped. A content security policy allows only the scripts and the
/// styles of the file, by their sha256. The same report gives the same bytes. Text and tables are
/// readable without scripts, and everything is on paper; colours follow the reader's choice of a
/// light or a dark page. Curves cost 60 kB for uPlot and the bytes of their values: 2.7 per value,
/// or 1.3 in a coarse pane.
/// @throws InvalidInput  a row of a table has another number of cells than there are columns, an
///                       image is no PNG, there is more than one viewer, a place is marked without
///                       one, arrays of a matrix or of curves do not fit together
[[nodiscard]] std::string html(const Report& report);

/// Writes the file whole or not at all. @throws as html and write_atomically
void write_report(const std::filesystem::path& file, const Report& report);

}  // namespace chladni::io
