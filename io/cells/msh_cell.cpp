#include "io/cells/msh_cell.h"

#include <algorithm>
#include <array>

namespace chladni::io {
namespace {

using enum MshCell::Kind;

constexpr std::array kCells{
    MshCell{1, "line", 2, 1},
    MshCell{2, "triangle", 3, 2, triangle},
    MshCell{3, "quadrilateral", 4, 2},
    MshCell{4, "tetrahedron", 4, 3, tetrahedron},
    MshCell{5, "hexahedron", 8, 3},
    MshCell{6, "prism", 6, 3},
    MshCell{7, "pyramid", 5, 3},
    MshCell{8, "quadratic line", 3, 1},
    MshCell{9, "quadratic triangle", 6, 2, triangle},
    MshCell{10, "quadratic quadrilateral", 9, 2},
    MshCell{11, "quadratic tetrahedron", 10, 3, tetrahedron},
    MshCell{12, "quadratic hexahedron", 27, 3},
    MshCell{13, "quadratic prism", 18, 3},
    MshCell{14, "quadratic pyramid", 14, 3},
    MshCell{15, "point", 1, 0},
    MshCell{16, "quadratic quadrilateral (serendipity)", 8, 2},
    MshCell{17, "quadratic hexahedron (serendipity)", 20, 3},
    MshCell{18, "quadratic prism (serendipity)", 15, 3},
    MshCell{19, "quadratic pyramid (serendipity)", 13, 3},
    MshCell{20, "cubic triangle (serendipity)", 9, 2, triangle},
    MshCell{21, "cubic triangle", 10, 2, triangle},
    MshCell{22, "quartic triangle (serendipity)", 12, 2, triangle},
    MshCell{23, "quartic triangle", 15, 2, triangle},
    MshCell{26, "cubic line", 4, 1},
    MshCell{27, "quartic line", 5, 1},
    MshCell{29, "cubic tetrahedron", 20, 3, tetrahedron},
    MshCell{30, "quartic tetrahedron", 35, 3},
    MshCell{36, "cubic quadrilateral", 16, 2},
    MshCell{37, "quartic quadrilateral", 25, 2},
    MshCell{39, "cubic quadrilateral (serendipity)", 12, 2},
    MshCell{90, "cubic prism", 40, 3},
    MshCell{91, "quartic prism", 75, 3},
    MshCell{92, "cubic hexahedron", 64, 3},
    MshCell{93, "quartic hexahedron", 125, 3},
    MshCell{118, "cubic pyramid", 30, 3},
    MshCell{119, "quartic pyramid", 55, 3},
};

constexpr std::array<std::size_t, 10> kQuadratic{0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
constexpr std::array<std::size_t, 20> kCubic{0,  1,  2,  3,  4,  5,  6,  7,  8,  9,
                                             11, 10, 15, 14, 13, 12, 17, 19, 18, 16};

}  // namespace

const MshCell* msh_cell(std::int64_t code) {
  const auto* const cell =
      std::find_if(kCells.begin(), kCells.end(), [&](const MshCell& c) { return c.code == code; });
  return cell == kCells.end() ? nullptr : cell;
}

std::span<const std::size_t> msh_tet_order(std::size_t nodes) {
  return nodes == 20 ? std::span<const std::size_t>(kCubic)
                     : std::span<const std::size_t>(kQuadratic).first(nodes);
}

}  // namespace chladni::io
